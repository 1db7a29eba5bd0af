"""glTF 2.0 documents in GLB containers, read with bounds on everything: what both kinds of heads need."""

from __future__ import annotations

import json
import struct
from collections.abc import Mapping, Sequence
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from fapstream.errors import DataError
from fapstream.head.fapu import Point
from fapstream.head.picture import picture_size

MAX_FILE = 64 << 20
MAX_JSON = 8 << 20
MAX_VERTICES = 1 << 20
MAX_NUMBERS = 1 << 25
"""Of all accessors together, as often as they are used."""
MAX_SIZE = 1e8
"""Of a float: far beyond any scene, and its square is still one."""
MAX_PICTURE = 4096
"""Pixels along a side."""
MAX_PIXELS = 1 << 26
"""Of the pictures of all materials together."""
COMPONENTS: Mapping[int, str] = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
WIDTHS: Mapping[str, int] = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
UNSIGNED = frozenset({"<u1", "<u2", "<u4"})


def split_glb(data: bytes, where: str) -> tuple[dict[str, Any], bytes]:
    """The JSON object and the binary chunk of a GLB container. Raises DataError."""
    if len(data) > MAX_FILE:
        raise DataError(where, None, f"{len(data)} bytes; a head has at most {MAX_FILE}")
    if len(data) < 20 or data[:4] != b"glTF":
        raise DataError(where, None, "not a GLB file")
    version, length = struct.unpack_from("<II", data, 4)
    if version != 2 or length != len(data):
        raise DataError(where, None, f"GLB header says version {version}, {length} of {len(data)} bytes")
    chunks: list[tuple[bytes, bytes]] = []
    offset = 12
    while offset + 8 <= length and len(chunks) < 2:
        size, kind = struct.unpack_from("<I4s", data, offset)
        if offset + 8 + size > length:
            raise DataError(where, None, f"the chunk at byte {offset} runs past the end of the file")
        chunks.append((kind, data[offset + 8 : offset + 8 + size]))
        offset += 8 + size
    if not chunks or chunks[0][0] != b"JSON":
        raise DataError(where, None, "the first chunk is not JSON")
    binary = chunks[1][1] if len(chunks) == 2 and chunks[1][0] == b"BIN\0" else b""
    return _document(chunks[0][1], where), binary


def _document(text: bytes, where: str) -> dict[str, Any]:
    if len(text) > MAX_JSON:
        raise DataError(where, None, f"JSON chunk: {len(text)} bytes; at most {MAX_JSON} are read")
    try:
        document = json.loads(text.decode("utf-8"), parse_constant=_no_constant)
    except (ValueError, RecursionError) as error:
        raise DataError(where, None, f"JSON chunk: {error}"[:400]) from None
    if not isinstance(document, dict):
        raise DataError(where, None, "the JSON chunk is not an object")
    return document


def _no_constant(word: str) -> NoReturn:
    raise ValueError(f"{word} is not JSON")


class Document:
    """One document being read; every method says where it stopped.

    `place` is always the path of the value looked at, for the message of the DataError.
    """

    def __init__(self, document: dict[str, Any], binary: bytes, where: str) -> None:
        self.document, self.binary, self.where = document, binary, where
        self.numbers_left, self.pixels_left = MAX_NUMBERS, MAX_PIXELS
        asset = self.mapping(document, "asset", "")
        if asset.get("version") != "2.0":
            self.fail("asset.version", "is not 2.0")

    def accessor(
        self, index: Any, kind: str, types: frozenset[str], place: str, count: int | None = None
    ) -> NDArray[Any]:
        """The numbers as they are stored, shape (count, width); sparse and interleaved ones too.

        `count`, where given, is how many there have to be. A view on the file where that is possible.
        """
        row = self.item("accessors", index, place)
        dtype = COMPONENTS.get(self.integer(row.get("componentType"), 0, 9999, place), "")
        if row.get("type") != kind or dtype not in types:
            self.fail(place, f"accessor is not a {kind} of {' or '.join(sorted(types))}")
        width = WIDTHS[kind]
        n = self.integer(row.get("count"), 1, 8 * MAX_VERTICES, place + ".count")
        if count is not None and n != count:
            self.fail(place, f"has {n} values for {count} vertices")
        self.spend(n * width, place)
        values: NDArray[Any]
        if "bufferView" in row:
            start = self.integer(row.get("byteOffset", 0), 0, MAX_FILE, place + ".byteOffset")
            values = self.rows(row["bufferView"], np.dtype(dtype), (n, width), start, place)
        elif "sparse" in row and count is not None:
            values = np.zeros((n, width), dtype)
        else:
            self.fail(place, "accessor has no buffer view")
        if "sparse" in row:
            values = self.scattered(values, self.mapping(row, "sparse", place + "."), place + ".sparse")
        if dtype == "<f4" and not (np.abs(values) <= MAX_SIZE).all():
            self.fail(place, f"has values that are not finite or beyond {MAX_SIZE:g}")
        return values

    def scattered(self, values: NDArray[Any], sparse: dict[str, Any], place: str) -> NDArray[Any]:
        """A copy of `values` with the rows that a sparse accessor replaces."""
        n = self.integer(sparse.get("count"), 1, len(values), place + ".count")
        at, new = (self.mapping(sparse, key, place + ".") for key in ("indices", "values"))
        dtype = COMPONENTS.get(self.integer(at.get("componentType"), 0, 9999, place), "")
        if dtype not in UNSIGNED:
            self.fail(place + ".indices", "are not unsigned integers")
        starts = (self.integer(row.get("byteOffset", 0), 0, MAX_FILE, place) for row in (at, new))
        indices = self.rows(at.get("bufferView"), np.dtype(dtype), (n, 1), next(starts), place)[:, 0]
        if int(indices.max()) >= len(values):
            self.fail(place + ".indices", f"name row {indices.max()} of {len(values)}")
        values = values.copy()
        values[indices] = self.rows(
            new.get("bufferView"), values.dtype, (n, values.shape[1]), next(starts), place
        )
        return values

    def rows(
        self, view: Any, dtype: np.dtype[Any], shape: tuple[int, int], start: int, place: str
    ) -> NDArray[Any]:
        """Rows of numbers that begin `start` bytes into a buffer view, at its stride."""
        data = self.view(view, place)
        packed = shape[1] * dtype.itemsize
        stride = self.item("bufferViews", view, place).get("byteStride", packed)
        stride = self.integer(stride, packed, 252, place + ".byteStride") if stride != packed else packed
        need = start + (shape[0] - 1) * stride + packed
        if need > len(data):
            self.fail(place, f"needs {need} bytes of a view of {len(data)}")
        return np.ndarray(shape, dtype, data, start, (stride, dtype.itemsize))

    def view(self, index: Any, place: str) -> memoryview:
        row = self.item("bufferViews", index, place)
        if row.get("buffer") != 0 or "extensions" in row:
            self.fail(place, "its buffer view is compressed or not in the binary chunk")
        start = self.integer(row.get("byteOffset", 0), 0, MAX_FILE, place)
        size = self.integer(row.get("byteLength"), 1, MAX_FILE, place)
        if start + size > len(self.binary):
            self.fail(place, f"its buffer view ends at {start + size} of {len(self.binary)} bytes")
        return memoryview(self.binary)[start : start + size]

    def picture(self, reference: Any, place: str) -> tuple[bytes, str]:
        """The encoded bytes and the MIME type of the picture a texture reference leads to."""
        if not isinstance(reference, dict):
            self.fail(place, "is not an object")
        texture = self.item("textures", reference.get("index"), place)
        image = self.item("images", texture.get("source"), place)
        if "bufferView" not in image:
            self.fail(place, "its image is not embedded in the binary chunk")
        data = bytes(self.view(image["bufferView"], place))
        size = picture_size(data)
        if size is None:
            self.fail(place, "its image is no PNG, JPEG or WebP")
        width, height = size
        if width > MAX_PICTURE or height > MAX_PICTURE:
            self.fail(place, f"its image has {width} x {height} pixels; {MAX_PICTURE} a side are the limit")
        self.pixels_left -= width * height
        if self.pixels_left < 0:
            self.fail(place, f"the images together have more than {MAX_PIXELS} pixels")
        return data, str(image.get("mimeType", ""))

    def spend(self, numbers: int, place: str) -> None:
        self.numbers_left -= numbers
        if self.numbers_left < 0:
            self.fail(place, f"the accessors together have more than {MAX_NUMBERS} numbers")

    def item(self, table: str, index: Any, place: str) -> dict[str, Any]:
        rows = self.document.get(table)
        if not isinstance(rows, list) or type(index) is not int or not 0 <= index < len(rows):
            self.fail(place, f"{table}[{index!r}] does not exist")
        row = rows[index]
        if not isinstance(row, dict):
            self.fail(place, f"{table}[{index}] is not an object")
        return row

    def mapping(self, row: dict[str, Any], key: str, place: str) -> dict[str, Any]:
        value = row.get(key)
        if not isinstance(value, dict):
            self.fail(place + key, "is missing or not an object")
        return value

    def sequence(self, row: dict[str, Any], key: str, limit: int, place: str = "") -> Sequence[Any]:
        value = row.get(key)
        if not isinstance(value, list) or len(value) > limit:
            self.fail(f"{place}.{key}".lstrip("."), f"is not a list of at most {limit}")
        return value

    def vector(self, value: Any, size: int, place: str) -> tuple[float, ...]:
        if not isinstance(value, list) or len(value) != size:
            self.fail(place, f"is not {size} numbers")
        return tuple(self.number(number, place) for number in value)

    def point(self, value: Any, place: str) -> Point:
        x, y, z = self.vector(value, 3, place)
        return x, y, z

    def positive(self, value: Any, place: str) -> float:
        number = self.number(value, place)
        if number <= 0:
            self.fail(place, f"is {number}, not positive")
        return number

    def number(self, value: Any, place: str) -> float:
        if type(value) not in (int, float) or not -1e6 <= value <= 1e6:
            self.fail(place, f"{value!r:.40} is not a number")
        return float(value)

    def integer(self, value: Any, low: int, high: int, place: str) -> int:
        if type(value) is not int or not low <= value <= high:
            self.fail(place, f"{value!r:.40} is not an integer from {low} to {high}")
        return value

    def fail(self, place: str, reason: str) -> NoReturn:
        raise DataError(self.where, None, f"{place}: {reason}"[:400])
