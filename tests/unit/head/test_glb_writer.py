"""The writer against the reader, and against what glTF asks for."""

import numpy as np

from fapstream.head.document import Document, split_glb
from fapstream.head.glb_writer import GlbWriter, narrow
from fapstream.head.mesh import Image, Material

FLOAT = frozenset({"<f4"})


def read(writer: GlbWriter) -> Document:
    return Document(*split_glb(writer.file(), "x.glb"), "x.glb")


def test_equal_arrays_are_stored_once_and_aligned() -> None:
    writer = GlbWriter()
    first = writer.array(np.arange(3, dtype=np.uint8)[:, None])
    assert writer.array(np.arange(3, dtype=np.uint8)[:, None]) == first
    second = writer.array(np.ones((2, 3), np.float32), bounds=True)
    document = read(writer)
    assert all(view["byteOffset"] % 4 == 0 for view in document.document["bufferViews"])
    assert document.document["accessors"][second]["max"] == [1, 1, 1]
    np.testing.assert_array_equal(document.accessor(second, "VEC3", FLOAT, "p"), np.ones((2, 3)))


def test_a_sparse_accessor_reads_back_dense() -> None:
    writer = GlbWriter()
    values = np.zeros((9, 3), np.float32)
    values[[2, 7]] = (1, -2, 3), (4, 5, 6)
    index = writer.sparse(values, np.array([2, 7]))
    nothing = writer.sparse(np.zeros((4, 3), np.float32), np.zeros(0, int))
    document = read(writer)
    np.testing.assert_array_equal(document.accessor(index, "VEC3", FLOAT, "p", 9), values)
    np.testing.assert_array_equal(document.accessor(nothing, "VEC3", FLOAT, "p", 4), np.zeros((4, 3)))
    row = document.document["accessors"][index]
    assert (row["min"], row["max"]) == ([0, -2, 0], [4, 5, 6])


def test_pictures_and_materials_are_shared() -> None:
    writer = GlbWriter()
    image = Image(b"\x89PNG", "image/png")
    one = writer.material(Material("a", texture=image))
    assert writer.material(Material("a", texture=image)) == one
    assert writer.material(Material("b", texture=image, alpha="MASK", cutoff=0.25)) != one
    document = writer.document
    assert len(document["images"]) == 1
    assert document["materials"][1]["alphaCutoff"] == 0.25


def test_indices_take_two_bytes_as_long_as_they_can() -> None:
    assert narrow(np.array([0, 65534])).dtype == np.uint16
    assert narrow(np.array([0, 65535])).dtype == np.uint32
