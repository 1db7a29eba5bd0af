"""How the pieces that patterns find are read: numbers in all their roles, letters, Roman numerals."""

from __future__ import annotations

import re
from collections.abc import Callable

from fapstream.tts.numerals import Numerals
from fapstream.tts.patterns import Found, Reader, Vocabulary, Words

_ROMAN = {"I": 1, "V": 5, "X": 10, "L": 50, "C": 100, "D": 500, "M": 1000}
MAX_GROUP = 3
"""Digits of a telephone number that are read without a break, when it is not written in groups."""


class Readers:
    """The readers of a language, by the names that patterns.tsv uses."""

    def __init__(self, numerals: Numerals, vocabulary: Vocabulary, words: Callable[[str], list[str]]) -> None:
        """`words`: how a plain word is read."""
        self._numerals = numerals
        self._vocabulary = vocabulary
        self._words = words

    def table(self) -> dict[str, Reader]:
        """Every reader by its name."""
        names = [name for name in dir(self) if name.startswith("read_")]
        return {name.removeprefix("read_"): getattr(self, name) for name in names}

    def read_text(self, found: Found, group: str, other: str) -> Words:
        """Words as they are, signs left out."""
        return [
            w
            for part in re.findall(r"[^\W\d_]+(?:['’][^\W\d_]+)*", found.text(group))
            for w in self._words(part)
        ]

    def read_spell(self, found: Found, group: str, other: str) -> Words:
        """Letters and digits by their names."""
        out: Words = []
        for c in found.text(group):
            if c.isdigit():
                out += self._numerals.digits(c)
            elif c.isalpha():
                out += [word.upper() for word in self._words(c)]
        return out

    def read_digits(self, found: Found, group: str, other: str) -> Words:
        """Digits one by one, whatever stands between them."""
        return self._numerals.digits(re.sub(r"\D", "", found.text(group)))

    def read_cardinal(self, found: Found, group: str, other: str) -> Words:
        """A whole number; its gender is that of the noun it counts."""
        digits = re.sub(r"\D", "", found.text(group))
        return self._numerals.number(digits, "", self._gender(found, digits, other))

    def read_number(self, found: Found, group: str, other: str) -> Words:
        """A number with sign, groups of digits and decimals as they may be."""
        text = found.text(group)
        whole, _, fraction = text.lstrip("+-−#").partition(self._numerals.decimal_mark)
        whole, fraction = re.sub(r"\D", "", whole), re.sub(r"\D", "", fraction)
        sign = self._numerals.minus().split() if text[:1] in "-−" else []
        return sign + self._numerals.number(whole or "0", fraction, self._gender(found, whole, other))

    def read_year(self, found: Found, group: str, other: str) -> Words:
        """A year."""
        return self._numerals.year(int(found.text(group)))

    def read_decade(self, found: Found, group: str, other: str) -> Words:
        """The tens of years that begin with a year."""
        return self._numerals.decade(int(found.text(group)))

    def read_hour(self, found: Found, group: str, other: str) -> Words:
        """The hour of a clock time."""
        return self._numerals.hour(int(found.text(group)))

    def read_minute(self, found: Found, group: str, other: str) -> Words:
        """The minutes after an hour."""
        return self._numerals.minute(int(found.text(group)))

    def read_ordinal(self, found: Found, group: str, other: str) -> Words:
        """An ordinal; `other`: its written ending."""
        digits = re.sub(r"\D", "", found.text(group))
        return self._numerals.ordinal(int(digits[:9]), found.text(other)) if digits else []

    def read_roman(self, found: Found, group: str, other: str) -> Words:
        """A Roman numeral as a cardinal."""
        return self._numerals.cardinal(roman(found.text(group)))

    def read_roman_ordinal(self, found: Found, group: str, other: str) -> Words:
        """A Roman numeral as an ordinal."""
        return self._numerals.ordinal(roman(found.text(group)), found.text(other))

    def read_fraction(self, found: Found, group: str, other: str) -> Words:
        """The denominator of a fraction whose numerator is `other`."""
        return self._numerals.denominator(int(found.text(group)), int(found.text(other) or "1"))

    def _gender(self, found: Found, digits: str, other: str) -> str:
        if other and (gender := self._vocabulary.gender(found.text(other))):
            return gender
        return self._numerals.gender_between(found.before, found.after, digits)


def roman(text: str) -> int:
    """The value of a Roman numeral."""
    values = [_ROMAN[c] for c in text.upper()]
    following = [*values[1:], 0]
    return sum(v if v >= n else -v for v, n in zip(values, following, strict=True))
