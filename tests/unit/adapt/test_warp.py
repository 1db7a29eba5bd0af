"""Warps of space."""

from __future__ import annotations

import numpy as np

from fapstream.adapt.warp import Chain, jacobians


def test_a_chain_is_one_after_the_other_and_slopes_multiply() -> None:
    turn = np.array([[0.0, -2, 0], [1, 0, 0], [0, 0, 3]])
    first, second = (lambda p: p @ turn.T + 1), (lambda p: p**2)
    points = np.random.default_rng(0).normal(size=(4, 3))
    chain = Chain((first, second))
    np.testing.assert_allclose(chain(points), second(first(points)))
    wanted = 2 * first(points)[:, :, None] * turn
    np.testing.assert_allclose(jacobians(chain, points), wanted, atol=1e-6)
