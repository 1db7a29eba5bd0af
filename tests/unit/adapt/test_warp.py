"""Warps of space."""

from __future__ import annotations

import numpy as np
import pytest

from fapstream.adapt.warp import Chain, Eased, jacobians, unfolded


def test_a_chain_is_one_after_the_other_and_slopes_multiply() -> None:
    turn = np.array([[0.0, -2, 0], [1, 0, 0], [0, 0, 3]])
    first, second = (lambda p: p @ turn.T + 1), (lambda p: p**2)
    points = np.random.default_rng(0).normal(size=(4, 3))
    chain = Chain((first, second))
    np.testing.assert_allclose(chain(points), second(first(points)))
    wanted = 2 * first(points)[:, :, None] * turn
    np.testing.assert_allclose(jacobians(chain, points), wanted, atol=1e-6)


SHEET = np.stack(
    [*np.meshgrid(np.linspace(-1, 1, 21), np.linspace(-1, 1, 21)), np.zeros((21, 21))], -1
).reshape(-1, 3)
CELLS = np.array([[21 * i + j, 21 * i + j + 1, 21 * i + j + 21] for i in range(20) for j in range(20)])


def same(points: np.ndarray) -> np.ndarray:
    return points.copy()


@pytest.mark.parametrize("strength", [0.1, 0.9, 1.3, 4.0, -3.0])
def test_a_warp_that_folds_is_gone_only_so_far(strength: float) -> None:
    def pinched(points: np.ndarray) -> np.ndarray:
        """Folds where strength exceeds 1."""
        moved = points.copy()
        moved[:, 0] -= strength * np.sin(6 * points[:, 0]) / 6
        return moved

    warp, moved = unfolded(pinched, same, SHEET, CELLS)
    np.testing.assert_allclose(moved, warp(SHEET))
    slopes = np.linalg.det(jacobians(warp, SHEET))
    assert slopes.min() > -0.05
    if strength in (0.1, 0.9):
        assert warp is pinched
    else:
        assert isinstance(warp, Eased)
        assert warp.share < 1


def test_what_folds_even_a_little_way_is_not_gone_at_all() -> None:
    assert unfolded(lambda p: p * (-1e6, 1, 1), same, SHEET, CELLS)[0] is same
