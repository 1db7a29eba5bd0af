"""Everything one language needs to turn tokens into words and phones, put together once."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

from fapstream.records import Spoken
from fapstream.tts.english import english
from fapstream.tts.normalise import Normaliser
from fapstream.tts.numerals import Numerals
from fapstream.tts.patterns import Found, Patterns, Vocabulary
from fapstream.tts.pronounce import Pronouncer, phonetiser
from fapstream.tts.prosody import question_words
from fapstream.tts.readers import Readers
from fapstream.tts.say_as import SayAs
from fapstream.tts.segment import Segmenter
from fapstream.tts.spelling import Speller
from fapstream.tts.tables import read_rows, require_language


@dataclass(frozen=True, slots=True)
class Language:
    """The rooms through which a phrase goes."""

    name: str
    segmenter: Segmenter
    normalise: Normaliser
    say_as: SayAs
    pronounce: Pronouncer
    function_words: frozenset[str]
    cut_before: frozenset[str]
    question_words: frozenset[str]
    numerals: frozenset[str]
    """Words for the numbers up to nineteen."""

    openings: frozenset[str]
    """Words that begin a sentence after an abbreviation; empty if any capital does."""

    inside: frozenset[str]
    """Words with a capital that begin none."""

    def warm(self) -> None:
        """Everything that would otherwise be made ready when it is first met. Raises DataError."""
        self.normalise.warm()
        phonetiser(self.name)
        english().warm()

    def is_weak(self, word: Spoken, written: str) -> bool:
        """Whether a spoken word bears no accent: a function word, but not where it was written in digits."""
        return word in self.function_words and (word not in self.numerals or written.isalpha())

    def asks_with_word(self, spoken: Sequence[Spoken]) -> bool:
        """Whether a question has a question word near its beginning, and so does not rise at its end."""
        return any(word in self.question_words for word in spoken[:2])


@cache
def language(name: str) -> Language:
    """The one instance of a language. Raises UnknownLanguage, DataError."""
    require_language(name)
    rows = [row for _, row in read_rows(f"{name}/function_words.tsv", 4)]
    vocabulary = Vocabulary(f"{name}/vocabulary.tsv")
    known = {form: entry.one.split() for form, entry in vocabulary.known.items()}
    speller = Speller(_is_english_word, known)
    numerals = Numerals(name)
    readers = _readers(name)(numerals, vocabulary, speller.words).table()
    patterns = Patterns(f"{name}/patterns.tsv", vocabulary, readers)
    normalise = Normaliser(vocabulary, patterns, speller)
    segmenter = Segmenter(name, vocabulary.ends)

    def read(reader: str, content: str) -> list[Spoken]:
        if match := reader and re.fullmatch(r"(?P<text>.*)", content):
            return list(readers[reader](Found(match, ""), "text", ""))
        tokens = [t for i, run in enumerate(content.split()) for t in segmenter.tokens(run, i)]
        return [word for item in normalise.take(tokens, True).items for word in item.spoken]

    return Language(
        name=name,
        segmenter=segmenter,
        normalise=normalise,
        say_as=SayAs(name, read),
        pronounce=Pronouncer(name),
        function_words=frozenset(_sigma(row[0]) for row in rows),
        cut_before=frozenset(_sigma(row[0]) for row in rows if row[2] == "before"),
        question_words=question_words(name),
        numerals=frozenset(numerals.units),
        openings=frozenset(vocabulary.classes.get("opening", ())),
        inside=frozenset(vocabulary.classes["compass"]),
    )


def _readers(lang: str) -> type[Readers]:
    """Those of a language whose numbers agree with the words around them are its own."""
    if lang != "el":
        return Readers
    from fapstream.tts.greek_readers import GreekReaders  # English text need not wait for it

    return GreekReaders


def _sigma(word: str) -> str:
    return word.replace("ς", "σ")


def _is_english_word(word: str) -> bool:
    return english().is_word(word)
