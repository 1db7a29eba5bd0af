"""picture_size against Pillow."""

import io

import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

from fapstream.head.picture import picture_size

STARTS = [b"", b"\x89PNG\r\n\x1a\n", b"\xff\xd8\xff", b"RIFF0000WEBPVP8 "]


def encoded(kind: str, size: tuple[int, int], **options: object) -> bytes:
    out = io.BytesIO()
    Image.new("RGBA" if options.pop("alpha", False) else "RGB", size, "red").save(out, kind, **options)
    return out.getvalue()


@pytest.mark.parametrize("size", [(1, 1), (37, 300), (1025, 8)])
@pytest.mark.parametrize(
    ("kind", "options"),
    [("PNG", {}), ("JPEG", {}), ("JPEG", {"progressive": True}), ("JPEG", {"comment": b"x" * 900}),
     ("WEBP", {}), ("WEBP", {"lossless": True}), ("WEBP", {"alpha": True, "exif": b"Exif\0\0MM\0*"})],
)  # fmt: skip
def test_the_size_is_that_of_the_picture(kind: str, options: dict, size: tuple[int, int]) -> None:
    assert picture_size(encoded(kind, size, **options)) == size


@given(
    st.binary(max_size=40), st.sampled_from([b"", b"\x89PNG\r\n\x1a\n", b"\xff\xd8\xff", b"RIFF0000WEBPVP8 "])
)
def test_nonsense_has_no_size_or_some(data: bytes, start: bytes) -> None:
    size = picture_size(start + data)
    assert size is None or (len(size) == 2 and min(size) >= 0)
