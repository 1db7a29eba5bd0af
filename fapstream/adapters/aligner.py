"""When the words and phones of recorded English speech are said (the extra `speech`).

Long sound is aligned in windows: the next words of the transcript, more than the window can hold, with an end
that is open after every word; what comes before the longest pause of the window's later part is kept, and the
next window begins in that pause. So an hour needs the memory of half a minute, and its own.

Recognition is poor: of news sentences in MBROLA's clear speech 5 to 21 % of the words are wrong, of a man's
short commands (GRID) 90 %. A transcript is better wherever there is one.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from fapstream.adapters.sphinx import FRAME_S, RATE, Found, Segment, Sphinx
from fapstream.errors import ClipError
from fapstream.records import Heard, HeardPhone, HeardWord, Pcm, Word
from fapstream.tts.cmu import stressed
from fapstream.tts.transcript import Wanted, wanted

LEAST_S = 0.2
WINDOWS_S = ((24.0, 30.0), (18.0, 24.0), (12.0, 18.0))
"""Where a window ends, at the quietest moment: in the first of these, or another if that does not do."""
LAST_WINDOW_S = 45.0
"""What is left is aligned at once if it is no longer."""
WORDS_PER_S = 6.0
"""Nobody speaks faster for so long."""
KEEP = (0.4, 0.95)
"""The parts of a window between which what is kept of it ends."""
PAUSE_S = 0.1
"""Better than this the end of a word far into the window."""
LEAST_FIT = -4.4
"""Nats: the middle word of a right transcript fits better, that of a wrong one worse, mostly: see the table
`refused` of tests/benchmarks/bench_align.py. The middle one, because a word or two may be wrong."""
JUDGED = 8
"""Words without which a window is not judged by itself."""
LEAST_COVERED = 0.4
QUIET = 8.0
"""Root mean square of 32768, up to which nobody speaks."""
LOUD = 0.2
"""A frame is loud above this part of the loudness of the loudest twentieth of those that are not quiet."""
RECOGNISED_S = (8.0, 20.0)
"""Sound is cut for recognition at its quietest in this range."""


class Aligner:
    """See the port. Every call is by itself; threads may share it."""

    def align(self, pcm: Pcm, transcript: str) -> Heard:
        """See the port. Raises SpeechUnavailable as well, and DataError."""
        loud = _loud(pcm)
        words = wanted(transcript)
        if not words:
            raise ClipError("the transcript has no words")
        sphinx = Sphinx()
        names = [sphinx.name(word.spoken, word.readings) for word in words]
        found = [segment for part in _windows(sphinx, pcm, names) for segment in part]
        return _checked(_heard(transcript, words, found, loud, len(pcm) / RATE))

    def recognise(self, pcm: Pcm) -> Heard:
        """See the port. Raises SpeechUnavailable as well."""
        loud = _loud(pcm)
        sphinx = Sphinx()
        found: list[Segment] = []
        for start, end in _cut(pcm):
            names = sphinx.recognise(pcm[start:end])
            piece = sphinx.align(pcm[start:end], names) if names else []
            found += [_later(segment, start / RATE) for segment in piece or []]
        text, words = _text([segment.name for segment in found if segment.name])
        if not words:
            raise ClipError("no words can be understood in the sound")
        return _checked(_heard(text, words, found, loud, len(pcm) / RATE))


def _windows(sphinx: Sphinx, pcm: Pcm, names: Sequence[str]) -> Iterator[list[Segment]]:
    """What is kept of each window, in order, with the times of the whole. Raises ClipError."""
    at, said = 0, 0
    while said < len(names):
        kept, end_s = _window(sphinx, pcm[at:], names[said:])
        fits = [_fit(segment) for segment in kept if segment.name]
        if not kept or (len(fits) >= JUDGED and float(np.median(fits)) < LEAST_FIT):
            raise _unfit(at / RATE)
        yield [_later(segment, at / RATE) for segment in kept]
        said += len(fits)
        at += round(end_s * RATE)


def _window(sphinx: Sphinx, pcm: Pcm, names: Sequence[str]) -> tuple[list[Segment], float]:
    """What is kept of the next window, nothing if the words cannot be in it, and where the one after begins.

    `pcm` and `names`: all that is left. A window that ends within a word may be impossible to align: then a
    shorter one is tried.
    """
    if len(pcm) <= LAST_WINDOW_S * RATE:
        fits = len(pcm) >= LEAST_S * RATE and len(names) <= WORDS_PER_S * len(pcm) / RATE + 1
        return (sphinx.align(pcm, names) if fits else None) or [], len(pcm) / RATE
    for low_s, high_s in WINDOWS_S:
        end = _quietest(pcm, low_s, high_s)
        found = sphinx.align(pcm[:end], names[: round(WORDS_PER_S * end / RATE)], open_end=True)
        if found:
            return _keep(found, end / RATE)
    return [], 0.0


def _keep(found: Sequence[Segment], size_s: float) -> tuple[list[Segment], float]:
    """What is kept of a window, and where the next begins: in a pause, or after a word."""
    low, high = (part * size_s for part in KEEP)
    pauses = [(max(s.start_s, low), min(s.end_s, high)) for s in found if not s.name]
    start, end = max(pauses, key=lambda pause: pause[1] - pause[0], default=(0.0, 0.0))
    if end - start >= PAUSE_S:
        at = (start + end) / 2
        return [s for s in found if s.start_s < at], at
    kept = [s for s in found if s.end_s <= high] or list(found[:1])
    return kept, kept[-1].end_s


def _later(segment: Segment, by_s: float) -> Segment:
    phones = (Found(p.name, p.start_s + by_s, p.end_s + by_s, p.fit) for p in segment.phones)
    return Segment(segment.name, tuple(phones))


def _cut(pcm: Pcm) -> list[tuple[int, int]]:
    """Pieces [start, end) to be recognised."""
    cuts = [0]
    while len(pcm) - cuts[-1] > RECOGNISED_S[1] * RATE:
        cuts.append(cuts[-1] + _quietest(pcm[cuts[-1] :], *RECOGNISED_S))
    return list(zip(cuts, [*cuts[1:], len(pcm)], strict=True))


def _quietest(pcm: Pcm, low_s: float, high_s: float) -> int:
    """The middle of the quietest 0.2 s between two times, samples."""
    levels = _levels(pcm[round(low_s * RATE) : round(high_s * RATE)])
    middle_s = (int(np.argmin(np.convolve(levels, np.ones(20), "valid"))) + 10) * FRAME_S
    return round((low_s + middle_s) * RATE)


def _levels(pcm: Pcm) -> NDArray[np.float32]:
    """Root mean square of every 10 ms."""
    step = round(FRAME_S * RATE)
    out = np.zeros(-(-len(pcm) // step), np.float32)
    for at in range(0, len(out), 6000):  # a minute, lest an hour be held as floats
        frames = pcm[at * step : (at + 6000) * step].astype(np.float32)
        frames = np.pad(frames, (0, -len(frames) % step)).reshape(-1, step)
        out[at : at + len(frames)] = np.sqrt((frames**2).mean(axis=1))
    return out


def _loud(pcm: Pcm) -> NDArray[np.bool_]:
    """Which tens of milliseconds are loud. Raises ClipError for what is no speech at first sight."""
    if pcm.ndim != 1 or pcm.dtype != np.int16:
        raise ClipError(f"speech is mono int16 (n,), not {pcm.shape} of {pcm.dtype}")
    if len(pcm) < LEAST_S * RATE:
        raise ClipError(f"the sound lasts {len(pcm) / RATE:.2f} s; {LEAST_S} s are the least")
    levels = _levels(pcm)
    heard = levels[levels > QUIET]
    if len(heard) * FRAME_S < LEAST_S:
        raise ClipError("there is no speech in the sound: it is silent")
    return np.asarray(levels > LOUD * np.percentile(heard, 95))


def _text(names: Sequence[str]) -> tuple[str, list[Wanted]]:
    """Words that were recognised as a text, and as if they had been wanted."""
    words, at = [], 0
    for name in names:
        from_text = wanted(name.rstrip("."))
        readings = from_text[0].readings if len(from_text) == 1 else ()
        words.append(Wanted(name, Word(name, at, at + len(name)), readings))
        at += len(name) + 1
    return " ".join(names), words


def _heard(
    text: str, words: Sequence[Wanted], found: Sequence[Segment], loud: NDArray[np.bool_], length_s: float
) -> Heard:
    out: list[HeardWord] = []
    covered = np.zeros(len(loud), np.bool_)
    coming = iter(words)
    for segment in found:
        if segment.name:
            _pause(out, segment.start_s)
            out.append(_word(next(coming), segment))
            covered[round(segment.start_s / FRAME_S) : round(segment.end_s / FRAME_S)] = True
    _pause(out, length_s)
    share = float((covered & loud).sum() / max(1, loud.sum()))
    fit = float(np.median([word.fit for word in out if word.text]))
    return Heard(text, tuple(out), fit, share)


def _pause(out: list[HeardWord], until_s: float) -> None:
    start_s = out[-1].end_s if out else 0.0
    if until_s > start_s:
        out.append(HeardWord("", start_s, until_s, (HeardPhone("SIL", start_s, until_s),)))


def _word(word: Wanted, segment: Segment) -> HeardWord:
    names = stressed([phone.name for phone in segment.phones], word.readings)
    phones = tuple(
        HeardPhone(name, p.start_s, p.end_s) for name, p in zip(names, segment.phones, strict=True)
    )
    written = word.written
    return HeardWord(
        word.spoken or written.text, segment.start_s, segment.end_s, phones, written.start, written.end,
        _fit(segment),
    )  # fmt: skip


def _fit(word: Segment) -> float:
    return float(np.mean([phone.fit for phone in word.phones]))


def _checked(heard: Heard) -> Heard:
    """The same. Raises ClipError where the words cannot be what is said."""
    if heard.fit < LEAST_FIT:
        raise _unfit(0.0)
    if heard.covered < LEAST_COVERED:
        raise ClipError(
            f"the words do not fit the sound: {1 - heard.covered:.0%} of what is heard is none of them"
        )
    return heard


def _unfit(at_s: float) -> ClipError:
    where = f" after {at_s:.0f} s" if at_s else ""
    return ClipError(f"the words do not fit the sound{where}: other words are said, or none")
