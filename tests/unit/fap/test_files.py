"""The `.fap` text file: what is written, read back by a parser of a few lines; what the wild writes, read."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.typing import NDArray

from fapstream.errors import DataError
from fapstream.fap import files
from fapstream.fap.files import format_fap, read_fap
from fapstream.fap.sequence import FapSequence
from fapstream.fap.tables import expressions, visemes
from fapstream.records import ExpressionFap, FapFrame, VisemeFap

WILD = Path(__file__).with_name("files")
CORPUS = Path(__file__).with_name("corpus")

VALUES = arrays(
    np.int32,
    st.tuples(st.integers(0, 12), st.just(68)),
    elements=st.integers(-200_000, 200_000),
    fill=st.just(0),
)

THREE = np.zeros((3, 68), np.int32)
THREE[:, 2] = 10, 20, 30
THREE[:, 47] = -100, 0, 100


def wild(name: str) -> FapSequence:
    return read_fap((WILD / name).read_bytes().decode("utf-8"), name)


def frames(values: NDArray[np.int32]) -> list[FapFrame]:
    return [FapFrame(640 * k, row) for k, row in enumerate(values)]


def parse(text: str) -> tuple[list[str], NDArray[np.int32]]:
    """(header fields, values of shape (n, 68)) of a `.fap` file; strict."""
    assert text.endswith("\n")
    assert "  " not in text
    assert " \n" not in text
    first, *lines = text[:-1].split("\n")
    assert len(lines) % 2 == 0
    values = np.zeros((len(lines) // 2, 68), np.int32)
    for k in range(len(values)):
        mask = np.array([{"0": False, "1": True}[m] for m in lines[2 * k].split(" ")])
        assert mask.shape == (68,)
        number, *row = map(int, lines[2 * k + 1].split(" "))
        assert number == k
        values[k, mask] = row
    return first.split(" "), values


@settings(deadline=None)
@given(VALUES, st.sampled_from([25, 50]))
def test_round_trip_of_the_low_level_faps(values: NDArray[np.int32], fps: int) -> None:
    text = format_fap(FapSequence.of(frames(values), "hello", fps))
    header, back = parse(text)
    assert header == ["2.1", "hello", str(fps), str(len(values))]
    assert np.array_equal(back[:, 2:], values[:, 2:])
    assert not back[:, :2].any(), "1 and 2 are composite: what they would stand for is in the others"
    again = read_fap(text, "x")
    assert np.array_equal(again.low_level(), back)
    assert all("range" in str(note) for note in again.notes), "the safe profile leaves nothing else to note"


def test_faps_that_never_move_are_masked_off() -> None:
    values = np.zeros((3, 68), np.int32)
    values[1, 4] = -7
    values[:, 2] = 12
    values[:, 0] = 99
    text = format_fap(FapSequence.of(frames(values), "n", 25))
    masks, rows = text.splitlines()[1::2], text.splitlines()[2::2]
    expected = " ".join("1" if i in (2, 4) else "0" for i in range(68))
    assert masks == [expected] * 3
    assert rows == ["0 12 0", "1 12 -7", "2 12 0"]


def test_nothing_moves_and_nothing_at_all() -> None:
    still = FapSequence.of(frames(np.zeros((2, 68), np.int32)), "n", 25)
    assert parse(format_fap(still))[1].shape == (2, 68)
    assert read_fap(format_fap(still), "x").low_level().shape == (2, 68)
    nothing = format_fap(FapSequence.of([], "n", 50))
    assert nothing == "2.1 n 50 0\n"
    assert read_fap(nothing, "x").low_level().shape == (0, 68)


@pytest.mark.parametrize(
    ("name", "written"), [("a b\tc", "a_b_c"), (" x ", "x"), ("", "untitled"), ("\n", "untitled")]
)
def test_the_name_is_one_word(name: str, written: str) -> None:
    assert format_fap(FapSequence.of([], name, 25)) == f"2.1 {written} 25 0\n"


def test_versions() -> None:
    assert format_fap(FapSequence.of([], "n", 12.5), "2.0") == "2.0 n 12.5 0\n"
    with pytest.raises(ValueError, match=r"2\.0 or 2\.1"):
        format_fap(FapSequence.of([], "n", 25), "3.0")


SAME = {
    # file: what there is to note, by a word of each note
    "plain.fap": (), "version20.fap": (), "crlf.fap": (), "cr.fap": (), "tabs.fap": (), "bom.fap": (),
    "comments.fap": (), "trailing_blanks.fap": (), "changing_masks.fap": (), "slow.fap": (),
    "no_header_no_newline.fap": ("no header", "begin at 4711"), "windows_path.fap": ("not one word",),
    "columns69.fap": ("69 columns",), "from_one.fap": ("begin at 1",), "absolute.fap": ("begin at 90000",),
    "not_rising.fap": ("do not rise",), "floats.fap": ("rounded",), "count_differs.fap": ("promises 120",),
}  # fmt: skip


@pytest.mark.parametrize("name", SAME)
def test_the_wild_says_the_same_in_many_ways(name: str) -> None:
    sequence = wild(name)
    assert np.array_equal(sequence.low_level(), THREE)
    assert sequence.fps == (2 if name == "slow.fap" else 25)
    assert sequence.version == ("2.0" if name == "version20.fap" else "2.1")
    assert [row.number for row in sequence.frames] == [0, 1, 2]
    assert len(sequence.notes) == len(SAME[name])
    assert all(word in str(note) for word, note in zip(SAME[name], sequence.notes, strict=True))


def test_every_fixture_is_read() -> None:
    others = {"held.fap", "empty_values.fap", "gap.fap", "out_of_range.fap", "high_level.fap"}
    assert {path.name for path in WILD.iterdir()} == others | set(SAME)


def test_names_with_spaces_stay_and_are_written_as_one_word() -> None:
    sequence = wild("windows_path.fap")
    assert sequence.name == r"C:\My Animations\three v2.fap"
    assert format_fap(sequence).startswith("2.1 C:\\My_Animations\\three_v2.fap 25 3\n")


def test_the_frame_rate_without_a_header_is_given() -> None:
    text = (WILD / "no_header_no_newline.fap").read_text(encoding="utf-8")
    sequence = read_fap(text, "x", fps=12.5)
    assert (sequence.fps, sequence.version, sequence.declared) == (12.5, "2.1", None)


def test_a_fap_that_is_not_sent_keeps_its_value() -> None:
    face = wild("held.fap").low_level()
    assert face[:, 2].tolist() == [10, 10, 30]
    assert face[:, 4].tolist() == [-7, -8, -8]


def test_value_lines_of_masks_of_zeros_may_be_empty_or_missing() -> None:
    sequence = wild("empty_values.fap")
    assert [row.number for row in sequence.frames] == [0, 1, 2, 3, 4]
    assert sequence.low_level()[:, 2].tolist() == [0, 10, 10, 10, 10]
    (note,) = sequence.notes
    assert str(note) == "line 4: no value line for a mask of zeros (3 times)"


def test_the_face_stays_in_a_gap() -> None:
    sequence = wild("gap.fap")
    assert sequence.low_level()[:, 2].tolist() == [10, 10, 10, 20]
    assert [str(n) for n in sequence.notes] == [
        "frame numbers begin at 10", "frame numbers have gaps, in which the face stays"
    ]  # fmt: skip
    assert parse(format_fap(sequence))[1][:, 2].tolist() == [10, 10, 10, 20]


def test_values_out_of_range_are_kept() -> None:
    sequence = wild("out_of_range.fap")
    assert sequence.low_level()[0, [2, 4]].tolist() == [-99999, 2000000]
    assert [str(n) for n in sequence.notes] == ["line 3: values outside the coding range of their FAP; kept"]


def test_high_level_faps() -> None:
    sequence = wild("high_level.fap")
    assert [row.viseme for row in sequence.frames] == [VisemeFap(10, 0, 63), VisemeFap(10, 1, 21), None]
    assert [row.expression for row in sequence.frames] == [
        ExpressionFap(1, 63), None, ExpressionFap(1, 0, 6, 63)
    ]  # fmt: skip
    head = np.zeros(68)
    head[47] = 500
    joy, surprise = expressions()["joy"], expressions()["surprise"]
    blend = visemes()[10] / 3 + visemes()[1] * 2 / 3
    expected = [visemes()[10] + joy + head, blend + joy + head, blend + surprise + head]
    assert np.abs(sequence.low_level() - np.array(expected)).max() < 0.5 + 1e-9


def test_high_level_faps_are_written_or_expanded() -> None:
    sequence = wild("high_level.fap")
    text = (WILD / "high_level.fap").read_text(encoding="utf-8")
    assert format_fap(sequence) == text
    header, values = parse(format_fap(sequence, low_level_only=True))
    assert header == ["2.1", "high", "10", "3"]
    assert np.array_equal(values, sequence.low_level())


ZEROS = " ".join("0" * 68)
ONE = "1 " + " ".join("0" * 67)
TWO = "0 1 " + " ".join("0" * 66)
THIRD = "0 0 1 " + " ".join("0" * 65)
HEADER = "2.1 n 25 1\n"


@pytest.mark.parametrize(
    ("text", "line", "reason"),
    [
        ("", None, "is empty"),
        ("# only a comment\n", None, "is empty"),
        ("hello\n", 1, "neither a header"),
        ("hello world of faps\n", 1, "neither a header"),
        ("2.1 name\n", 1, "neither a header"),
        ("2.1 n x 3\n", 1, "'x' is no number"),
        ("2.1 n 25 many\n", 1, "'many' is no number"),
        ("2.1 n 0 1\n", 1, "frames a second"),
        ("2.1 n -25 1\n", 1, "frames a second"),
        ("2.1 n 1e9 1\n", 1, "frames a second"),
        ("2.1 n nan 1\n", 1, "'nan' is no number"),
        ("2.1 n 1e999 1\n", 1, "'1e999' is no number"),
        ("2.1 n 25 -1\n", 1, "no count of frames"),
        ("2.1 n 25 1.5\n", 1, "no count of frames"),
        (HEADER + "0 1 0\n", 2, "expected a mask of 68 .* found 3 words: '0 1 0'"),
        (HEADER + ZEROS.replace("0", "2", 1) + "\n0\n", 2, "expected a mask of 68"),
        (HEADER + ZEROS + " 0 0\n0\n", 2, "found 70 words"),
        (HEADER + THIRD + "\n", 2, "the file ends before the mask's 1 values"),
        (HEADER + THIRD + "\n0\n", 3, "found 1 words"),
        (HEADER + "#\n" + THIRD + "\n\n0 1 2\n", 5, "found 3 words"),
        (HEADER + THIRD + "\n" + THIRD + "\n0 1\n", 3, "found 68 words"),
        (HEADER + THIRD + "\n0 x\n", 3, "'x' is no number"),
        (HEADER + THIRD + "\n0 1_0\n", 3, "'1_0' is no number"),
        (HEADER + THIRD + "\n0 ١\n", 3, "is no number"),
        (HEADER + THIRD + "\n0 --1\n", 3, "is no number"),
        (HEADER + THIRD + "\n0 1e10\n", 3, "32 bits"),
        (HEADER + THIRD + "\n0.5 1\n", 3, "no frame number"),
        (HEADER + THIRD + "\n1e300 1\n", 3, "no frame number"),
        (HEADER + THIRD + "\n0 1\n" + THIRD + "\n9000000 1\n", None, "span more than 360000"),
        ("#" * 20_000 + "\n" + "1 " * 9_000, 2, "more than 16384 characters"),
        (HEADER + ONE + "\n0 1 2 3\n", 3, "4 values"),
        (HEADER + ONE + "\n0 15 0 63 0\n", 3, "viseme_select is 15; it must be 0 to 14"),
        (HEADER + ONE + "\n0 1 -1 63 0\n", 3, "viseme_select is -1"),
        (HEADER + TWO + "\n0 7 0 0 0 0 0\n", 3, "expression_select is 7; it must be 0 to 6"),
    ],
)  # fmt: skip
def test_what_is_refused_names_file_line_and_reason(text: str, line: int | None, reason: str) -> None:
    with pytest.raises(DataError, match=reason) as caught:
        read_fap(text, "bad.fap")
    assert (caught.value.path, caught.value.line) == ("bad.fap", line)
    assert str(caught.value).startswith("bad.fap: " if line is None else f"bad.fap:{line}: ")


@pytest.mark.parametrize(
    ("text", "note"),
    [
        ("9.9 n 25 0\n", "version '9.9' is read as 2.1"),
        ("2.1 25 0\n", "not one word"),
        (HEADER + ONE + "\n0 1 0 64 0\n", "blend or intensity of the viseme outside 0 to 63"),
        (HEADER + ONE + "\n0 1 0 63 2\n", "a flag of the viseme that"),
        (HEADER + TWO + "\n0 1 99 0 0 0 0\n", "intensity of the expression outside 0 to 63"),
        (HEADER + TWO + "\n0 1 9 0 0 3 0\n", "a flag of the expression"),
    ],
)
def test_what_is_odd_is_noted(text: str, note: str) -> None:
    assert any(note in str(n) for n in read_fap(text, "x").notes)


def test_too_many_frames(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(files, "MAX_FRAMES", 3)
    text = HEADER + f"{THIRD}\n0 1\n" * 4
    with pytest.raises(DataError, match=r"^x:8: more than 3 frames$"):
        read_fap(text, "x")


def test_notes_do_not_grow_with_the_file() -> None:
    text = HEADER.replace(" 1\n", " 500\n") + f"{THIRD}\n0 0.5\n{ZEROS}\n" * 250
    notes = read_fap(text, "x").notes
    assert len(notes) == 3
    assert {n.count for n in notes} == {250, 1}


PIECES = st.sampled_from(
    ["2.1 n 25 2", ZEROS, ONE, TWO, THIRD, "0 1", "1 5", "0", "", " ", "\n", "\r\n", "\r", "\t", "#", "-1",
     "1e5", "nan", "0 1 2 3 0", "0 1 2 3 4 0 1", "\x00", "\ufeff", "\u2028", "9" * 400, "1e400",
     ".", "+", "\ud800"]
)  # fmt: skip


@settings(deadline=None)
@given(st.lists(PIECES | st.text(max_size=8), max_size=40).map("\n".join) | st.text(max_size=300))
def test_fuzz_only_typed_errors(text: str) -> None:
    try:
        sequence = read_fap(text, "fuzz")
    except DataError:
        return
    assert sequence.low_level().shape == (sequence.length, 68)
    again = read_fap(format_fap(sequence), "again")
    assert np.array_equal(again.low_level(), sequence.low_level())


@settings(deadline=None)
@given(st.data())
def test_fuzz_of_damaged_files(data: st.DataObject) -> None:
    name = data.draw(st.sampled_from(sorted(path.name for path in WILD.iterdir())))
    text = bytearray((WILD / name).read_bytes())
    for _ in range(data.draw(st.integers(0, 4))):
        at = data.draw(st.integers(0, len(text) - 1))
        text[at : at + data.draw(st.integers(0, 30))] = data.draw(st.binary(max_size=4))
        if not text:
            break
    with suppress(DataError):
        assert read_fap(bytes(text).decode("utf-8", "replace"), name).length >= 0


@pytest.mark.parametrize("path", sorted(CORPUS.glob("*.fap")), ids=lambda path: path.name)
def test_the_corpus(path: Path) -> None:
    """What was found by mutation: refused, with the line."""
    with pytest.raises(DataError, match=rf"^{path.name}:\d+: "):
        read_fap(path.read_bytes().decode("utf-8", "replace"), path.name)
