"""Greek words to phones by the four-part rules of `data/el/rules.tsv`; the stress is where the tonos is."""

from __future__ import annotations

import re
from functools import cache
from typing import Final

from fapstream.errors import DataError
from fapstream.tts.rules import BOUNDARY, RuleSet
from fapstream.tts.tables import read_pairs, read_rows

Tokens = tuple[str, ...]
_UNSTRESSED: Final = {vowel: vowel + "0" for vowel in "aeiou"}
_GLIDE: Final = ("Y",)
_TONOS = dict(zip("αεηιουωϊϋ", "άέήίόύώΐΰ", strict=True))
_NO_TONOS = str.maketrans({with_tonos: plain for plain, with_tonos in _TONOS.items()})
_WITH_TONOS: Final = frozenset(_TONOS.values())
_SYLLABLE = re.compile("ου|αι|ει|οι|υι|[αεη]υ|[αεηιουωϊϋ]")
_ONE_SYLLABLE = re.compile("[^αεηιουωϊϋ]+(?:ι|υ|οι|ει)(?:ου|οι|[αεοω])[νσ]?")
"""Words that bear no tonos because their i is no syllable: μια, δυο, γεια, ποιος."""


class Greek:
    """Pronounces lower-case Greek words (see `normalise.fold_greek`) and capital letters by name."""

    def __init__(self) -> None:
        """Reads the rules. Raises DataError."""
        self._rules = RuleSet.read("el/rules.tsv")
        self._glides = {phone: tuple(both.split()) for phone, both in read_pairs("el/glides.tsv").items()}
        self._endings = _read_endings("el/stress.tsv")
        self._letters = {letter.upper(): name for letter, name in read_pairs("el/letters.tsv").items()}
        clitics = [row[0].replace("ς", "σ") for _, row in read_rows("el/function_words.tsv", 4)]
        self._clitics = frozenset(clitics) | {word.translate(_NO_TONOS) for word in clitics}

    def phones(self, words: list[str]) -> list[Tokens]:
        """The phones of each word of a phrase; a word depends on the one before and the one after it."""
        if not words:
            return []
        plain = [self._spelling(w) for w in words]
        text = BOUNDARY + BOUNDARY.join(plain) + BOUNDARY
        found: list[list[str]] = [[] for _ in words]
        word, end = 0, 1 + len(plain[0])
        tokens, last = found[0], len(plain) - 1
        for match in self._rules.apply(text):
            while match.start >= end and word < last:
                word += 1
                end += 1 + len(plain[word])
                tokens = found[word]
            tokens += self._glide(tokens) if match.output == _GLIDE else match.output
        return [self._stressed(w, tokens) for w, tokens in zip(plain, found, strict=True)]

    def path(self, word: str) -> str:
        """Where a word's phones come from: `letter` or `rule`."""
        return "letter" if word in self._letters else "rule"

    def word(self, word: str) -> Tokens:
        """One word by itself."""
        return self.phones([word])[0]

    def needs_next(self, word: str) -> bool:
        """Whether the phones of `word` may depend on the word after it; False is a promise."""
        return self._rules.looks_past(self._spelling(word))

    def _spelling(self, word: str) -> str:
        """The word as the rules take it: letters by name, one sigma, a tonos where there are syllables."""
        plain = self._letters.get(word, word).replace("ς", "σ")
        if not _WITH_TONOS.isdisjoint(plain) or plain in self._clitics:
            return plain
        syllables = list(_SYLLABLE.finditer(plain))
        if len(syllables) < 2 or _ONE_SYLLABLE.fullmatch(plain):
            return plain
        last = syllables[-min(self._from_end(plain), len(syllables))].end() - 1
        return plain[:last] + _TONOS[plain[last]] + plain[last + 1 :]

    def _from_end(self, word: str) -> int:
        """Which syllable from the last has the stress, as far as the ending of a word in capitals tells."""
        endings = (word[start:] for start in range(len(word) + 1))
        return next(self._endings[ending] for ending in endings if ending in self._endings)

    def _glide(self, before: list[str]) -> Tokens:
        """What an i that is no syllable adds to a word; it may change the consonant before it."""
        consonant = before.pop()
        return self._glides.get(consonant, (consonant, "j"))

    def _stressed(self, word: str, tokens: list[str]) -> Tokens:
        """Every vowel with a stress digit; of content words without a tonos the first has the stress."""
        marked, first = False, -1
        for i, token in enumerate(tokens):
            if (unstressed := _UNSTRESSED.get(token)) is not None:
                tokens[i] = unstressed
                first = i if first < 0 else first
            elif token[-1] == "1":
                marked = True
        if first >= 0 and not marked and word not in self._clitics:
            tokens[first] = tokens[first][0] + "1"
        return tuple(tokens)


def _read_endings(path: str) -> dict[str, int]:
    """Ending -> syllable from the last; the empty ending must be there. Raises DataError."""
    try:
        endings = {ending: int(syllable) for ending, syllable in read_pairs(path).items()}
    except ValueError as error:
        raise DataError(path, None, str(error)) from error
    if "" not in endings or min(endings.values()) < 1:
        raise DataError(path, None, "the empty ending is missing, or a syllable is less than 1")
    return endings


@cache
def greek() -> Greek:
    """The one instance."""
    return Greek()
