"""FAPs mean what the standard says, whatever the tables were."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fapstream.adapt.norms import MOST, normed, part_of, stored
from fapstream.head.mesh import Head
from tests.unit.head.packaged import packaged


def distorted(head: Head, factor: float) -> Head:
    return replace(head, fat=tuple(replace(entry, scale=entry.scale * factor) for entry in head.fat))


@pytest.mark.parametrize("factor", [0.6, 1.7])
def test_tables_that_are_too_strong_or_too_weak_are_brought_right(factor: float) -> None:
    head = packaged()
    for new, old in zip(normed(distorted(head, factor), head).fat, head.fat, strict=True):
        if 47 in old.faps:
            continue  # an angle: nothing to measure it by
        size, wanted = (np.linalg.norm(e.deltas.astype(float)) * e.scale for e in (new, old))
        assert size == pytest.approx(wanted, rel=0.01), old.faps


def test_a_table_of_another_kind_is_not_blown_up() -> None:
    head = packaged()
    still = replace(head, fat=tuple(replace(e, scale=e.scale * 1e-3) for e in head.fat))
    for new, old in zip(normed(still, head).fat, still.fat, strict=True):
        assert (
            np.linalg.norm(new.deltas * new.scale)
            <= 1.01 * MOST * np.linalg.norm(old.deltas * old.scale) + 1e-6
        )


def test_points_and_their_parts() -> None:
    assert part_of("3.5") == "eye_l"
    assert part_of("6.2") == "tongue"
    assert part_of("9.9") == "teeth_lower"
    assert part_of("9.15") == "skin"
    head = packaged()
    for name, place in head.fdp.items():
        if not name.startswith(("11.", "7.")):
            assert np.linalg.norm(head.part(part_of(name)).positions - place, axis=1).min() < 2e-3, name


def test_displacements_keep_their_value_to_a_fraction_of_a_percent() -> None:
    entry = packaged().fat[0]
    moves = np.random.default_rng(0).normal(0, 0.004, (len(entry.knots), entry.indices.size, 3))
    again = stored(entry, moves)
    assert np.abs(again.deltas * again.scale - moves).max() <= 0.51 * again.scale
    assert again.scale < np.abs(moves).max() / 250
    assert not stored(entry, moves * 0).deltas.any()
