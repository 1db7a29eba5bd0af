"""write_head, by reading back what it wrote."""

from dataclasses import replace

import numpy as np

from fapstream.head.gltf import read_head
from fapstream.head.gltf_write import write_head
from fapstream.head.mesh import Image, Material
from tests.unit.head.packaged import packaged_data
from tests.unit.head.test_picture import encoded

GENERIC = packaged_data()


def test_what_is_written_reads_back_the_same() -> None:
    head = read_head(GENERIC)
    again = read_head(write_head(head))
    assert [part.name for part in again.parts] == [part.name for part in head.parts]
    for one, other in zip(head.parts, again.parts, strict=True):
        np.testing.assert_array_equal(one.positions, other.positions)
        np.testing.assert_array_equal(one.triangles, other.triangles)
        assert one.material == other.material
    for one, other in zip(head.fat, again.fat, strict=True):
        assert (one.drive, one.part, one.knots, one.scale) == (
            other.drive, other.part, other.knots, other.scale,
        )  # fmt: skip
        np.testing.assert_array_equal(one.deltas, other.deltas)
    for one, other in zip(head.turns, again.turns, strict=True):
        assert (one.faps, one.axes, one.parts, one.pivot) == (
            other.faps,
            other.axes,
            other.parts,
            other.pivot,
        )
        assert {k: v.tolist() for k, v in one.weights.items()} == {
            k: v.tolist() for k, v in other.weights.items()
        }
    assert (again.fdp, again.fapu, again.mouth, again.camera) == (
        head.fdp,
        head.fapu,
        head.mouth,
        head.camera,
    )


def test_a_normal_map_and_a_mixed_drive_are_kept() -> None:
    head = read_head(GENERIC)
    pores = Image(encoded("PNG", (8, 8)), "image/png")
    skin = replace(head.part("skin"), material=Material("skin", normal=pores, normal_repeat=8.0))
    entry = replace(
        head.fat[0],
        part="skin",
        drive=((3, 0.5), (5, -1.25)),
        knots=tuple(1.25 * k for k in range(1, len(head.fat[0].knots) + 1)),
    )
    again = read_head(write_head(replace(head, parts=(skin, *head.parts[1:]), fat=(entry,))))
    assert again.part("skin").material == skin.material
    np.testing.assert_array_equal(again.part("skin").uvs, skin.uvs)
    assert (again.fat[0].drive, again.fat[0].knots, again.fat[0].faps) == (entry.drive, entry.knots, (3, 5))


def test_writing_is_deterministic() -> None:
    head = read_head(GENERIC)
    assert write_head(head) == write_head(head) == GENERIC
