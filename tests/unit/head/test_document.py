"""The container and the accessors, with everything in them bounded."""

import json
import struct

import numpy as np
import pytest

from fapstream.errors import DataError
from fapstream.head.document import MAX_NUMBERS, Document, split_glb
from tests.unit.head.avatars import packed

BINARY = (
    struct.pack("<12f", *range(12))
    + bytes([2, 0, 0, 0])
    + struct.pack("<3f", 7, 8, 9)
    + b"\x89PNG\r\n\x1a\n"
    + bytes(60)
)
FLOAT = frozenset({"<f4"})


def document(**tables: object) -> Document:
    views = [
        {"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteLength": 48, "byteStride": 24},
        {"buffer": 0, "byteOffset": 48, "byteLength": 4}, {"buffer": 0, "byteOffset": 52, "byteLength": 12},
        {"buffer": 0, "byteOffset": 64, "byteLength": 60}, {"buffer": 1, "byteLength": 4},
        {"buffer": 0, "byteLength": 1 << 25}, {"buffer": 0, "byteLength": 48, "byteStride": 1},
    ]  # fmt: skip
    return Document({"asset": {"version": "2.0"}, "bufferViews": views, **tables}, BINARY, "x.glb")


def accessor(**row: object) -> dict:
    return {"componentType": 5126, "type": "VEC3", "count": 4, "bufferView": 0, **row}


SPARSE = {"count": 1, "indices": {"bufferView": 2, "componentType": 5121}, "values": {"bufferView": 3}}


def test_plain_interleaved_and_sparse_accessors() -> None:
    rows = [accessor(), accessor(bufferView=1, count=2), accessor(sparse=SPARSE), accessor(sparse=SPARSE)]
    del rows[3]["bufferView"]
    doc = document(accessors=rows)
    plain, strided, sparse, zeros = (
        doc.accessor(k, "VEC3", FLOAT, "p", row["count"]) for k, row in enumerate(rows)
    )
    np.testing.assert_array_equal(plain, np.arange(12).reshape(4, 3))
    np.testing.assert_array_equal(strided, [[0, 1, 2], [6, 7, 8]])
    np.testing.assert_array_equal(sparse, [[0, 1, 2], [3, 4, 5], [7, 8, 9], [9, 10, 11]])
    np.testing.assert_array_equal(zeros, [[0, 0, 0], [0, 0, 0], [7, 8, 9], [0, 0, 0]])
    np.testing.assert_array_equal(plain, np.arange(12).reshape(4, 3))


BROKEN = {
    "count 2^31": (accessor(count=1 << 31), "2147483648 is not"),
    "count without bytes": ({**accessor(count=1 << 22), "bufferView": None}, "bufferViews"),
    "count without view": (
        {k: v for k, v in accessor(count=1 << 23).items() if k != "bufferView"}, "no buffer view",
    ),
    "count": (accessor(count=5), "needs 60 bytes"),
    "offset": (accessor(byteOffset=4), "needs 52 bytes"),
    "offset negative": (accessor(byteOffset=-4), "-4 is not"),
    "offset fraction": (accessor(byteOffset=0.5), "0.5 is not"),
    "type": (accessor(type="VEC2"), "not a VEC3"),
    "component": (accessor(componentType=5130), "not a VEC3"),
    "component nothing": (accessor(componentType=None), "None is not"),
    "buffer": (accessor(bufferView=5), "not in the binary chunk"),
    "view beyond": (accessor(bufferView=6), "ends at 33554432"),
    "view nowhere": (accessor(bufferView=99), r"bufferViews\[99\]"),
    "stride": (accessor(bufferView=7), "1 is not an integer from 12"),
    "sparse row": (accessor(count=2, sparse=SPARSE), "name row 2 of 2"),
    "sparse count": (accessor(sparse={**SPARSE, "count": 5}), "5 is not"),
    "sparse float": (
        accessor(sparse={**SPARSE, "indices": {"bufferView": 2, "componentType": 5126}}), "unsigned",
    ),
    "sparse short": (accessor(sparse={**SPARSE, "values": {"bufferView": 2}}), "needs 12 bytes"),
    "sparse nothing": (accessor(sparse={"count": 1}), "indices"),
    "not finite": (accessor(bufferView=4, count=4), "not finite"),
}  # fmt: skip


@pytest.mark.parametrize("name", BROKEN)
def test_a_broken_accessor_is_refused_with_the_place(name: str) -> None:
    row, reason = BROKEN[name]
    doc = document(accessors=[row])
    doc.binary = BINARY[:64] + np.full(15, np.nan, "<f4").tobytes()
    with pytest.raises(DataError, match=rf"x\.glb: p.*{reason}"):
        doc.accessor(0, "VEC3", FLOAT, "p")


def test_floats_whose_squares_would_be_infinite_are_refused() -> None:
    doc = document(accessors=[accessor(bufferView=4, count=4)])
    for value in (1e9, -1e9, 1e38):
        doc.binary = BINARY[:64] + np.full(15, value, "<f4").tobytes()
        with pytest.raises(DataError, match=r"x\.glb: p.*beyond 1e\+08"):
            doc.accessor(0, "VEC3", FLOAT, "p")


def test_the_same_numbers_over_and_over_come_to_an_end() -> None:
    doc = document(accessors=[accessor()])
    for _ in range(3):
        doc.spend(MAX_NUMBERS // 3, "p")
    with pytest.raises(DataError, match="together"):
        doc.spend(12, "p")


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"images": [{"uri": "https://example.org/x.png"}]}, "not embedded"),
        ({"images": [{"uri": "data:image/png;base64,AAAA"}]}, "not embedded"),
        ({"images": [{"bufferView": 4}]}, "99999 x 20 pixels"),
        ({"images": [{"bufferView": 0}]}, "no PNG, JPEG or WebP"),
        ({"images": []}, r"images\[0\] does not exist"),
        ({"textures": [{}]}, r"images\[None\]"),
    ],
)
def test_a_picture_is_embedded_and_of_bounded_size(change: dict, reason: str) -> None:
    doc = document(**{"textures": [{"source": 0}], **change})
    doc.binary = BINARY[:64] + b"\x89PNG\r\n\x1a\n" + bytes(8) + struct.pack(">II", 99999, 20) + bytes(60)
    with pytest.raises(DataError, match=reason):
        doc.picture({"index": 0}, "p")


@pytest.mark.parametrize(
    "text",
    [
        b"",
        b"[1]",
        b"{",
        b"[" * 100_000,
        b'{"a":' * 60_000,
        b'{"a": 1' + b"0" * 5000 + b"}",
        b"\xff\xfe",
        b" " * (9 << 20),
    ],
    ids=["empty", "array", "cut", "deep", "deep objects", "huge number", "no text", "too long"],
)
def test_json_that_is_none_is_refused(text: bytes) -> None:
    with pytest.raises(DataError, match=r"x\.glb"):
        Document(*split_glb(packed(text, b""), "x.glb"), "x.glb")


def test_chunks_beyond_the_file_are_refused() -> None:
    data = packed(json.dumps({"asset": {}}).encode(), bytes(8))
    for at, value in ((4, 1), (8, 9), (12, 1 << 30), (8, 1 << 31)):
        broken = bytearray(data)
        struct.pack_into("<I", broken, at, value)
        with pytest.raises(DataError, match=r"x\.glb"):
            split_glb(bytes(broken), "x.glb")
