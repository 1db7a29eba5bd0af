"""Pictures from anywhere."""

from __future__ import annotations

import io
import struct
import zlib

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image as Picture

from fapstream.adapt.photos import LONGEST, MAX_BYTES, read_photo
from fapstream.errors import PhotoError

WIDE = np.zeros((150, 200, 3), np.uint8)
WIDE[:, :100] = (200, 30, 30)


def file(picture: Picture.Image, kind: str = "PNG", **options: object) -> bytes:
    out = io.BytesIO()
    picture.save(out, kind, **options)
    return out.getvalue()


@pytest.mark.parametrize("kind", ["PNG", "BMP", "TIFF", "WEBP", "JPEG"])
def test_kinds_of_files(kind: str) -> None:
    pixels = read_photo(file(Picture.fromarray(WIDE), kind))
    assert pixels.shape == WIDE.shape
    assert pixels.dtype == np.uint8
    assert np.abs(pixels[:, 20].astype(int) - (200, 30, 30)).max() < 25


def test_turned_as_exif_says() -> None:
    exif = Picture.Exif()
    exif[0x0112] = 6  # turned a quarter to the right
    pixels = read_photo(file(Picture.fromarray(WIDE), "JPEG", exif=exif, quality=95))
    assert pixels.shape == (200, 150, 3)
    assert pixels[20, 75, 0] > 150
    assert pixels[180, 75, 0] < 60


def test_transparency_lies_on_white_and_grey_has_three_channels() -> None:
    clear = Picture.fromarray(np.dstack([WIDE, np.zeros((150, 200), np.uint8)]))
    assert (read_photo(file(clear)) == 255).all()
    for mode in ("L", "LA", "1", "P", "CMYK", "I;16"):
        kind = "TIFF" if mode == "CMYK" else "PNG"
        deep = mode == "I;16"
        picture = Picture.fromarray(WIDE[..., 0].astype(np.uint16) * 257 if deep else WIDE)
        picture = picture if deep else picture.convert(mode)
        pixels = read_photo(file(picture, kind))
        assert pixels.shape == (150, 200, 3), mode
        assert pixels[:, :100].mean() > pixels[:, 100:].mean() + 20, mode


def test_large_ones_are_reduced() -> None:
    pixels = read_photo(file(Picture.new("RGB", (3000, 1500), "green"), "JPEG"))
    assert pixels.shape == (LONGEST // 2, LONGEST, 3)


def bomb(width: int, height: int) -> bytes:
    """A PNG that says it has so many pixels, in a few bytes."""

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)
    return (
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", header)
        + chunk(b"IDAT", zlib.compress(bytes(1000)))
        + chunk(b"IEND", b"")
    )


@pytest.mark.parametrize(
    ("data", "says"),
    [
        (b"", "no picture"),
        (b"hello", "no picture"),
        (file(Picture.fromarray(WIDE))[:200], "no picture"),
        (bomb(60000, 60000), "million"),
        (bomb(100000, 1), "least"),
        (file(Picture.new("RGB", (80, 200))), "least"),
        (b"<svg xmlns='http://www.w3.org/2000/svg'/>", "no picture"),
        (b"%!PS-Adobe-3.0 EPSF-3.0\n%%BoundingBox: 0 0 200 200\n", "no picture"),
        (bytes(MAX_BYTES + 1), "limit"),
    ],
)  # fmt: skip
def test_what_is_no_photo_is_refused(data: bytes, says: str) -> None:
    with pytest.raises(PhotoError, match=says) as e:
        read_photo(data, "me.jpg")
    assert "me.jpg" in str(e.value)


@given(st.data())
def test_broken_files_raise_nothing_else(data: st.DataObject) -> None:
    good = bytearray(
        file(Picture.fromarray(WIDE), data.draw(st.sampled_from(["PNG", "JPEG", "WEBP", "TIFF"])))
    )
    for _ in range(data.draw(st.integers(1, 8))):
        good[data.draw(st.integers(0, len(good) - 1))] = data.draw(st.integers(0, 255))
    try:
        pixels = read_photo(bytes(good))
    except PhotoError:
        return
    assert pixels.ndim == 3
