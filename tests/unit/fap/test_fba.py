"""What FBA encoder and decoder share: groups, ranges, mirror images."""

from __future__ import annotations

import numpy as np
import pytest

from fapstream.fap.fba import GROUPS, KEEP, MIRROR, NONE, Coding, default_ranges, mirror_pairs, steps
from fapstream.fap.tables import faps


def test_groups() -> None:
    assert [len(g) for g in GROUPS] == [2, 16, 12, 8, 4, 5, 3, 10, 4, 4]
    assert np.concatenate(GROUPS).tolist() == list(range(68))


def test_default_ranges() -> None:
    """FAP 3: +-1080 in I, +-360 in P; FAP 48: +-1860 and +-600 (ISO/IEC 14496-2, FAP table)."""
    ranges = default_ranges()
    assert ranges.shape == (2, 68, 2)
    assert ranges[:, 2].tolist() == [[-1080, 1080], [-360, 360]]
    assert ranges[:, 47].tolist() == [[-1860, 1860], [-600, 600]]
    assert ranges[0, 2:, 1].min() >= 300
    assert not ranges[:, :2].any()


def test_mirror_images() -> None:
    """Lids, eyes, brows, cheeks; lips inner and outer; nose and ears: 26 pairs, outward or upward alike."""
    pairs = {(left + 1, right + 1) for left, right in mirror_pairs()}
    assert {(6, 7), (8, 9), (10, 11), (12, 13), (19, 20), (23, 24), (31, 32), (37, 38), (41, 42)} <= pairs
    assert {(53, 54), (55, 56), (57, 58), (59, 60), (61, 62), (65, 66), (67, 68)} <= pairs
    assert all(right == left + 1 for left, right in pairs)
    single = {f.fap for f in faps()} - {fap for pair in pairs for fap in pair}
    assert single == {1, 2, 3, 4, 5, 14, 15, 16, 17, 18, *range(43, 53), 63, 64}


@pytest.mark.parametrize(("kind", "known"), [(KEEP, [5]), (MIRROR, [5, 6])])
def test_mask_types(kind: int, known: list[int]) -> None:
    sent = np.zeros(68, np.bool_)
    sent[5] = True
    coding = Coding(3, (NONE, kind, *[NONE] * 8), sent)
    assert coding.coded.tolist() == [5]
    assert np.flatnonzero(coding.known).tolist() == known


def test_steps() -> None:
    """Of FAPs 3, 4, 14, 23, 47 and 48."""
    assert steps(3)[[2, 3, 13, 22, 46, 47]].tolist() == [12, 6, 3, 384, 1536, 510]
    assert set(steps(0).tolist()) == {1}


def test_models_are_made_once() -> None:
    coding = Coding(3, (NONE,) * 10, np.ones(68, np.bool_))
    jaw = coding.model(True, 2)
    assert (jaw.low, jaw.high) == (-360, 360)
    assert coding.model(True, 2) is jaw
    assert coding.model(False, 2) is not jaw
    assert [(m.low, m.high) for m in coding.parts(False, 1)] == [(0, 6), (0, 63), (0, 6), (0, 63)]
    assert [(m.low, m.high) for m in coding.parts(True, 0)] == [(-14, 14), (-14, 14), (-63, 63)]
