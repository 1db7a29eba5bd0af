"""Greek words to phones by the four-part rules of `data/el/rules.tsv`; the stress is where the tonos is."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

from fapstream.tts.rules import BOUNDARY, RuleSet
from fapstream.tts.tables import read_pairs, read_rows

Tokens = tuple[str, ...]
_VOWELS = frozenset("aeiou")


class Greek:
    """Pronounces lower-case Greek words (see `normalise.fold_greek`) and capital letters by name."""

    def __init__(self) -> None:
        """Reads the rules. Raises DataError."""
        self._rules = RuleSet.read("el/rules.tsv")
        self._letters = {letter.upper(): name for letter, name in read_pairs("el/letters.tsv").items()}
        functions = read_rows("el/function_words.tsv", 4)
        self._clitics = frozenset(row[0].replace("ς", "σ") for _, row in functions)

    def phones(self, words: Sequence[str]) -> list[Tokens]:
        """The phones of each word of a phrase; neighbours act on each other across the gap."""
        if not words:
            return []
        plain = [self._letters.get(w, w).replace("ς", "σ") for w in words]
        text = BOUNDARY + BOUNDARY.join(plain) + BOUNDARY
        found: list[list[str]] = [[] for _ in words]
        word, end = 0, 1 + len(plain[0])
        for match in self._rules.apply(text):
            while match.start >= end and word + 1 < len(plain):
                word += 1
                end += 1 + len(plain[word])
            found[word].extend(match.output)
        return [self._stressed(w, tokens) for w, tokens in zip(plain, found, strict=True)]

    def needs_next(self, word: str) -> bool:
        return word[-1:] in "νσς"

    def path(self, word: str) -> str:
        return "letter" if word in self._letters else "rule"

    def word(self, word: str) -> Tokens:
        """One word by itself."""
        return self.phones([word])[0]

    def _stressed(self, word: str, tokens: list[str]) -> Tokens:
        """Every vowel with a stress digit; content words without a tonos get one by rule.

        Words in capitals bear no tonos: the last syllable but one is the best single guess.
        """
        vowels = [i for i, t in enumerate(tokens) if t[0] in _VOWELS]
        marked = [t if t[-1] == "1" or i not in vowels else t + "0" for i, t in enumerate(tokens)]
        if vowels and word not in self._clitics and not any(t[-1] == "1" for t in tokens):
            i = vowels[max(len(vowels) - 2, 0)]
            marked[i] = tokens[i] + "1"
        return tuple(marked)


@cache
def greek() -> Greek:
    """The one instance."""
    return Greek()
