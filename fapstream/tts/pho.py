"""MBROLA's .pho notation: one phone a line, `name duration_ms (percent f0)...`."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence
from itertools import accumulate
from typing import NamedTuple

from fapstream.errors import DataError
from fapstream.records import Phone, Utterance, Word
from fapstream.tts.realise import Join, VoicePhone, lengths, realise, rewrite
from fapstream.tts.voices import Voice

F0_LOW_HZ, F0_HIGH_HZ = 40.0, 500.0
FLUSH = "#\n"
"""Makes MBROLA emit everything it holds back; harmless only inside silence."""

_NAME = re.compile(r"[!-:<-~]{1,8}")


class PhoLine(NamedTuple):
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


class Written(NamedTuple):
    """Lines for MBROLA and what they say: the phones with their words, and where each of them ends, in
    samples from where the last lines ended. `following`: the phone that will be next, where that is known."""

    lines: str
    phones: tuple[tuple[Phone, Word | None], ...]
    ends: list[int]
    following: Phone | None


class Realiser:
    """Writes the utterances of one stream for one voice, the last phone of an open one only with the next.

    So the lines do not depend on where the stream was cut into utterances, every join exists, and the last
    phone can still be drawn out. MBROLA could not say it yet anyway: it waits for the phone after it.
    """

    def __init__(self, voice: Voice) -> None:
        self._voice = voice
        self._join = Join()
        self._kept: list[tuple[Phone, Word | None]] = []

    def write(self, utterance: Utterance) -> Written:
        """What can be said now that the utterance has come."""
        words = utterance.words
        phones = self._kept + [(p, words[p.word] if p.word >= 0 else None) for p in utterance.phones]
        if not phones:
            return Written("", (), [], None)
        plain = [phone for phone, _ in phones]
        join = self._join._replace(more=not utterance.closed)
        made = realise(plain, self._voice, join)
        ends = list(accumulate(lengths(made, len(plain))))
        count = len(plain) if utterance.closed else _first_of_last(plain, self._voice, join)
        said, self._kept = phones[:count], phones[count:]
        if not said:
            return Written("", (), [], plain[0])
        wished = join.behind + sum(p.duration_ms for p, _ in said) * self._voice.sample_rate / 1000.0
        self._join = Join(
            made[-1].name if made else join.previous, plain[count - 1], wished - ends[count - 1]
        )
        following = plain[count] if count < len(plain) else None
        return Written(lines(made, self._voice.sample_rate), tuple(said), ends[:count], following)


def _first_of_last(phones: Sequence[Phone], voice: Voice, join: Join) -> int:
    """Index of the first phone of the last group that the voice says as one."""
    *_, (_, first, _) = rewrite(phones, voice, join.before)
    return first


def _bounded(value: float, low: float, high: float) -> float:
    return min(max(value, low), high) if math.isfinite(value) else low
