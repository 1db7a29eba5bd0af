"""FBA streams are written as by hand, and come back exact to the quantiser."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from fapstream.errors import InputError
from fapstream.fap.expand import Expander
from fapstream.fap.fba_decode import decode_fba
from fapstream.fap.fba_encode import FbaOptions, encode_fba
from fapstream.fap.rows import FapRow
from fapstream.fap.sequence import FapSequence
from fapstream.fap.tables import coding_ranges, faps
from fapstream.records import N_FAPS, ExpressionFap, VisemeFap
from tests.unit.fap import hand

STEPS = np.array([f.quant for f in faps()])


def encode(sequence: FapSequence, quant: int = 3, intra_every: int = 0) -> bytes:
    data, notes = encode_fba(sequence, FbaOptions(quant, intra_every))
    assert notes == ()
    return data


def test_one_fap_by_hand() -> None:
    data = encode(FapSequence("n", "2.1", 25, hand.ONE_FAP))
    assert data == hand.stream(hand.ONE_FAP_I, hand.ONE_FAP_P, hand.ONE_FAP_BACK)


def test_a_viseme_a_mirrored_fap_and_skipped_frames_by_hand() -> None:
    data = encode(FapSequence("n", "2.1", 12.5, hand.VISEME), quant=1)
    assert data == hand.stream(hand.VISEME_I, hand.VISEME_P)


def moving(*faps: int) -> NDArray[np.int32]:
    """Two frames in which each FAP goes from 0 to ten steps."""
    values = np.zeros((2, N_FAPS), np.int32)
    for fap in faps:
        values[1, fap - 1] = 10 * STEPS[fap - 1]
    return values


def masks(data: bytes) -> list[list[int]]:
    """The FAPs that each plane sends or mirrors."""
    return [(np.flatnonzero(row.mask) + 1).tolist() for row in decode_fba(data, "s").frames]


def test_what_rests_is_masked_off_and_what_mirrors_is_left_out() -> None:
    one_side = encode(FapSequence.of_values(moving(3, 6, 10), "n", 25), 1)
    both = encode(FapSequence.of_values(moving(3, 6, 7, 10, 11), "n", 25), 1)
    assert masks(one_side) == [[3, 6, 10]] * 2
    assert masks(both) == [[3, 6, 7, 10, 11]] * 2
    assert len(both) == len(one_side), "a mask either way"
    assert decode_fba(both, "s").low_level()[1, [5, 6]].tolist() == [20, 20]


def test_one_side_alone_is_sent_with_the_other_where_a_decoder_mirrors() -> None:
    """Else FAP 11 would follow FAP 10, as 7 follows 6."""
    data = encode(FapSequence.of_values(moving(6, 7, 10), "n", 25), 1)
    assert masks(data) == [[6, 7, 10, 11]] * 2
    assert decode_fba(data, "s").low_level()[1, 5:11].tolist() == [20, 20, 0, 0, 20, 0]


def test_still_frames_are_skipped_but_for_the_last() -> None:
    values = np.zeros((40, N_FAPS), np.int32)
    values[20:, 2] = 100
    found = decode_fba(encode(FapSequence.of_values(values, "n", 25), 1), "s")
    assert [row.number for row in found.frames] == [0, 20, 39]
    assert np.array_equal(found.low_level(), values)


def test_i_frames_begin_with_a_start_code() -> None:
    values = np.cumsum(np.full((12, N_FAPS), 40, np.int32), axis=0)
    sequence = FapSequence.of_values(values, "n", 25)
    planes = [encode(sequence, 1, every).count(b"\0\0\1\xbb") for every in (0, 5, 4, 1)]
    assert planes == [0, 2, 2, 11], "the first needs none"
    for every in (0, 5, 4, 1):
        found = decode_fba(encode(sequence, 1, every), "s").low_level()
        assert (np.abs(found[:, 2:] - values[:, 2:]) <= STEPS[2:] / 2).all()


def test_no_false_start_codes() -> None:
    """Largest steps are zeros: 22 of them behind the 0 of skip_frames would be the 23 of a start code where
    they begin with a byte. There the plane gets a real one, which moves it."""
    found = set()
    rng = np.random.default_rng(1)
    for _ in range(60):
        values = np.zeros((2, N_FAPS), np.int32)
        values[0, 13:18] = rng.integers(0, 121, 5) * rng.integers(0, 2, 5)
        values[1, 13:18] = values[0, 13:18] + 60
        data = encode(FapSequence.of_values(values, "n", 25), 1)
        planes = data.count(b"\0\0\1\xbb")
        assert data.count(b"\0\0\1") == 2 + planes
        assert data.count(b"\0\0\0") == 0
        assert np.array_equal(decode_fba(data, "s").low_level(), values)
        found.add(planes)
    assert found == {0, 1}, "both happen"


def test_decoding_may_begin_at_an_i_frame() -> None:
    """The object's start code put before a later I frame makes a stream of its own, and says when it is."""
    values = np.cumsum(np.full((12, N_FAPS), 40, np.int32), axis=0)
    data = encode(FapSequence.of_values(values, "n", 0.001 * 62.5), 1, 6)
    later = b"\0\0\1\xba" + data[data.index(b"\0\0\1\xbb") :]
    found = decode_fba(later, "s")
    assert (np.abs(found.low_level()[:, 2:] - values[6:, 2:]) <= STEPS[2:] / 2).all()
    assert [str(n) for n in found.notes] == ["the time code begins at 00:01:36"], "frame 6 at 16 s a frame"


WALKS = st.tuples(st.integers(1, 9), st.integers(0, 2**32 - 1), st.sampled_from([3, 60, 900]))


@settings(deadline=None, max_examples=25)
@given(WALKS, st.integers(1, 31), st.integers(0, 4))
def test_round_trip_exact_to_the_quantiser(walk: tuple[int, int, int], quant: int, every: int) -> None:
    frames, seed, pace = walk
    rng = np.random.default_rng(seed)
    moves = rng.integers(-pace, pace + 1, (frames, N_FAPS)) * rng.integers(0, 2, (1, N_FAPS))
    values = np.clip(np.cumsum(moves, axis=0), -1800, 1800).astype(np.int32)
    if seed % 2:
        values[:, 6], values[:, 10] = values[:, 5], values[:, 9]
    sequence = FapSequence.of_values(values, "n", 25)
    data = encode(sequence, quant, every)
    found = decode_fba(data, "s")
    face = found.low_level()
    assert face.shape == values.shape
    assert (np.abs(face - sequence.low_level()) <= STEPS * quant / 2).all()
    again = encode(FapSequence.of_values(face, "n", 25), quant, every)
    assert np.array_equal(decode_fba(again, "s").low_level(), face), "what is coded already stays as it is"


def test_what_is_too_fast_or_too_far_is_clipped_and_told() -> None:
    values = np.zeros((4, N_FAPS), np.int32)
    values[1:, 13] = 4000  # FAP 14, step 1
    data, notes = encode_fba(FapSequence.of_values(values, "n", 25), FbaOptions(1))
    assert [str(n) for n in notes] == ["values beyond what can be coded; clipped (2 times)"]
    assert decode_fba(data, "s").low_level()[:, 13].tolist() == [0, 1860, 3720, 4000]


def high_level(*rows: tuple[VisemeFap | None, ExpressionFap | None, dict[int, int]]) -> FapSequence:
    made = []
    for number, (viseme, expression, sent) in enumerate(rows):
        row = hand.row(number, sent, viseme)
        mask = row.mask.copy()
        mask[1] = expression is not None
        made.append(FapRow(number, mask, row.values, viseme, expression))
    return FapSequence("n", "2.1", 25, tuple(made))


def test_high_level_faps() -> None:
    rows = high_level(
        (VisemeFap(3, 14, 63), ExpressionFap(6, 63, 1, 5), {}),
        (VisemeFap(14, 0, 0), None, {48: 1700}),
        (None, ExpressionFap(1, 1, 2, 2), {}),
    )
    found = decode_fba(encode(rows, 1), "s").frames
    assert [row.viseme for row in found] == [VisemeFap(3, 14, 63), VisemeFap(14, 0, 0), VisemeFap(14, 0, 0)]
    one, three = ExpressionFap(6, 63, 1, 5), ExpressionFap(1, 1, 2, 2)
    assert [row.expression for row in found] == [one, one, three]


SELECTS = st.builds(VisemeFap, st.integers(0, 14), st.integers(0, 14), st.integers(0, 63), st.booleans())
FEELINGS = st.builds(
    ExpressionFap, st.integers(0, 6), st.integers(0, 63), st.integers(0, 6), st.integers(0, 63),
    st.booleans(), st.booleans(),
)  # fmt: skip
SENT = st.dictionaries(st.sampled_from([3, 5, 6, 7, 31, 32, 45]), st.integers(-20, 20).map(lambda v: 4 * v))


@settings(deadline=None)
@given(st.lists(st.tuples(st.none() | SELECTS, st.none() | FEELINGS, SENT), min_size=1, max_size=8))
def test_a_decoder_shows_the_same_face(
    rows: list[tuple[VisemeFap | None, ExpressionFap | None, dict[int, int]]],
) -> None:
    """Visemes and expressions, defined ones and a changed neutral face too."""
    sequence = high_level(*rows)
    found = decode_fba(encode(sequence, 1), "s")
    assert np.array_equal(found.low_level(), sequence.low_level())
    assert Expander().step(found.frames[0]).shape == (N_FAPS,)


@pytest.mark.parametrize("fps", [1, 2, 10, 12.5, 25, 29.97, 30, 59.94, 60, 255.9375])
def test_frame_rates(fps: float) -> None:
    data = encode(FapSequence("n", "2.1", fps, hand.ONE_FAP))
    assert decode_fba(data, "s").fps == pytest.approx(fps, rel=1e-3)


@pytest.mark.parametrize("fps", [0.01, 256, 1000, 1.1])
def test_frame_rates_that_cannot_be_said(fps: float) -> None:
    with pytest.raises(InputError, match="cannot be said in FBA"):
        encode(FapSequence("n", "2.1", fps, hand.ONE_FAP))


@pytest.mark.parametrize(("quant", "every"), [(0, 0), (32, 0), (-1, 0), (3, -1)])
def test_options(quant: int, every: int) -> None:
    with pytest.raises(InputError):
        FbaOptions(quant, every)


def test_nothing() -> None:
    with pytest.raises(InputError, match="at least one frame"):
        encode(FapSequence("n", "2.1", 25, ()))


def test_values_of_the_whole_coding_range() -> None:
    """The extreme of every FAP: the standard's I range at its step."""
    values = np.zeros((3, N_FAPS), np.int32)
    values[0], values[2] = coding_ranges()[:, 0] * STEPS, -coding_ranges()[:, 0] * STEPS // 2
    found = decode_fba(encode(FapSequence.of_values(values, "n", 25), 2), "s").low_level()
    assert (np.abs(found - values) <= STEPS).all()
