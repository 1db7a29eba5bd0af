"""English words from the words they are made of: endings and compounds.

Which there are was counted on words of CMUdict that neither the lexicon nor the trees were shown: what the
trees, which see the same letters, read as well by themselves is not here (-able, -ier, un-, re-, and any two
words written as one).
"""

from __future__ import annotations

from collections.abc import Callable

from fapstream.errors import DataError
from fapstream.tts.tables import read_pairs, read_rows

Tokens = tuple[str, ...]
LookUp = Callable[[str], Tokens | None]
"""A word's phones, or None."""

SIBILANT = frozenset(("s", "z", "S", "Z", "tS", "dZ"))
VOICELESS = frozenset(("p", "t", "k", "f", "T", "s", "S", "tS"))
MIN_STEM, MIN_PART = 3, 3
"""Letters that a stem and a part of a compound have at least."""
PARTNER = 4
"""Letters that the second word of a compound has at least if it is only the first that is known."""
MAX_WORD = 40
"""Longer words are not looked at."""


def plural(tokens: Tokens) -> Tokens:
    """The ending -s as it sounds after these phones."""
    if tokens[-1] in SIBILANT:
        return (*tokens, "I0", "z")
    return (*tokens, "s" if tokens[-1] in VOICELESS else "z")


def past(tokens: Tokens) -> Tokens:
    """The ending -ed as it sounds after these phones."""
    if tokens[-1] in ("t", "d"):
        return (*tokens, "I0", "d")
    return (*tokens, "t" if tokens[-1] in VOICELESS else "d")


class Stems:
    """Takes words apart; what the parts sound like is asked of a look-up."""

    def __init__(self, look_up: LookUp) -> None:
        """Reads the tables. Raises DataError."""
        self._look_up = look_up
        self._endings: dict[str, list[tuple[str, tuple[str, ...], str]]] = {}
        path = "en/endings.tsv"
        for line, (ending, instead, phones) in read_rows(path, 3):
            if not (ending and instead.split() and phones):
                raise DataError(path, line, "an ending, what stands in its stead, and phones are needed")
            self._endings.setdefault(ending[-1], []).append((ending, tuple(instead.split()), phones))
        compounds = read_pairs("en/compounds.tsv")
        self._first, self._last = (frozenset(compounds[place].split()) for place in ("first", "last"))

    def inflected(self, word: str) -> Tokens | None:
        """A known stem and an ending, or a possessive."""
        if len(word) > MAX_WORD:
            return None
        if word.endswith("'s"):
            stem = self._look_up(word[:-2]) or self.inflected(word[:-2])
            return plural(stem) if stem else None
        if word.endswith("s'"):
            return self._look_up(word[:-1]) or self.inflected(word[:-1])
        return self._ending(word)

    def _ending(self, word: str) -> Tokens | None:
        for ending, instead, phones in self._endings.get(word[-1:], ()):
            if word.endswith(ending):
                bare = word[: -len(ending)]
                for change in instead:
                    stem = self._stem(bare, change)
                    if stem:
                        return self._joined(stem, phones)
        return None

    def _stem(self, bare: str, change: str) -> Tokens | None:
        """The phones of the stem that is left, with the change at its end."""
        if change == "2":
            doubled = len(bare) > MIN_STEM and bare[-1] == bare[-2] and bare[-1] not in "aeiou"
            return self._look_up(bare[:-1]) if doubled else None
        bare += "" if change == "=" else change
        return self._look_up(bare) if len(bare) >= MIN_STEM else None

    def _joined(self, stem: Tokens, phones: str) -> Tokens:
        if phones == "PLURAL":
            return plural(stem)
        if phones == "LY":
            return (*stem, "i0") if stem[-1] == "l" else (*stem, "l", "i0")
        return past(stem) if phones == "PAST" else (*stem, *phones.split())

    def compound(self, word: str) -> Tokens | None:
        """Two words of the lexicon written as one, of which one is known to keep its sound in compounds; the
        second keeps a secondary stress."""
        n = len(word)
        if n > MAX_WORD:
            return None
        for cut in sorted(range(MIN_PART, n - MIN_PART + 1), key=lambda cut: abs(2 * cut - n)):
            one, two = word[:cut], word[cut:]
            begins, ends = one in self._first, two in self._last
            if ends or (begins and n - cut >= PARTNER):
                first = self._look_up(one)
                second = self._look_up(two) if first else None
                if first and second:
                    return first + tuple(t.replace("1", "2") for t in second)
        return None
