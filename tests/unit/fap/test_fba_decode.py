"""FBA streams: bits written by hand from the syntax, and hostile ones."""

from __future__ import annotations

import time
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fapstream.errors import BitstreamError
from fapstream.fap import fba_decode
from fapstream.fap.fba_decode import decode_fba
from fapstream.fap.fba_encode import FbaOptions, encode_fba
from fapstream.fap.sequence import FapSequence
from fapstream.records import VisemeFap
from tests.unit.fap import hand
from tests.unit.fap.hand import ONE_FAP_BACK, ONE_FAP_I, ONE_FAP_P, VISEME_I, VISEME_P, bits, stream

CORPUS = Path(__file__).with_name("corpus")


def changed(text: str, comment: str, to: str) -> str:
    """With other bits in the line whose comment begins so."""
    lines = text.splitlines()
    (at,) = (k for k, line in enumerate(lines) if line.partition("# ")[2].startswith(comment))
    return "\n".join([*lines[:at], to, *lines[at + 1 :]])


def test_one_fap_by_hand() -> None:
    found = decode_fba(stream(ONE_FAP_I, ONE_FAP_P, ONE_FAP_BACK), "s", "hand")
    assert (found.name, found.version, found.fps, found.notes) == ("hand", "2.1", 25, ())
    assert hand.same(found.frames, hand.ONE_FAP)


def test_a_viseme_a_mirrored_fap_and_skipped_frames_by_hand() -> None:
    found = decode_fba(stream(VISEME_I, VISEME_P), "s")
    assert found.fps == 12.5
    assert hand.same(found.frames, hand.VISEME)
    assert found.length == 18
    defining = decode_fba(stream(VISEME_I, changed(VISEME_P, "viseme_def", "1")), "s").frames[1]
    assert defining.viseme == VisemeFap(3, 0, 30, define=True)


def test_planes_may_begin_with_start_codes() -> None:
    """Every plane after stuffing; the first right behind the object's code, and behind 01111111."""
    first, second = bits(ONE_FAP_I), bits(ONE_FAP_P)
    code = bits(hand.PLANE)
    for before in ("", code, "01111111" + code):
        body = before + first
        body += "0" + "1" * (-(len(body) + 1) % 8) + code + second
        assert hand.same(decode_fba(stream(body), "s").frames, hand.ONE_FAP[:2])


def test_an_i_frame_begins_anew_and_keeps_what_it_masks() -> None:
    other = changed(ONE_FAP_I, "group 2", "1 01 0000000000000010")  # FAP 4, steps of 2 * 3
    found = decode_fba(stream(ONE_FAP_I, ONE_FAP_P, other), "s")
    assert hand.same(found.frames[2:], (hand.row(2, {4: 60}),))
    assert found.low_level()[:, [2, 3]].tolist() == [[120, 0], [132, 0], [132, 60]]


def test_mask_type_3_is_the_whole_group() -> None:
    """Group 5, FAPs 39-42. Each can only be 0, which takes no bits but those of the flush."""
    text = changed(ONE_FAP_I, "group 2", "1 00")
    text = changed(text, "groups 3", "1 00 1 00 1 11 1 00")
    for limit in ("largest in I", "least in I", "largest in P", "least in P"):
        text = changed(text, limit, "1111 111 11 1 00000 00000 00000 00000 11 1 111 1 1")
    found = decode_fba(stream(changed(text, "10 of 0..60", "01")), "s").frames
    assert hand.same(found, (hand.row(0, dict.fromkeys(range(39, 43), 0)),))


def test_time_codes_and_rates() -> None:
    text = changed(ONE_FAP_I, "is_frame_rate", "1 00011110 0000 1")
    text = changed(text, "is_time_code", "1 00001 000010 1 000011")
    found = decode_fba(stream(text), "s")
    assert found.fps == pytest.approx(30_000 / 1001)
    assert [str(n) for n in found.notes] == ["the time code begins at 01:02:03"]
    text = changed(ONE_FAP_I, "is_frame_rate", "0")
    assert [str(n) for n in decode_fba(stream(text), "s").notes] == [
        "no frame rate: taken for 25 frames a second"
    ]


def test_what_stands_around_is_noted() -> None:
    found = decode_fba(b"\0\0\1\xb0\x55" + stream(ONE_FAP_I) + b"more", "s")
    assert hand.same(found.frames, hand.ONE_FAP[:1])
    assert [str(n) for n in found.notes] == [
        "something before the FBA object; skipped", "something after the end code; ignored"
    ]  # fmt: skip


@pytest.mark.parametrize("stuffing", ["", "0111111"])
def test_no_end_code(stuffing: str) -> None:
    whole = bits(ONE_FAP_I)
    whole += "0" + "1" * (-(len(whole) + 1) % 8)
    found = decode_fba(stream(whole, last=""), "s")
    assert hand.same(found.frames, hand.ONE_FAP[:1])
    assert [str(n) for n in found.notes] == ["no end code"]


def test_quant_0_is_a_step_of_1() -> None:
    found = decode_fba(stream(changed(ONE_FAP_I, "fap_quant", "00000"), ONE_FAP_P), "s")
    assert [int(r.values[2]) for r in found.frames] == [10, 11]


BODY = changed(ONE_FAP_I, "fba_object_mask", "11")
NO_FACE = changed(ONE_FAP_I, "fba_object_mask", "00")
MARKER = changed(ONE_FAP_I, "group 1", "0 00")
DCT = changed(ONE_FAP_I, "fba_object_coding_type", "1")
RATE_0 = changed(ONE_FAP_I, "is_frame_rate", "1 00000000 0000 0")
HOUR_24 = changed(ONE_FAP_I, "is_time_code", "1 11000 000000 1 000000")
RATE_50 = changed(ONE_FAP_I, "is_frame_rate", "1 00110010 0000 0")


@pytest.mark.parametrize(
    ("data", "bit", "reason"),
    [
        (b"", 0, "no FBA object start code"),
        (b"RIFF....", 0, "no FBA object start code"),
        (b"\0\0\1\xba", None, None),
        (stream(BODY), 33, "body animation is not supported"),
        (stream(NO_FACE), 34, "without a face"),
        (stream(MARKER), 56, "a marker bit is 0"),
        (stream(DCT), 32 + 71, "the DCT mode is not supported"),
        (stream(RATE_0), 36, "frame rate 0"),
        (stream(HOUR_24), 50, "24:0:0 is no time code"),
        (stream(ONE_FAP_I, RATE_50), None, "change of the frame rate"),
        (stream(ONE_FAP_P), 36, "a P frame before the first I frame"),
        (stream(ONE_FAP_I) [:-4] + b"\0\0\1\xb6", None, "start code 0x000001b6 within"),
        (stream(VISEME_I, changed(VISEME_P, "FAP 1", "111011011100110")), None, "FAP 1 is"),
    ],
)  # fmt: skip
def test_what_is_refused_says_where(data: bytes, bit: int | None, reason: str | None) -> None:
    if reason is None:
        assert decode_fba(data, "s").frames == ()
        return
    with pytest.raises(BitstreamError, match=reason) as caught:
        decode_fba(data, "bad.fba")
    assert bit is None or caught.value.bit == bit
    assert str(caught.value).startswith(f"bad.fba, byte {caught.value.bit // 8} bit {caught.value.bit % 8}: ")


def test_every_truncation_is_refused_or_noted() -> None:
    """Behind a byte with which a plane ends, what is left is whole; else it is not."""
    whole = stream(VISEME_I, VISEME_P)
    for size in range(4, len(whole)):
        with suppress(BitstreamError):
            found = decode_fba(whole[:size], "s")
            assert "no end code" in [str(n) for n in found.notes]
            assert hand.same(found.frames, hand.VISEME[: len(found.frames)])


def test_too_many_frames(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fba_decode, "MAX_FRAMES", 17)
    with pytest.raises(BitstreamError, match="more than 17 frames"):
        decode_fba(stream(VISEME_I, VISEME_P), "s")


def test_values_fit_in_32_bits(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fba_decode, "MAX_VALUE", 131)
    with pytest.raises(BitstreamError, match="a FAP that does not fit in 32 bits"):
        decode_fba(stream(ONE_FAP_I, ONE_FAP_P), "s")


def test_hours_of_skipped_frames_are_refused_at_once() -> None:
    with pytest.raises(BitstreamError, match="more than 360000 frames"):
        decode_fba(stream(VISEME_I, "0 01 1" + "1" * 4 * 30_000 + "0000"), "s")


def test_still_planes_are_small() -> None:
    """Rows that change nothing share their arrays."""
    still = FapSequence.of_values(np.zeros((2, 68), np.int32), "n", 25)
    data, _ = encode_fba(still)
    found = decode_fba(data, "s").frames
    assert found[0].values is found[1].values


def speech(seed: int, frames: int = 40) -> FapSequence:
    """Something that moves like a mouth."""
    rng = np.random.default_rng(seed)
    values = np.zeros((frames, 68), np.int32)
    walk = np.cumsum(rng.integers(-40, 41, (frames, 12)), axis=0)
    values[:, [2, 3, 4, 5, 7, 9, 50, 51, 52, 30, 47, 48]] = walk
    values[:, [6, 8, 10]] = values[:, [5, 7, 9]]
    return FapSequence.of_values(values, "n", 25)


STREAMS = [stream(ONE_FAP_I, ONE_FAP_P), stream(VISEME_I, VISEME_P), encode_fba(speech(1))[0],
           encode_fba(speech(2), FbaOptions(1, 7))[0]]  # fmt: skip


def survives(data: bytes) -> None:
    """Decodes, or raises the typed error, in a time that goes with the size."""
    began = time.process_time()
    with suppress(BitstreamError):
        found = decode_fba(data, "fuzz")
        assert all(r.values.shape == (68,) for r in found.frames)
    assert time.process_time() - began < 2 + len(data) / 1000


@settings(deadline=None)
@given(st.binary(max_size=400))
def test_fuzz_of_noise(data: bytes) -> None:
    survives(b"\0\0\1\xba" + data)


@settings(max_examples=300, deadline=None)
@given(st.data())
def test_fuzz_of_damaged_streams(data: st.DataObject) -> None:
    found = bytearray(data.draw(st.sampled_from(STREAMS)))
    for _ in range(data.draw(st.integers(1, 5))):
        at = data.draw(st.integers(4, len(found) - 1))
        found[at] = data.draw(st.integers(0, 255))
    survives(bytes(found[: data.draw(st.integers(4, len(found)))]))


@pytest.mark.parametrize("path", sorted(CORPUS.glob("*.fba")), ids=lambda path: path.name)
def test_the_corpus(path: Path) -> None:
    """What was found by mutation: refused, with the place."""
    with pytest.raises(BitstreamError, match=rf"^{path.name}, byte \d+ bit \d: "):
        decode_fba(path.read_bytes(), path.name)
