"""The pitch contour of a phrase: declination, accents on stressed syllables, and a tune at its end.

The declination falls exponentially with the time since the phrase began and not with its length, so that a
phrase can be spoken before its end is known; what comes later goes on where the melody stood. The final fall
follows the paper on the FPD-based talking head, section 4.1 (60 Hz lower at the end), scaled by the voice.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from fapstream.tts.durations import Segment

Point = tuple[float, float]


@dataclass(slots=True)
class MelodyState:
    """Where the melody stands between two pieces of a phrase.

    `elapsed_ms` is the age of the declination; `f0` the last value, as a factor on the voice's f0.
    """

    elapsed_ms: float = 0.0
    f0: float | None = None
    accents: int = 0


class MelodyModel:
    """Breakpoints of f0, as factors on the voice's f0, for the segments of a phrase."""

    def __init__(self, settings: Mapping[str, float], tunes: Mapping[str, Mapping[str, float]]) -> None:
        self._s = settings
        self._tunes = tunes

    def contour(self, segments: Sequence[Segment], tune: str, state: MelodyState) -> list[Point]:
        """(ms since the piece began, factor), times ascending; moves `state` to the piece's end."""
        spans = _spans(segments)
        end = spans[-1][1] if spans else 0.0
        accents = [i for i, s in enumerate(segments) if s.stress == 1 and not s.is_function]
        points = [(0.0, state.f0 if state.f0 is not None else self._base(state.elapsed_ms))]
        for place, i in enumerate(accents):
            is_last = place == len(accents) - 1
            height = self._height(tune, state.accents + place == 0, is_last)
            limit = spans[accents[place + 1]][0] if not is_last else end
            self._accent(points, spans[i], height, (state.elapsed_ms, limit))
        self._ending(points, spans, segments, tune, state)
        state.accents += len(accents)
        state.elapsed_ms += end
        state.f0 = points[-1][1]
        return points

    def _base(self, ms: float) -> float:
        top, floor = self._s["top"], self._s["floor"]
        return floor + (top - floor) * math.exp(-ms / self._s["decay_ms"])

    def _height(self, tune: str, first: bool, last: bool) -> float:
        wanted = self._tunes[tune]
        if last:
            return wanted["accent"]
        return (self._s["first_accent"] if first else self._s["accent"]) * wanted["scale"]

    def _accent(
        self, points: list[Point], vowel: tuple[float, float], height: float, room: tuple[float, float]
    ) -> None:
        """Up to the middle of the vowel and back to the baseline. `room`: age at 0 ms, and the latest end."""
        age, limit = room
        begin, end = vowel
        foot = max(begin - 60.0, points[-1][0] + 10.0)
        if foot < begin:
            points.append((foot, self._base(age + foot)))
        peak = max(begin + 0.55 * (end - begin), points[-1][0] + 5.0)
        points.append((peak, self._base(age + peak) + height))
        back = min(end + 90.0, limit - 60.0)
        if back > peak + 20.0:
            points.append((back, self._base(age + back)))

    def _ending(
        self,
        points: list[Point],
        spans: Sequence[tuple[float, float]],
        segments: Sequence[Segment],
        tune: str,
        state: MelodyState,
    ) -> None:
        """The tune takes over in the last syllable and reaches its goal at the phrase's end."""
        end = spans[-1][1] if spans else 0.0
        goal = self._tunes[tune]["end"] or self._base(state.elapsed_ms + end)
        vowels = [i for i, s in enumerate(segments) if s.is_vowel]
        begin = spans[vowels[-1]][0] if vowels else 0.0
        while len(points) > 1 and points[-1][0] >= end - 1.0:
            points.pop()
        if points[-1][0] < begin and self._tunes[tune]["end"]:
            points.append((begin, self._base(state.elapsed_ms + begin)))
        points.append((max(end, points[-1][0] + 1.0), goal))


def _spans(segments: Sequence[Segment]) -> list[tuple[float, float]]:
    """(begin, end) of each segment in ms."""
    spans, at = [], 0.0
    for segment in segments:
        spans.append((at, at + segment.ms))
        at += segment.ms
    return spans


def share(points: Sequence[Point], segments: Sequence[Segment], f0_hz: float) -> list[tuple[Point, ...]]:
    """The contour cut at the segments' borders: per segment (percent of its duration, Hz), the first at 0."""
    out: list[tuple[Point, ...]] = []
    at, k, last = 0.0, 0, len(points)
    for segment in segments:
        end = at + segment.ms
        while k + 1 < last and points[k + 1][0] <= at:
            k += 1
        first = (0.0, _value(points, k, at) * f0_hz)
        j = k + 1
        if j < last and points[j][0] < end:
            own = [first]
            while j < last and points[j][0] < end:
                own.append((100.0 * (points[j][0] - at) / segment.ms, points[j][1] * f0_hz))
                j += 1
            out.append(tuple(own))
        else:
            out.append((first,))
        at = end
    if out and points:
        out[-1] = (*out[-1], (100.0, points[-1][1] * f0_hz))
    return out


def _value(points: Sequence[Point], k: int, at: float) -> float:
    """Linear interpolation between points k and k + 1."""
    if k + 1 >= len(points):
        return points[-1][1]
    (t0, f0), (t1, f1) = points[k], points[k + 1]
    return f0 if t1 <= t0 else f0 + (f1 - f0) * (at - t0) / (t1 - t0)
