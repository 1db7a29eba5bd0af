"""The text file `.fap`: a header, then a mask line and a value line for each frame.

Files in the wild stray from the grammar in many ways. What can only mean one thing is read, and a note
says what was odd; the rest is refused with file, line and reason.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache
from itertools import pairwise
from math import isfinite

import numpy as np
from numpy.typing import NDArray

from fapstream.errors import DataError
from fapstream.fap.rows import MAX_FRAMES, MAX_VALUE, FapRow, Mask, Notes
from fapstream.fap.sequence import FapSequence
from fapstream.fap.tables import EXPRESSIONS, FULL, N_VISEMES, coding_ranges, faps
from fapstream.records import N_FAPS, ExpressionFap, VisemeFap

VERSIONS = ("2.0", "2.1")
MAX_FPS = 1000
MAX_LINE = 16384
DEFAULT_FPS = 25.0

_PLAIN = re.compile(r"[0-9+\-.eE]+", re.ASCII)
_ENDS = re.compile(r"\r\n|\r|\n")
_WIDTHS = np.array([4, 6, *[1] * (N_FAPS - 2)])
"""How many integers each FAP takes in a value line."""

_NOTHING = np.zeros(N_FAPS, np.int32)
_NOTHING.flags.writeable = False


def read_fap(text: str, where: str, fps: float = DEFAULT_FPS) -> FapSequence:
    """The animation in the `text` of a `.fap` file; `where` names it in errors; `fps` if there is no header.

    Read besides the plain grammar, each with a note: any line ends and white space, a byte order mark,
    comments and blank lines anywhere, no header, spaces in the name, 69 mask columns (the last is dropped),
    masks that change, empty or missing value lines of masks that are all 0, frame numbers from anywhere and
    with gaps (numbers that do not rise are replaced by the order), values that are no whole numbers
    (rounded) or outside the standard's ranges (kept), a frame count that differs.

    Raises DataError with the line: a header that is none, wrong number of columns or values, what is no
    number, selects that name no viseme or expression, values beyond 32 bits, more than MAX_FRAMES.
    """
    return _Reader(text, where).read(fps)


class _Reader:
    def __init__(self, text: str, where: str) -> None:
        self._where = where
        self._lines = _lines(text)
        self._line = 0
        self._put_back: str | None = None
        self._notes = Notes()
        self._masks: dict[str, Mask] = {}

    def read(self, fps: float) -> FapSequence:
        first = self._next()
        if first is None:
            raise DataError(self._where, None, "is empty")
        if _is_mask(first.split()):
            self._notes.add(self._line, f"no header: taken for version 2.1 at {fps:g} frames a second")
            self._put_back = first
            head = _Header("untitled", "2.1", fps, None)
        else:
            head = self._header(first)
        frames = self._frames()
        if head.declared not in (None, len(frames)):
            self._notes.add(0, f"the header promises {head.declared} frames, there are {len(frames)}")
        return FapSequence(head.name, head.version, head.fps, frames, head.declared, self._notes.all())

    def _fail(self, reason: str) -> DataError:
        return DataError(self._where, self._line, reason)

    def _next(self) -> str | None:
        """The next line that is neither blank nor comment; None at the end."""
        if self._put_back is not None:
            line, self._put_back = self._put_back, None
            return line
        for number, raw in self._lines:
            self._line, line = number, raw.strip()
            if line and not line.startswith("#"):
                if len(line) > MAX_LINE:
                    raise self._fail(f"more than {MAX_LINE} characters in a line")
                return line
        return None

    def _header(self, line: str) -> _Header:
        words = line.split()
        if len(words) < 3 or not words[0][0].isdigit():
            raise self._fail(
                f"{_short(line)} is neither a header `2.1 NAME FPS FRAMES` nor a mask of {N_FAPS} columns"
            )
        version, *name, rate, count = words
        if version not in VERSIONS:
            self._notes.add(self._line, f"version {_short(version)} is read as 2.1")
            version = "2.1"
        fps, declared = self._number(rate), self._number(count)
        if not 0 < fps <= MAX_FPS:
            raise self._fail(f"{_short(rate)} frames a second; it must be above 0 and at most {MAX_FPS}")
        if declared < 0 or declared != int(declared):
            raise self._fail(f"{_short(count)} is no count of frames")
        if len(name) != 1:
            self._notes.add(self._line, "the name is not one word")
        return _Header(" ".join(name), version, fps, int(declared))

    def _frames(self) -> tuple[FapRow, ...]:
        rows: list[FapRow] = []
        while (line := self._next()) is not None:
            mask = self._mask(line)
            if len(rows) == MAX_FRAMES:
                raise self._fail(f"more than {MAX_FRAMES} frames")
            rows.append(self._row(mask, len(rows)))
        return self._numbered(rows)

    def _mask(self, line: str) -> Mask:
        known = self._masks.get(line)
        if known is not None:
            return known
        words = line.split()
        if not _is_mask(words):
            raise self._fail(
                f"expected a mask of {N_FAPS} zeros and ones, found {len(words)} words: {_short(line)}"
            )
        if len(words) > N_FAPS:
            self._notes.add(self._line, f"{len(words)} columns in the mask; the last is dropped")
        mask = np.array([w == "1" for w in words[:N_FAPS]])
        mask.flags.writeable = False
        if len(self._masks) < 64:  # real files have a few; never remember all of a hostile one
            self._masks[line] = mask
        return mask

    def _row(self, mask: Mask, order: int) -> FapRow:
        wanted = int(_WIDTHS[mask].sum())
        mask_line, line = self._line, self._next()
        words = line.split() if line is not None else []
        if not wanted and (line is None or _is_mask(words)):
            self._put_back = line
            self._notes.add(self._line, "no value line for a mask of zeros")
            return FapRow(order, mask, _NOTHING)
        if len(words) != wanted + 1:
            if line is None:
                raise DataError(self._where, mask_line, f"the file ends before the mask's {wanted} values")
            raise self._fail(
                f"expected a frame number and {wanted} values for the mask before, found {len(words)} words"
            )
        number, *values = map(self._number, words)
        if number != int(number) or abs(number) >= 2**53:
            raise self._fail(f"{_short(words[0])} is no frame number")
        return self._filled(int(number), mask, values)

    def _number(self, word: str) -> float:
        try:
            if _PLAIN.fullmatch(word) and isfinite(value := float(word)):
                return value
        except ValueError:
            pass
        raise self._fail(f"{_short(word)} is no number")

    def _filled(self, number: int, mask: Mask, given: list[float]) -> FapRow:
        exact = np.array(given)
        rounded = np.trunc(exact + np.copysign(0.5, exact))
        if (rounded != exact).any():
            self._notes.add(self._line, "values that are no whole numbers; rounded")
        if (np.abs(rounded) > MAX_VALUE).any():
            raise self._fail("a value does not fit in 32 bits")
        whole = rounded.astype(np.int32)
        at = 0
        viseme, expression = None, None
        if mask[0]:
            viseme, at = self._viseme(whole[:4].tolist()), 4
        if mask[1]:
            expression, at = self._expression(whole[at : at + 6].tolist()), at + 6
        values = np.zeros(N_FAPS, np.int32)
        values[2:][mask[2:]] = whole[at:]
        if (np.abs(values) > _reach()).any():
            self._notes.add(self._line, "values outside the coding range of their FAP; kept")
        return FapRow(number, mask, values, viseme, expression)

    def _viseme(self, given: list[int]) -> VisemeFap:
        one, two, blend, define = given
        self._check_selects("viseme", (one, two), N_VISEMES - 1)
        self._check_bits("viseme", (blend,), (define,))
        return VisemeFap(one, two, blend, bool(define))

    def _expression(self, given: list[int]) -> ExpressionFap:
        one, level1, two, level2, init, define = given
        self._check_selects("expression", (one, two), len(EXPRESSIONS))
        self._check_bits("expression", (level1, level2), (init, define))
        return ExpressionFap(one, level1, two, level2, bool(init), bool(define))

    def _check_selects(self, name: str, selects: tuple[int, ...], most: int) -> None:
        for select in selects:
            if not 0 <= select <= most:
                raise self._fail(f"{name}_select is {select}; it must be 0 to {most}")

    def _check_bits(self, name: str, levels: tuple[int, ...], flags: tuple[int, ...]) -> None:
        if not all(0 <= level <= FULL for level in levels):
            self._notes.add(self._line, f"a blend or intensity of the {name} outside 0 to {FULL}; kept")
        if not all(flag in (0, 1) for flag in flags):
            self._notes.add(self._line, f"a flag of the {name} that is neither 0 nor 1; taken for 1")

    def _numbered(self, rows: list[FapRow]) -> tuple[FapRow, ...]:
        """Numbers from 0 with the file's gaps; the order where they do not rise."""
        numbers = [row.number for row in rows]
        if any(b <= a for a, b in pairwise(numbers)):
            self._notes.add(0, "frame numbers do not rise; the order of the rows counts")
            numbers = list(range(len(rows)))
        first = numbers[0] if numbers else 0
        if first:
            self._notes.add(0, f"frame numbers begin at {first}")
        if numbers and numbers[-1] - first >= MAX_FRAMES:
            raise DataError(self._where, None, f"frame numbers span more than {MAX_FRAMES} frames")
        if numbers and numbers[-1] - first >= len(rows):
            self._notes.add(0, "frame numbers have gaps, in which the face stays")
        return tuple(_renumbered(row, n - first) for row, n in zip(rows, numbers, strict=True))


@dataclass(frozen=True, slots=True)
class _Header:
    name: str
    version: str
    fps: float
    declared: int | None


@cache
def _reach() -> NDArray[np.int32]:
    """The largest magnitude of each FAP that the standard's coding range has, FAP units, shape (68,)."""
    reach: NDArray[np.int32] = coding_ranges()[:, 0] * np.array([f.quant for f in faps()], np.int32)
    return reach


def _renumbered(row: FapRow, number: int) -> FapRow:
    return row if row.number == number else replace(row, number=number)


def _is_mask(words: list[str]) -> bool:
    return len(words) in (N_FAPS, N_FAPS + 1) and all(w in ("0", "1") for w in words)


def _lines(text: str) -> Iterator[tuple[int, str]]:
    """Numbered lines, without a list of them all."""
    start, number = (1 if text.startswith("\ufeff") else 0), 1
    for end in _ENDS.finditer(text):
        yield number, text[start : end.start()]
        start, number = end.end(), number + 1
    yield number, text[start:]


def _short(text: str) -> str:
    return repr(text if len(text) <= 40 else text[:37] + "...")


def format_fap(sequence: FapSequence, version: str = "2.1", low_level_only: bool = False) -> str:
    """The text of a `.fap` file in the profile that every known player reads.

    Header `version name fps count` on line 1 with one word for a name, frames 0..n-1 with gaps filled, 68
    mask columns, whole numbers, single spaces, a final newline. `low_level_only` is for players that know
    no FAP 1 and 2: these are expanded, and FAPs that never move masked off, with one mask for all frames.

    Raises ValueError for another version than 2.0 and 2.1.
    """
    if version not in VERSIONS:
        raise ValueError(f"version {version!r} is not {' or '.join(VERSIONS)}")
    if low_level_only:
        sequence = FapSequence.of_values(sequence.low_level(), sequence.name, sequence.fps)
    name = "_".join(sequence.name.split()) or "untitled"
    lines = [f"{version} {name} {sequence.fps:.10g} {sequence.length}"]
    for row in sequence.filled():
        lines.append(" ".join("1" if sent else "0" for sent in row.mask.tolist()))
        lines.append(" ".join(map(str, [row.number, *_sent(row)])))
    return "\n".join(lines) + "\n"


def _sent(row: FapRow) -> list[int]:
    values: list[int] = []
    if v := row.viseme:
        values += [v.select1, v.select2, v.blend, int(v.define)]
    if e := row.expression:
        values += [e.select1, e.intensity1, e.select2, e.intensity2, int(e.init_face), int(e.define)]
    low: list[int] = row.values[2:][row.mask[2:]].tolist()
    return values + low
