"""Normals: known surfaces, seams, and nothing that jumps."""

import numpy as np
import pytest

from fapstream.head.mesh import Material, Part
from fapstream.head.normals import NormalField, weld
from tests.unit.head.packaged import packaged

GENERIC = packaged()
SKIN = GENERIC.part("skin")
MOVABLE = np.unique(np.concatenate([entry.indices for entry in GENERIC.fat if entry.part == "skin"]))


def grid(n: int = 9, normals: bool = True) -> Part:
    """A square in the plane z = 0 whose middle column of vertices is there twice, as at a texture seam."""
    x, y = (a.ravel() for a in np.meshgrid(np.linspace(-1, 1, n), np.linspace(-1, 1, n)))
    positions = np.stack([x, y, 0 * x], 1)
    middle = np.arange(n) * n + n // 2
    twin = {int(v): len(positions) + k for k, v in enumerate(middle)}
    triangles = []
    for j in range(n - 1):
        for i in range(n - 1):
            quad = [j * n + i, j * n + i + 1, (j + 1) * n + i + 1, (j + 1) * n + i]
            quad = [twin.get(v, v) for v in quad] if i >= n // 2 else quad
            triangles += [[quad[0], quad[1], quad[2]], [quad[0], quad[2], quad[3]]]
    positions = np.concatenate([positions, positions[middle]]).astype(np.float32)
    up = np.tile(np.float32([0, 0, 1]), (len(positions), 1)) * np.float32(normals)
    uvs = np.zeros((len(positions), 2), np.float32)
    return Part("skin", positions, up, uvs, np.array(triangles, np.uint32), Material("skin"))


def everything(part: Part) -> np.ndarray:
    return np.arange(len(part.positions))


def normals_of(positions: np.ndarray, field: NormalField | None = None) -> np.ndarray:
    """(n, 3) with the skin's vertices, or those of another field's, at (n, 3)."""
    field = field or NormalField([SKIN], MOVABLE)
    return field.at(np.ascontiguousarray(positions.T)).T


@pytest.mark.parametrize("normals", [True, False])
def test_a_bent_sheet_has_the_normals_of_its_surface(normals: bool) -> None:
    """z = x^2 / 10: the normal is (-x/5, 0, 1), and twins of the seam have the same."""
    part = grid(33, normals)
    field = NormalField([part], everything(part))
    np.testing.assert_allclose(field.rest.T, np.tile([0, 0, 1], (len(part.positions), 1)), atol=1e-6)
    bent = part.positions.copy()
    bent[:, 2] = bent[:, 0] ** 2 / 10
    out = normals_of(bent, field)
    inside = np.abs(part.positions[:, :2]).max(axis=1) < 0.99
    expected = np.stack([-part.positions[:, 0] / 5, 0 * bent[:, 0], 1 + 0 * bent[:, 0]], 1)
    expected /= np.linalg.norm(expected, axis=1, keepdims=True)
    np.testing.assert_allclose(out[inside], expected[inside], atol=2e-3)
    np.testing.assert_array_equal(out, out[weld(part)])


def test_twins_of_a_seam_are_one_and_opposite_sides_are_two() -> None:
    part = grid()
    first = weld(part)
    assert len(set(first)) == 81
    two_sided = Part(
        "x",
        np.zeros((2, 3), np.float32),
        np.float32([[0, 0, 1], [0, 0, -1]]),
        np.zeros((2, 2), np.float32),
        np.zeros((0, 3), np.uint32),
        Material("x"),
    )
    assert list(weld(two_sided)) == [0, 1]
    field = NormalField([two_sided], np.arange(0))
    np.testing.assert_array_equal(field.rest.T, two_sided.normals, "the file's own, without a triangle")
    np.testing.assert_array_equal(field.at(field.rest), field.rest)


def test_parts_are_surfaces_of_their_own() -> None:
    """Where one part touches another, even in the same place, each has the normals that it has alone."""
    part, file = grid(9, normals=False), grid(9)
    n = len(part.positions)
    field = NormalField([part, file, part], np.arange(n))
    bent = part.positions + np.float32([0, 0, 0.1]) * part.positions[:, :1] ** 2
    out = normals_of(np.concatenate([bent, file.positions, part.positions]), field)
    np.testing.assert_array_equal(out[:n], normals_of(bent, NormalField([part], everything(part))))
    np.testing.assert_array_equal(out[n:], np.tile(np.float32([0, 0, 1]), (2 * n, 1)))


def test_at_rest_they_are_the_files_own() -> None:
    np.testing.assert_allclose(normals_of(SKIN.positions), SKIN.normals, atol=1e-6)


def test_a_small_movement_changes_them_a_little_and_only_nearby() -> None:
    moved = SKIN.positions.copy()
    vertex = int(np.argmin(np.linalg.norm(SKIN.positions - GENERIC.fdp["2.1"], axis=1)))
    moved[vertex] += np.float32([2e-5, 2e-5, 0])
    out = normals_of(moved)
    changed = np.abs(out - SKIN.normals).max(axis=1) > 1e-6
    assert 3 <= changed.sum() < 40
    assert not changed[vertex], "the sum round a closed ring does not depend on its middle"
    assert np.abs(out - SKIN.normals).max() < 0.2


def test_it_agrees_with_a_sum_over_all_triangles() -> None:
    """The oracle adds face by face; what is compared is the change against rest, the definition."""
    rng = np.random.default_rng(3)
    moved = SKIN.positions.copy()
    moved[MOVABLE] += rng.normal(0, 2e-4, (len(MOVABLE), 3)).astype(np.float32)
    for twin, vertex in enumerate(weld(SKIN)):
        moved[twin] = moved[vertex]
    expected = SKIN.normals + plain(moved) - plain(SKIN.positions)
    np.testing.assert_allclose(normals_of(moved), expected, atol=2e-4)


def plain(positions: np.ndarray) -> np.ndarray:
    total = np.zeros((len(positions), 3))
    a, b, c = (positions[SKIN.triangles[:, k]].astype(float) for k in range(3))
    for k in range(3):
        np.add.at(total, weld(SKIN)[SKIN.triangles[:, k]], np.cross(b - a, c - a))
    normals = total[weld(SKIN)]
    return normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
