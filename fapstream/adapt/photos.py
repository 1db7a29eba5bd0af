"""Photos as they come from anywhere: bytes to pixels, bounded and upright."""

from __future__ import annotations

import io
import warnings

import numpy as np
from numpy.typing import NDArray
from PIL import Image as Picture
from PIL import ImageOps

from fapstream.errors import PhotoError

MAX_BYTES = 32 << 20
MAX_PIXELS = 64_000_000
"""More than any phone takes; a picture that says it has more is not decoded."""
SMALLEST = 120
"""Pixels of the shorter side."""
LONGEST = 2400
"""Larger photos are made so long: a face in them has more pixels than its picture has texels."""
FORMATS = ("JPEG", "PNG", "WEBP", "BMP", "TIFF")


def read_photo(data: bytes, where: str = "photo") -> NDArray[np.uint8]:
    """The pixels (h, w, 3) sRGB of a picture file: turned as its EXIF says, on white where it is
    transparent, grey ones in three channels, larger ones reduced to `LONGEST`.

    Raises PhotoError, naming `where`, for what is no picture, broken, too large or too small.
    """
    if len(data) > MAX_BYTES:
        raise PhotoError(f"{where}: has {len(data) >> 20} MB; {MAX_BYTES >> 20} MB are the limit")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            with Picture.open(io.BytesIO(data), formats=FORMATS) as picture:
                width, height = picture.size
                _check(width, height, where)
                picture.draft("RGB", (LONGEST, LONGEST))
                return _pixels(ImageOps.exif_transpose(picture), where)
    except PhotoError:
        raise
    except Picture.DecompressionBombError:
        raise PhotoError(f"{where}: has more than {MAX_PIXELS // 10**6} million pixels") from None
    except Exception as e:  # decoders raise whatever comes to their mind
        raise PhotoError(f"{where}: is no picture that can be read ({', '.join(FORMATS)})") from e


def _check(width: int, height: int, where: str) -> None:
    if width * height > MAX_PIXELS:
        raise PhotoError(
            f"{where}: has {width} x {height} pixels; {MAX_PIXELS // 10**6} million are the limit"
        )
    if min(width, height) < SMALLEST:
        raise PhotoError(f"{where}: has {width} x {height} pixels; {SMALLEST} a side are the least")


def _pixels(picture: Picture.Image, where: str) -> NDArray[np.uint8]:
    if picture.mode in ("I", "I;16", "F"):
        deep = np.asarray(picture, np.float64)
        top = 255.0 if deep.max() <= 255 else 65535.0
        picture = Picture.fromarray(np.clip(deep * (255 / top), 0, 255).astype(np.uint8))
    if "A" in picture.getbands() or "transparency" in picture.info:
        clear = picture.convert("RGBA")
        picture = Picture.alpha_composite(Picture.new("RGBA", clear.size, "white"), clear)
    picture = picture.convert("RGB")
    if max(picture.size) > LONGEST:
        picture.thumbnail((LONGEST, LONGEST), Picture.Resampling.LANCZOS)
    _check(*picture.size, where)
    return np.asarray(picture, np.uint8)
