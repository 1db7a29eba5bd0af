"""PocketSphinx with its English model and dictionary (the extra `speech`): one piece of sound at a time."""

from __future__ import annotations

import importlib.util
import math
from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple

from fapstream.adapters.sound_file import SpeechUnavailable
from fapstream.records import Pcm
from fapstream.tts.cmu import Phones

RATE = 16_000
FRAME_S = 0.01
WINDOW_S = 0.032
"""Of sound for a frame. The model's is 25.6 ms; with all that the transform takes, boundaries are a little
more exact, and words fit no worse."""
LATE_S = 0.0025
"""So much later than they are, on average, boundaries are found in MBROLA's speech."""
NATS = 1024 * math.log(1.0001)
"""A unit of the scores."""
PAUSE = "<sil>"
FILLERS = ("<", "[", "+")
"""How the names of what is no word begin."""
STOP_HERE = 0.1
"""Likelihood that a piece ends after a word, where its end is open, against that it goes on."""


class Found(NamedTuple):
    """A phone where it was found. `fit`: nats per frame, see HeardWord."""

    name: str
    start_s: float
    end_s: float
    fit: float


class Segment(NamedTuple):
    """A word of the dictionary, its variant's number left out, or "" for a pause or noise."""

    name: str
    phones: tuple[Found, ...]

    @property
    def start_s(self) -> float:
        return self.phones[0].start_s

    @property
    def end_s(self) -> float:
        return self.phones[-1].end_s


def installed() -> bool:
    """Whether the package is there."""
    return importlib.util.find_spec("pocketsphinx") is not None


class Sphinx:
    """Decoders that remember no sound: the same piece gives the same result. For one thread."""

    def __init__(self) -> None:
        """Reads the model and the dictionary, 0.1 s. Raises SpeechUnavailable."""
        if not installed():
            raise SpeechUnavailable
        # bestpath looks for a better path in the lattice, and half of all alignments have none after that
        wide = {"wlen": WINDOW_S, "beam": 1e-100, "wbeam": 1e-80, "pbeam": 1e-100}
        self._forced = _decoder(lm=None, bestpath=False, **wide)
        self._free: Any = None
        self._known: set[tuple[str, tuple[Phones, ...]]] = set()

    def name(self, word: str, readings: tuple[Phones, ...]) -> str:
        """What the dictionary calls a word. Readings that it lacks are added to it: of words that it does not
        know, and weak forms, with which it is sparing.
        """
        name = word if word and not word.startswith(FILLERS) else "_".join(("", *readings[0]))
        if (name, readings) not in self._known:
            self._known.add((name, readings))
            there: list[str] = []
            while phones := self._forced.lookup_word(_variant(name, len(there))):
                there.append(phones)
            for phones in dict.fromkeys(_plain(reading) for reading in readings):
                if phones not in there:
                    self._forced.add_word(_variant(name, len(there)), phones, False)
                    there.append(phones)
        return name

    def align(self, pcm: Pcm, names: Sequence[str], open_end: bool = False) -> list[Segment] | None:
        """The words of the dictionary, said one after the other in a piece of sound, with the pauses.

        `open_end`: only the first of them, or none, may be in it. None if they cannot be.
        """
        self._search(names, open_end)
        sound = pcm.tobytes()
        try:
            _decode(self._forced, sound)
            if not list(self._forced.seg() or ()):  # hyp() would be None for a pause alone as well
                return None
            self._forced.set_alignment()
            _decode(self._forced, sound)
        except RuntimeError:  # the last word does not end with the sound
            return None
        return [_segment(word) for word in self._forced.get_alignment()]

    def _search(self, names: Sequence[str], open_end: bool) -> None:
        """Look for these words: a chain of states, in which every word may lead to the last state if the end
        is open. An empty transition would do for that as well, but phones cannot be found behind one."""
        last = len(names)
        steps = [(i, i + 1, 1.0, name) for i, name in enumerate(names)]
        if open_end:
            steps += [(i, last, STOP_HERE, name) for i, name in enumerate(names[:-1])]
            steps.append((0, last, STOP_HERE, PAUSE))
        self._forced.add_fsg("words", self._forced.create_fsg("words", 0, last, steps))
        self._forced.activate_search("words")

    def recognise(self, pcm: Pcm) -> list[str]:
        """The words, as the dictionary has them, that are likeliest to be said in a piece of sound."""
        self._free = self._free or _decoder()
        _decode(self._free, pcm.tobytes())
        found = [] if self._free.hyp() is None else [_base(segment.word) for segment in self._free.seg()]
        return [word for word in found if word]


def _decoder(**options: Any) -> Any:
    import pocketsphinx

    return pocketsphinx.Decoder(samprate=RATE, loglevel="FATAL", **options)


def _decode(decoder: Any, sound: bytes) -> None:
    decoder.start_utt()
    try:
        decoder.process_raw(sound, full_utt=True)
    finally:
        decoder.end_utt()


def _segment(word: Any) -> Segment:
    phones = (
        Found(p.name, _time(p.start), _time(p.start + p.duration), NATS * p.score / p.duration) for p in word
    )
    return Segment(_base(word.name), tuple(phones))


def _variant(name: str, index: int) -> str:
    return f"{name}({index + 1})" if index else name


def _time(frame: int) -> float:
    return max(0.0, round(frame * FRAME_S - LATE_S, 6))


def _base(name: str) -> str:
    """`read(2)` -> `read`, `<sil>` -> ``."""
    return "" if name.startswith((*FILLERS, "(")) else name.partition("(")[0]


def _plain(phones: Iterable[str]) -> str:
    return " ".join(phone.rstrip("012") for phone in phones)
