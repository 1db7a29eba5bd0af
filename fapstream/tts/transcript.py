"""What was said, as written: the words that it is read as, and how we would pronounce them."""

from __future__ import annotations

from typing import NamedTuple

from fapstream.records import SILENCE, Spoken, Utterance, Word
from fapstream.tts.cmu import Phones, to_cmu
from fapstream.tts.english import english
from fapstream.tts.frontend import FrontEnd
from fapstream.tts.language import language


class Wanted(NamedTuple):
    """One spoken word of a transcript.

    `spoken`: as it is read, in lower case, "" where only phones are known. `written`: the word of the text
    it belongs to; "5 pm" is read as `five`, `p`, `m`. `readings`: how we would say it, here first.
    """

    spoken: str
    written: Word
    readings: tuple[Phones, ...]


def wanted(transcript: str) -> list[Wanted]:
    """The words of an English transcript, read as the speech front-end reads it: mark-up is heeded, signs
    without sound are not there. Raises DataError.
    """
    front = FrontEnd("en")
    found: list[Wanted] = []
    seen = -1
    for utterance in front.feed(transcript) + front.end():
        for word in _of(utterance, seen):
            found.append(word)
            seen = max(seen, word.written.start)
    return found


def _of(utterance: Utterance, seen: int) -> list[Wanted]:
    """The words of a phrase; those that begin no later than `seen` came with the phrase before."""
    words = [(word, spoken) for word in utterance.words if word.start > seen for spoken in word.spoken]
    phones = language("en").pronounce([spoken for _, spoken in words])
    return [
        Wanted(_name(spoken), word, _readings(spoken, tokens))
        for (word, spoken), tokens in zip(words, phones, strict=True)
        if tokens
    ]


def _name(spoken: Spoken) -> str:
    return spoken.lower() if isinstance(spoken, str) and spoken.isascii() else ""


def _readings(spoken: Spoken, here: tuple[str, ...]) -> tuple[Phones, ...]:
    others: tuple[tuple[str, ...], ...] = ()
    if _name(spoken) and isinstance(spoken, str):
        others = english().readings(spoken)
    return tuple(
        dict.fromkeys(tuple(to_cmu(t) for t in tokens if t != SILENCE) for tokens in (here, *others))
    )
