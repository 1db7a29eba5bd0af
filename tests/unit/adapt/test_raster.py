"""Triangles to pixels."""

from __future__ import annotations

import numpy as np
import pytest

from fapstream.adapt.raster import cover, nearest

SIZE = (40, 30)


def test_a_square_is_covered_once_where_it_is() -> None:
    points = np.array([[5.0, 4], [25, 4], [25, 20], [5, 20]])
    hits = cover(points, np.array([[0, 1, 2], [0, 2, 3]]), SIZE)
    counts = np.bincount(hits.pixels, minlength=SIZE[0] * SIZE[1]).reshape(30, 40)
    inside = np.zeros((30, 40), bool)
    inside[4:20, 5:25] = True
    assert (counts[inside] >= 1).all()
    assert not counts[~inside].any()
    assert counts.sum() <= inside.sum() + 20, "twice along the diagonal at most"


def test_shares_are_barycentric_and_mix_what_corners_have() -> None:
    rng = np.random.default_rng(0)
    points = rng.uniform(-10, 50, (60, 2))
    triangles = rng.integers(0, 60, (40, 3))
    hits = cover(points, triangles, SIZE)
    np.testing.assert_allclose(hits.shares.sum(1), 1, atol=1e-9)
    centres = np.stack([hits.pixels % 40 + 0.5, hits.pixels // 40 + 0.5], 1)
    np.testing.assert_allclose(hits.mixed(triangles, points), centres, atol=1e-6)


def test_every_size_of_triangle_is_found() -> None:
    """One by one and all together give the same."""
    rng = np.random.default_rng(1)
    points = np.concatenate([rng.uniform(0, 40, (30, 2)), rng.uniform(14, 16, (30, 2))])
    triangles = rng.integers(0, 60, (50, 3))
    together = cover(points, triangles, SIZE)
    one_by_one = np.concatenate([cover(points, t[None], SIZE).pixels for t in triangles])
    assert np.array_equal(np.sort(together.pixels), np.sort(one_by_one))


def test_the_nearest_wins() -> None:
    points = np.array([[0.0, 0], [40, 0], [0, 30], [0, 0], [10, 0], [0, 10]])
    triangles = np.array([[3, 4, 5], [0, 1, 2]])
    hits = cover(points, triangles, SIZE)
    closeness = np.where(hits.triangles == 0, 2.0, 1.0)
    chosen, near = nearest(hits, closeness, SIZE)
    assert near[1, 1] == 2.0
    assert hits.triangles[chosen[1, 1]] == 0
    assert near[1, 20] == 1.0
    assert chosen[29, 39] == -1
    assert near[29, 39] == -np.inf


NOTHING: list[list[list[float]]] = [
    [[1, 1], [1, 1], [1, 1]],
    [[1, 1], [2, 2], [3, 3]],
    [[np.nan, 0], [5, 0], [0, 5]],
    [[1e9, 0], [1e9, 5], [2e9, 0]],
    [[-50, -50], [-40, -50], [-50, -40]],
]


@pytest.mark.parametrize("points", NOTHING)
def test_what_is_no_triangle_or_not_there_covers_nothing(points: list[list[float]]) -> None:
    assert not len(cover(np.array(points), np.array([[0, 1, 2]]), SIZE).pixels)
