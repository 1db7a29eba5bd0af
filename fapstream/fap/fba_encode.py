"""FAP rows into FBA elementary streams (ISO/IEC 14496-2; see fap.fba for how it is read)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from fapstream.errors import InputError
from fapstream.fap.arithmetic import Encoder
from fapstream.fap.bits import BitWriter
from fapstream.fap.expand import uses
from fapstream.fap.fba import (
    ALL,
    END_CODE,
    EXPRESSION_RANGES,
    FACE,
    GROUPS,
    KEEP,
    MAX_RANGE,
    MIRROR,
    NONE,
    NTSC,
    OBJECT_CODE,
    PLANE_CODE,
    RANGE_UNIT,
    VISEME_RANGES,
    Coding,
    mirror_pairs,
    steps,
)
from fapstream.fap.rows import FapRow, Mask, Note
from fapstream.fap.sequence import FapSequence
from fapstream.records import N_FAPS, ExpressionFap, VisemeFap


@dataclass(frozen=True, slots=True)
class FbaOptions:
    """`quant` is fap_quant, 1-31. There is an I frame with a time code every `intra_every` frames; with 0
    only where one is needed, and no time code."""

    quant: int = 3
    intra_every: int = 0

    def __post_init__(self) -> None:
        if not 1 <= self.quant <= 31:
            raise InputError(f"fap_quant {self.quant} is not from 1 to 31")
        if self.intra_every < 0:
            raise InputError(f"an I frame every {self.intra_every} frames: it must be 0 or more")


def encode_fba(sequence: FapSequence, options: FbaOptions = FbaOptions()) -> tuple[bytes, tuple[Note, ...]]:
    """The stream, and what it could not say exactly.

    Each FAP is off by at most half of quant times its step. Ranges are as small as the data allow, FAPs that
    stay where they are are masked off, a side that mirrors the other is left to the decoder (mask type 2),
    and frames in which nothing changes are skipped, but for the last. A row that defines a viseme or
    expression is an I frame of exactly its FAPs.

    Raises InputError if there is no frame, or a frame rate that 8 bits and sixteenths cannot say.
    """
    if not sequence.frames:
        raise InputError("an FBA stream has at least one frame; there is none")
    return _Stream(sequence, options).encode()


@dataclass(frozen=True, slots=True)
class _Frame:
    """A row with everything that it leaves out: `values` int64 (68,)."""

    number: int
    values: NDArray[np.int64]
    viseme: VisemeFap
    expression: ExpressionFap
    explicit: Mask
    """The FAPs sent that move the face."""
    defines: Mask | None
    """All FAPs sent, if some define a viseme or an expression."""


class _Stream:
    def __init__(self, sequence: FapSequence, options: FbaOptions) -> None:
        self._sequence = sequence
        self._options = options
        self._rate = _frame_rate(sequence.fps)
        self._steps = steps(options.quant)
        self._out = BitWriter()
        self._shown = np.zeros(N_FAPS, np.int64)
        self._written: int | None = None
        self._clipped = 0
        self._high_level = np.zeros(N_FAPS, np.bool_)
        self._high_level[0] = any(row.viseme for row in sequence.frames)
        self._high_level[1] = any(row.expression for row in sequence.frames)

    def encode(self) -> tuple[bytes, tuple[Note, ...]]:
        frames = list(_filled(self._sequence.frames))
        self._out.start_code(OBJECT_CODE)
        for segment in _segments(frames, self._options.intra_every):
            self._segment(segment, last=segment[-1] is frames[-1])
        self._out.start_code(END_CODE)
        notes = [Note(0, "values beyond what can be coded; clipped", self._clipped)] if self._clipped else []
        return self._out.to_bytes(), tuple(notes)

    def _segment(self, frames: Sequence[_Frame], last: bool) -> None:
        """An I frame and the P frames that depend on it."""
        values = np.array([f.values for f in frames])
        symbols = _quantised(values, self._steps)
        coding = self._coding(frames[0].defines, values, symbols)
        self._count_clipped(values, symbols, coding)
        coding.ranges[0, coding.coded] = _range(symbols[:1, coding.coded])
        coding.ranges[1, coding.coded] = _range(symbols[1:, coding.coded])
        before = None
        for k, frame in enumerate(frames):
            needed = before is None or symbols[k, coding.coded].any() or _speaks(before, frame)
            if needed or (last and k == len(frames) - 1):
                self._plane(frame, before, symbols[k], coding)
                before = frame
        decoded = symbols.sum(axis=0) * self._steps
        moved = coding.known if frames[0].defines is None else frames[0].explicit
        self._shown = np.where(moved, decoded[coding.source], self._shown)

    def _coding(self, defines: Mask | None, values: NDArray[np.int64], symbols: NDArray[np.int64]) -> Coding:
        """Masks for a segment of values and symbols (n, 68)."""
        mirrored = np.zeros(N_FAPS, np.bool_)
        if defines is not None:
            sent = defines.copy()
        else:
            sent = (_rounded(values - self._shown, self._steps) != 0).any(axis=0)
            sent[:2] = self._high_level[:2]
            mirrored = _leave_to_decoder(sent, symbols)
        types = []
        for group in GROUPS:
            kind = KEEP if sent[group].any() else NONE
            types.append(MIRROR if mirrored[group].any() else ALL if sent[group].all() else kind)
        return Coding(self._options.quant, tuple(types), sent)

    def _count_clipped(self, values: NDArray[np.int64], symbols: NDArray[np.int64], coding: Coding) -> None:
        off = np.abs(np.cumsum(symbols, axis=0) * self._steps - values)
        self._clipped += int((2 * off > self._steps)[:, coding.coded].sum())

    def _plane(
        self, frame: _Frame, before: _Frame | None, symbols: NDArray[np.int64], coding: Coding
    ) -> None:
        plane = BitWriter()
        intra = before is None
        plane.write(intra, 1)
        plane.write(FACE, 2)
        if intra:
            plane.write(1, 1)
            plane.write(self._rate, 13)
            self._write_time_code(plane, frame.number)
        _write_skip(plane, 0 if self._written is None else frame.number - self._written - 1)
        if intra:
            _write_coding(plane, coding)
        _write_faps(plane, frame, before, symbols, coding)
        self._append(plane, intra and self._written is not None)
        self._written = frame.number

    def _write_time_code(self, plane: BitWriter, number: int) -> None:
        """For those who begin in the middle; a stream with one I frame needs none."""
        plane.write(self._options.intra_every > 0, 1)
        if self._options.intra_every:
            minutes, seconds = divmod(int(number / self._sequence.fps), 60)
            plane.write(minutes // 60 % 24, 5)
            plane.write(minutes % 60, 6)
            plane.write(1, 1)
            plane.write(seconds, 6)

    def _append(self, plane: BitWriter, start_code: bool) -> None:
        """With a start code where one may begin decoding, or where bits would look like one."""
        start = len(self._out)
        if not start_code:
            self._out.extend(plane)
            if not self._out.emulates_start_code(start):
                return
            self._out.truncate(start)
        self._out.start_code(PLANE_CODE)
        self._out.extend(plane)


def _filled(rows: Sequence[FapRow]) -> Iterator[_Frame]:
    held = np.zeros(N_FAPS, np.int64)
    viseme, expression = VisemeFap(), ExpressionFap()
    for row in rows:
        viseme = row.viseme or replace(viseme, define=False)
        expression = row.expression or (
            ExpressionFap() if expression.init_face else replace(expression, define=False)
        )
        explicit, of_viseme, of_expression = uses(row)
        held[explicit] = row.values[explicit]
        defining = of_viseme | of_expression
        values = np.where(defining, row.values, held).astype(np.int64)
        defines = row.mask if viseme.define or expression.define else None
        yield _Frame(row.number, values, viseme, expression, explicit, defines)


def _segments(frames: list[_Frame], every: int) -> Iterator[list[_Frame]]:
    """Runs that begin with an I frame each; a frame that defines something is one of its own."""
    starts = [0]
    for k, (before, frame) in enumerate(pairwise(frames), 1):
        alone = before.defines is not None or frame.defines is not None
        if alone or (every and frame.number - frames[starts[-1]].number >= every):
            starts.append(k)
    for start, end in pairwise([*starts, len(frames)]):
        yield frames[start:end]


def _speaks(before: _Frame, frame: _Frame) -> bool:
    """Whether FAP 1 or FAP 2 says something that the frame before did not."""
    return (
        frame.viseme != before.viseme or frame.expression != before.expression or frame.expression.init_face
    )


def _rounded(values: NDArray[np.int64], step: NDArray[np.int64]) -> NDArray[np.int64]:
    """Values in steps, half away from zero."""
    magnitude = (2 * np.abs(values) + step) // (2 * step)
    rounded: NDArray[np.int64] = np.sign(values) * magnitude
    return rounded


def _quantised(values: NDArray[np.int64], step: NDArray[np.int64]) -> NDArray[np.int64]:
    """Symbols (n, k): of the values in the first row, then of what is missing to them; clipped to what can
    be said."""
    symbols = np.zeros_like(values)
    decoded = np.zeros_like(step)
    for k, row in enumerate(values):
        symbols[k] = np.clip(_rounded(row - decoded, step), -MAX_RANGE, MAX_RANGE)
        decoded += symbols[k] * step
    return symbols


def _leave_to_decoder(sent: Mask, symbols: NDArray[np.int64]) -> Mask:
    """Take the right sides out of `sent` that mirror the left in all `symbols` (n, 68); which those are.

    In a group where a decoder mirrors, a side that really moves alone is sent with the other, which rests.
    """
    mirrored = np.zeros(N_FAPS, np.bool_)
    for left, right in mirror_pairs():
        if sent[left] and sent[right] and np.array_equal(symbols[:, left], symbols[:, right]):
            mirrored[right] = True
    for group in GROUPS:
        for left, right in mirror_pairs() if mirrored[group].any() else ():
            if left in group and sent[left] != sent[right]:
                sent[[left, right]] = True
    sent &= ~mirrored
    return mirrored


def _range(symbols: NDArray[np.int64]) -> NDArray[np.int64]:
    """The smallest ranges (k, 2) that can be said and hold all symbols (n, k)."""
    least = np.min(symbols, axis=0, initial=0)
    largest = np.max(symbols, axis=0, initial=0)
    return RANGE_UNIT * np.stack([least // RANGE_UNIT, -(-largest // RANGE_UNIT)], axis=1)


def _frame_rate(fps: float) -> int:
    """frame_rate, seconds (sixteenths) and frequency_offset as 13 bits. Raises InputError."""
    choices = [(round(16 * fps / factor), factor) for factor in (1.0, NTSC)]
    sixteenths, factor = min(choices, key=lambda c: abs(c[0] / 16 * c[1] - fps))
    if not 0 < sixteenths < 256 * 16 or abs(sixteenths / 16 * factor - fps) > 0.001 * fps:
        raise InputError(
            f"{fps:g} frames a second cannot be said in FBA: use sixteenths below 256, or NTSC rates"
        )
    return sixteenths << 1 | (factor != 1)


def _write_skip(plane: BitWriter, frames: int) -> None:
    plane.write(frames > 0, 1)
    if frames:
        for _ in range(frames // 15):
            plane.write(15, 4)
        plane.write(frames % 15, 4)


def _write_coding(plane: BitWriter, coding: Coding) -> None:
    plane.write(coding.quant, 5)
    for group, kind in zip(GROUPS, coding.types, strict=True):
        plane.write(1, 1)
        plane.write(kind, 2)
        if kind in (KEEP, MIRROR):
            plane.write(sum(1 << k for k, fap in enumerate(group) if coding.sent[fap]), len(group))
    plane.write(0, 2)  # fba_suggested_gender, and the predictive mode
    plane.write(0b1111, 4)
    for frame in (0, 1):
        for which in (1, 0):
            _write_range(plane, coding, np.abs(coding.ranges[frame, :, which]) // RANGE_UNIT)


def _write_range(plane: BitWriter, coding: Coding, limits: NDArray[np.int32]) -> None:
    for group in GROUPS[1:]:
        for k, fap in enumerate(group.tolist()):
            if k % 4 == 0:
                plane.write(1, 1)
            if coding.sent[fap]:
                plane.write(int(limits[fap]), 5)


def _write_faps(
    plane: BitWriter, frame: _Frame, before: _Frame | None, symbols: NDArray[np.int64], coding: Coding
) -> None:
    if coding.sent[0]:
        _write_parts(plane, coding, _viseme(frame), _viseme(before) if before else None)
        plane.write(frame.viseme.define, 1)
    if coding.sent[1]:
        _write_parts(plane, coding, _expression(frame), _expression(before) if before else None)
        plane.write(frame.expression.init_face, 1)
        plane.write(frame.expression.define, 1)
    if len(coding.coded):
        run = Encoder(plane)
        for fap in coding.coded.tolist():
            run.encode(coding.model(before is not None, fap), int(symbols[fap]))
        run.finish()


def _write_parts(plane: BitWriter, coding: Coding, now: list[int], before: list[int] | None) -> None:
    """FAP 1 (three numbers) or FAP 2 (four)."""
    run = Encoder(plane)
    models = coding.parts(before is not None, 0 if len(now) == len(VISEME_RANGES) else 1)
    for model, value, last in zip(models, now, before or [0] * len(now), strict=True):
        run.encode(model, value - last)
    run.finish()


def _viseme(frame: _Frame) -> list[int]:
    v = frame.viseme
    return _clipped([v.select1, v.select2, v.blend], VISEME_RANGES)


def _expression(frame: _Frame) -> list[int]:
    e = frame.expression
    return _clipped([e.select1, e.intensity1, e.select2, e.intensity2], EXPRESSION_RANGES)


def _clipped(parts: list[int], ranges: tuple[tuple[int, int], ...]) -> list[int]:
    return [min(max(part, low), high) for part, (low, high) in zip(parts, ranges, strict=True)]
