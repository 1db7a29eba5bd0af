"""FBA elementary streams into FAP rows (ISO/IEC 14496-2; see fap.fba for how it is read)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fapstream.fap.arithmetic import Decoder
from fapstream.fap.bits import BitReader
from fapstream.fap.fba import (
    ALL,
    BODY,
    END_CODE,
    EXPRESSION_RANGES,
    FACE,
    GROUPS,
    KEEP,
    MIRROR,
    NONE,
    NTSC,
    OBJECT_CODE,
    PLANE_CODE,
    RANGE_UNIT,
    VISEME_RANGES,
    Coding,
)
from fapstream.fap.files import DEFAULT_FPS
from fapstream.fap.rows import MAX_FRAMES, MAX_VALUE, FapRow, Notes
from fapstream.fap.sequence import FapSequence
from fapstream.records import N_FAPS, ExpressionFap, VisemeFap


def decode_fba(data: bytes, where: str, name: str = "untitled") -> FapSequence:
    """The animation in a stream; `where` names it in errors.

    Rows send the FAPs that their plane codes or mirrors. What stands before the object start code is skipped,
    and after the end code ignored; both are noted, as are a missing end code, frame rate, and time codes.

    Raises BitstreamError with the byte and bit: no object, an end within a plane, marker bits and stuffing
    that are not 1, ranges without a value, FAP 1 or 2 outside its range, a P frame before the first I frame;
    and what is not supported: body animation, the DCT mode, frame rate 0, more than MAX_FRAMES.
    """
    return _Stream(data, where).decode(name)


class _Stream:
    def __init__(self, data: bytes, where: str) -> None:
        self._data = data
        self._in = BitReader(data, where)
        self._notes = Notes()
        self._fps: float | None = None
        self._coding: Coding | None = None
        self._number = -1
        self._values = np.zeros(N_FAPS, np.int64)
        self._composite = ([0] * len(VISEME_RANGES), [0] * len(EXPRESSION_RANGES))
        self._last: NDArray[np.int32] = np.zeros(N_FAPS, np.int32)

    def decode(self, name: str) -> FapSequence:
        self._find_object()
        rows: list[FapRow] = []
        while self._plane_follows():
            rows.append(self._plane())
        if self._fps is None:
            self._notes.add(0, f"no frame rate: taken for {DEFAULT_FPS:g} frames a second")
        return FapSequence(name, "2.1", self._fps or DEFAULT_FPS, tuple(rows), None, self._notes.all())

    def _find_object(self) -> None:
        at = self._data.find(OBJECT_CODE.to_bytes(4, "big"))
        if at < 0:
            raise self._in.fail("no FBA object start code (00 00 01 BA)", 0)
        if at:
            self._notes.add(0, "something before the FBA object; skipped")
        self._in.position = 8 * (at + 4)

    def _plane_follows(self) -> bool:
        code = self._in.start_code()
        if code is None and self._in.only_stuffing_left():
            self._notes.add(0, "no end code")
            return False
        if code == PLANE_CODE:
            self._in.skip_start_code()
        elif code == END_CODE:
            self._in.skip_start_code()
            if self._in.position < self._in.size:
                self._notes.add(0, "something after the end code; ignored")
            return False
        elif code is not None:
            raise self._in.fail(f"start code {code:#010x} within an FBA object")
        return True

    def _plane(self) -> FapRow:
        intra = self._in.flag()
        objects = self._in.read(2)
        if objects & BODY:
            raise self._in.fail("body animation is not supported", self._in.position - 2)
        if not objects & FACE:
            raise self._in.fail("a plane without a face", self._in.position - 1)
        self._time(intra)
        if intra:
            self._coding = self._intra_header()
        elif self._coding is None:
            raise self._in.fail("a P frame before the first I frame")
        return self._faps(self._coding, not intra)

    def _time(self, intra: bool) -> None:
        if intra and self._in.flag():
            self._frame_rate()
        if intra and self._in.flag():
            self._time_code()
        first = self._number < 0
        self._number += 1
        if self._in.flag():
            skipped = 15
            while skipped == 15:
                skipped = self._in.read(4)
                self._number += 0 if first else skipped
        if self._number >= MAX_FRAMES:
            raise self._in.fail(f"more than {MAX_FRAMES} frames")

    def _frame_rate(self) -> None:
        at = self._in.position
        fps = (self._in.read(8) + self._in.read(4) / 16) * (NTSC if self._in.flag() else 1)
        if not fps:
            raise self._in.fail("frame rate 0", at)
        if self._fps not in (None, fps):
            raise self._in.fail("a change of the frame rate is not supported", at)
        self._fps = fps

    def _time_code(self) -> None:
        at = self._in.position
        hours, minutes = self._in.read(5), self._in.read(6)
        self._in.marker()
        seconds = self._in.read(6)
        if hours > 23 or minutes > 59 or seconds > 59:
            raise self._in.fail(f"{hours}:{minutes}:{seconds} is no time code", at)
        if self._number < 0 and (hours or minutes or seconds):
            self._notes.add(0, f"the time code begins at {hours:02}:{minutes:02}:{seconds:02}")

    def _intra_header(self) -> Coding:
        quant = self._in.read(5)
        types, sent = [], np.zeros(N_FAPS, np.bool_)
        for group in GROUPS:
            self._in.marker()
            kind = self._in.read(2)
            mask = {NONE: 0, ALL: -1}.get(kind)
            if kind in (KEEP, MIRROR):
                mask = self._in.read(len(group))
            sent[group] = [bool((mask or 0) >> k & 1) for k in range(len(group))]
            types.append(kind)
        self._in.read(1)  # fba_suggested_gender: heads are chosen otherwise
        if self._in.flag():
            raise self._in.fail("the DCT mode is not supported", self._in.position - 1)
        coding = Coding(quant, tuple(types), sent)
        self._new_ranges(coding)
        return coding

    def _new_ranges(self, coding: Coding) -> None:
        at = self._in.position
        given = [self._in.flag() for _ in range(4)]
        for which, is_new in enumerate(given):
            frame, least = divmod(which, 2)
            if is_new:
                self._new_range(coding, coding.ranges[frame, :, 1 - least], -1 if least else 1)
        if (coding.ranges[:, coding.sent, 0] > coding.ranges[:, coding.sent, 1]).any():
            raise self._in.fail("a range without a value", at)

    def _new_range(self, coding: Coding, limits: NDArray[np.int32], sign: int) -> None:
        for group in GROUPS[1:]:
            for k, fap in enumerate(group.tolist()):
                if k % 4 == 0:
                    self._in.marker()
                if coding.sent[fap]:
                    limits[fap] = sign * RANGE_UNIT * self._in.read(5)

    def _faps(self, coding: Coding, predicted: bool) -> FapRow:
        viseme, expression = None, None
        if coding.sent[0]:
            self._parts(coding, predicted, 0)
            one, two, blend = self._composite[0]
            viseme = VisemeFap(one, two, blend, self._in.flag())
        if coding.sent[1]:
            self._parts(coding, predicted, 1)
            one, level1, two, level2 = self._composite[1]
            expression = ExpressionFap(one, level1, two, level2, self._in.flag(), self._in.flag())
        self._low_level(coding, predicted)
        mask = coding.known
        values = np.where(mask, self._values, 0).astype(np.int32)
        if not np.array_equal(values, self._last):  # else rows share it: hours of silence are small
            self._last = values
        return FapRow(self._number, mask, self._last, viseme, expression)

    def _parts(self, coding: Coding, predicted: bool, fap: int) -> None:
        at = self._in.position
        parts = self._composite[fap]
        run = Decoder(self._in)
        for k, model in enumerate(coding.parts(predicted, fap)):
            parts[k] = run.decode(model) + (parts[k] if predicted else 0)
        run.finish()
        limits = (VISEME_RANGES, EXPRESSION_RANGES)[fap]
        if any(not low <= part <= high for part, (low, high) in zip(parts, limits, strict=True)):
            raise self._in.fail(f"FAP {fap + 1} is {' '.join(map(str, parts))}", at)

    def _low_level(self, coding: Coding, predicted: bool) -> None:
        coded = coding.coded
        if not len(coded):
            return
        at = self._in.position
        run = Decoder(self._in)
        symbols = np.array([run.decode(coding.model(predicted, fap)) for fap in coded.tolist()])
        run.finish()
        before = self._values[coded] if predicted else 0
        self._values[coded] = before + symbols * coding.steps[coded]
        self._values = self._values[coding.source]
        if np.abs(self._values).max() > MAX_VALUE:
            raise self._in.fail("a FAP that does not fit in 32 bits", at)
