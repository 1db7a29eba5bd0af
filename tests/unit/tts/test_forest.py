"""Packed forests: what tools/grow_trees.py grows is what is asked."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from fapstream.tts.forest import LEAF, Forest, second_branches
from tools.grow_trees import Examples, Options, Packer, Tree


@given(st.lists(st.booleans(), max_size=40))
def test_second_branches(splits: list[bool]) -> None:
    """Any tree, written down in preorder; each second branch begins where the first one's subtree ends."""
    inner: list[bool] = []
    expected: list[int] = []

    def write(depth: int) -> None:
        here = bool(splits) and depth < 8 and splits.pop()
        inner.append(here)
        expected.append(0)
        if here:
            at = len(inner) - 1
            write(depth + 1)
            expected[at] = len(inner)
            write(depth + 1)

    write(0)
    write(0)
    found = second_branches(np.where(inner, 0, LEAF).astype(np.uint8)).tolist()
    assert [f * i for f, i in zip(found, inner, strict=True)] == expected


def grown(trees: int = 3) -> tuple[Forest, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(3)
    x = rng.integers(0, 5, (4, 400)).astype(np.uint8)
    y = np.where(x[0] == 2, 0, np.where(x[2] == 1, 1, np.where(x[3] == 4, 2, 3)))
    packer = Packer(trees)
    for _ in range(26 * trees):
        packer.add(Tree(Examples(x, y, 4), rng, Options(0.7, 0.2, 0.1)), np.array([7, 5, 9, 1]))
    return Forest(b"??" + packer.pack(), 2), x, y


def test_the_trees_learn_a_rule() -> None:
    forest, x, y = grown()
    names = [7, 5, 9, 1]
    for column in range(0, 400, 7):
        votes = forest.vote(column % 26, bytes(x[:, column]))
        assert max(votes, key=lambda vote: vote[1])[0] == names[y[column]]
        assert abs(sum(p for _, p in votes) - 1) < 0.01


def test_where_it_ends() -> None:
    packer = Packer(1)
    x = np.zeros((2, 3), np.uint8)
    for _ in range(26):
        packer.add(
            Tree(Examples(x, np.zeros(3, np.int64), 1), np.random.default_rng(), Options(1, 1, 0)),
            np.array([4]),
        )
    data = packer.pack()
    assert Forest(data + b"more").end == len(data)
    assert Forest(data).vote(3, b"\0\0") == [(4, 1.0)]
