"""MBROLA's .pho notation: one phone a line, `name duration_ms (percent f0)...`."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import accumulate

from fapstream.errors import DataError
from fapstream.records import SILENCE, Phone
from fapstream.tts.realise import VoicePhone, lengths, realise
from fapstream.tts.voices import Voice

F0_LOW_HZ, F0_HIGH_HZ = 40.0, 500.0
FLUSH = "#\n"
"""Makes MBROLA emit everything it holds back; harmless only inside silence."""

_NAME = re.compile(r"[!-:<-~]{1,8}")


@dataclass(frozen=True, slots=True)
class PhoLine:
    """A line as read back."""

    name: str
    duration_ms: float
    pitch: tuple[tuple[float, float], ...] = ()


def line(phone: VoicePhone, sample_rate: int) -> str:
    """One line, newline included, of which MBROLA makes exactly `n_samples` samples.

    MBROLA truncates float32(duration) * rate / 1000, so half a sample is added; every line carries pitch, or
    nothing would be heard until a flush. Raises ValueError for a name or a length MBROLA would choke on.
    """
    if not _NAME.fullmatch(phone.name) or phone.name.startswith("#"):
        raise ValueError(f"not a phone name: {phone.name[:20]!r}")
    if phone.n_samples < 1 or not phone.pitch:
        raise ValueError(f"phone {phone.name} has {phone.n_samples} samples, {len(phone.pitch)} pitch points")
    duration = (phone.n_samples + 0.5) * 1000.0 / sample_rate
    pairs = ((_bounded(p, 0.0, 100.0), _bounded(f, F0_LOW_HZ, F0_HIGH_HZ)) for p, f in phone.pitch)
    pitch = " ".join(f"{percent:.1f} {f0:.1f}" for percent, f0 in pairs)
    return f"{phone.name} {duration:.5f} {pitch}\n"


def lines(phones: Iterable[VoicePhone], sample_rate: int) -> str:
    """The lines of a run of phones. Raises ValueError."""
    return "".join(line(phone, sample_rate) for phone in phones)


def parse(text: str) -> list[PhoLine]:
    """Phones of a .pho text; comments (`;`) and flushes (`#`) are skipped.

    Raises DataError with the line.
    """
    out = []
    for number, row in enumerate(text.splitlines(), 1):
        fields = row.split(";")[0].split()
        if not fields or fields[0] == "#":
            continue
        try:
            values = [float(f) for f in fields[1:]]
            pairs = tuple(zip(values[1::2], values[2::2], strict=True))
            out.append(PhoLine(fields[0], values[0], pairs))
        except (ValueError, IndexError) as error:
            raise DataError("pho", number, f"not a phone line: {row[:60]!r}") from error
    return out


class Realiser:
    """Writes the utterances of one stream for one voice; remembers the last phone, so that joins exist."""

    def __init__(self, voice: Voice) -> None:
        self._voice = voice
        self._previous = SILENCE

    def lines(self, phones: Sequence[Phone]) -> tuple[str, list[int]]:
        """The .pho text of an utterance, and each phone's end in samples since the utterance's start."""
        written = realise(phones, self._voice, self._previous)
        if written:
            self._previous = written[-1].name
        return lines(written, self._voice.sample_rate), list(accumulate(lengths(written, len(phones))))


def _bounded(value: float, low: float, high: float) -> float:
    return min(max(value, low), high) if math.isfinite(value) else low
