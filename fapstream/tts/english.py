"""English words to phones: lexicon, stems and endings, compounds, then letter-to-sound trees."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

from fapstream.tts.lexicon import Lexicon
from fapstream.tts.lts import LetterToSound
from fapstream.tts.tables import read_bytes, read_rows

Tokens = tuple[str, ...]
"""Phones; a vowel carries its stress digit, as in `i1`."""

_SIBILANT = frozenset(("s", "z", "S", "Z", "tS", "dZ"))
_VOICELESS = frozenset(("p", "t", "k", "f", "T"))
_MIN_STEM, _MIN_PART = 3, 4


class English:
    """Pronounces lower-case words of a-z and apostrophes, and capital letters by name."""

    def __init__(self) -> None:
        """Reads the lexicon and the trees. Raises DataError."""
        self._lexicon = Lexicon(read_bytes("en/lexicon.bin"))
        self._trees = LetterToSound(read_bytes("en/lts.bin"))
        self._letters = {row[0].upper(): tuple(row[1].split()) for _, row in read_rows("en/letters.tsv", 2)}
        rows = [row for _, row in read_rows("en/function_words.tsv", 4)]
        self._weak = {row[0]: tuple(row[1].split()) for row in rows if row[1]}
        self._before_vowel = {row[0]: tuple(row[3].split()) for row in rows if row[3]}

    def is_word(self, word: str) -> bool:
        """Whether the lexicon has it."""
        return self._lexicon.get(word) is not None

    def lexicon_words(self) -> list[str]:
        """Every word of the lexicon, for tools and tests."""
        return self._lexicon.words()

    def phones(self, words: Sequence[str]) -> list[Tokens]:
        """The phones of each word of a phrase: all but the last may be weak forms."""
        found = [self._weak.get(word) or self.word(word) for word in words]
        for i, word in enumerate(words[:-1]):
            if word in self._before_vowel and found[i + 1] and found[i + 1][0][-1].isdigit():
                found[i] = self._before_vowel[word]
        if len(words) > 1:
            found[-1] = self.word(words[-1])
        return found

    def needs_next(self, word: str) -> bool:
        return word in self._weak or word in self._before_vowel

    def path(self, word: str) -> str:
        return "lexicon"

    def word(self, word: str) -> Tokens:
        """One word by itself. Characters other than a-z and the apostrophe are ignored."""
        return (
            self._letters.get(word)
            or self._lexicon.get(word)
            or self._inflected(word)
            or self._compound(word)
            or self._guess(word)
        )

    def _guess(self, word: str) -> Tokens:
        letters = "".join(c for c in word.lower() if "a" <= c <= "z")
        return self._trees(letters) if letters else ()

    def _inflected(self, word: str) -> Tokens | None:
        """A known stem with 's, s, ed or ing."""
        if word.endswith(("'s", "s'")):
            return plural(self.word(word[:-2] + "s" * word.endswith("s'")), word.endswith("s'"))
        for ending, add in (("s", plural), ("ed", past), ("ing", progressive)):
            stem = word.removesuffix(ending)
            if stem != word and len(stem) >= _MIN_STEM and stem[-1] not in "su":
                tokens = self._lexicon.get(stem)
                if tokens:
                    return add(tokens)
        return None

    def _compound(self, word: str) -> Tokens | None:
        """Two words of the lexicon written as one; the second keeps a secondary stress."""
        for cut in range(len(word) - _MIN_PART, _MIN_PART - 1, -1):
            first = self._lexicon.get(word[:cut])
            second = self._lexicon.get(word[cut:]) if first else None
            if first and second:
                return first + tuple(t.replace("1", "2") for t in second)
        return None


def plural(tokens: Tokens, already: bool = False) -> Tokens:
    """The ending -s as it sounds after these phones; `already`: the word has it."""
    if already or not tokens:
        return tokens
    if tokens[-1] in _SIBILANT:
        return (*tokens, "I0", "z")
    return (*tokens, "s" if tokens[-1] in _VOICELESS else "z")


def past(tokens: Tokens) -> Tokens:
    """The ending -ed as it sounds after these phones."""
    if tokens[-1] in ("t", "d"):
        return (*tokens, "I0", "d")
    return (*tokens, "t" if tokens[-1] in _VOICELESS or tokens[-1] in ("s", "S", "tS") else "d")


def progressive(tokens: Tokens) -> Tokens:
    """The ending -ing."""
    return (*tokens, "I0", "N")


@cache
def english() -> English:
    """The one instance: the lexicon is read the first time it is asked for."""
    return English()
