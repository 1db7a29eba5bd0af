"""Everything one language needs, put together once: tables, words, pronunciation, rhythm and melody."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

from fapstream.tts.durations import DurationModel
from fapstream.tts.english import english
from fapstream.tts.melody import MelodyModel
from fapstream.tts.normalise import Normaliser
from fapstream.tts.pronounce import Pronouncer
from fapstream.tts.segment import Segmenter
from fapstream.tts.tables import read_pairs, read_rows, read_text, require_language


@dataclass(frozen=True, slots=True)
class Stop:
    """What a phrase end sounds like: pause, tune, and how far the declination starts again (0..1)."""

    pause_ms: float
    tune: str
    reset: float


@dataclass(frozen=True, slots=True)
class Language:
    """The rooms through which a phrase goes."""

    name: str
    segmenter: Segmenter
    normalise: Normaliser
    pronounce: Pronouncer
    durations: DurationModel
    melody: MelodyModel
    stops: dict[str, Stop]
    function_words: frozenset[str]
    cut_before: frozenset[str]
    question_words: frozenset[str]

    def asks_with_word(self, spoken: Sequence[str]) -> bool:
        """Whether a question has a question word near its beginning, and so falls at its end."""
        return any(word in self.question_words for word in spoken[:2])


@cache
def language(name: str) -> Language:
    """The one instance of a language. Raises UnknownLanguage, DataError."""
    require_language(name)
    prosody = tomllib.loads(read_text("prosody.toml"))
    rows = [row for _, row in read_rows(f"{name}/function_words.tsv", 4)]
    abbreviations = {row[0]: (row[1], row[2]) for _, row in read_rows(f"{name}/abbreviations.tsv", 3)}
    return Language(
        name=name,
        segmenter=Segmenter(name, abbreviations),
        normalise=Normaliser(name, abbreviations, read_pairs(f"{name}/symbols.tsv"), _is_english_word),
        pronounce=Pronouncer(name),
        durations=DurationModel(name, prosody["durations"][name]),
        melody=MelodyModel(prosody["melody"], prosody["tunes"]),
        stops={kind: Stop(**values) for kind, values in prosody["stops"].items()},
        function_words=frozenset(row[0].replace("ς", "σ") for row in rows),
        cut_before=frozenset(row[0] for row in rows if row[2] == "before"),
        question_words=frozenset(prosody["question_words"][name]),
    )


def _is_english_word(word: str) -> bool:
    return english().is_word(word)
