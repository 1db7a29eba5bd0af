"""How the pieces that patterns find are read: numbers in all their roles, letters, Roman numerals."""

from __future__ import annotations

import re
from collections.abc import Callable

from fapstream.tts.numerals import Numerals, plural
from fapstream.tts.patterns import Found, Reader, Vocabulary, Words
from fapstream.tts.spelling import ended, fold_latin

_ROMAN = {"I": 1, "V": 5, "X": 10, "L": 50, "C": 100, "D": 500, "M": 1000}
MAX_GROUP = 3
"""So many capitals before digits are letters, as in MH370."""
_RUNS = re.compile(r"\d+|[^\W\d_]+")
_CAMEL = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+|[^\W\d_]+")


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
            if c.isdecimal():
                out += self._numerals.digits(c)
            elif c.isalpha():
                out += fold_latin(c).upper() or self._words(c.upper())
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
        sign = self._numerals.sign(text[0]) if text[0] in "-−+" else []
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

    def read_upto(self, found: Found, group: str, other: str) -> Words:
        """The end of a range, or what is compared with `other` if it is not more: 10-20, but 3-1."""
        first, last = (int(re.sub(r"\D", "", found.text(g))[:15] or "0") for g in (other, group))
        return [*(self._numerals.until() if first < last else []), *self.read_number(found, group, "")]

    def read_parts(self, found: Found, group: str, other: str) -> Words:
        """Numbers with points between them."""
        out: Words = []
        for part in re.findall(r"\d+", found.text(group)):
            out += [*([self._numerals.point] if out else []), *self._numerals.number(part)]
        return out

    def read_code(self, found: Found, group: str, other: str) -> Words:
        """Letters and digits mixed, as names of things have them."""
        return [w for run in _RUNS.findall(found.text(group)) for w in self._run(run)]

    def read_codes(self, found: Found, group: str, other: str) -> Words:
        """Several things of one name."""
        words = self.read_code(found, group, other)
        return ended(words, "s") if len(words[-1]) == 1 else plural(words)

    def read_camel(self, found: Found, group: str, other: str) -> Words:
        """Words written as one, told apart by their capitals."""
        runs = _CAMEL.findall(found.text(group))
        return [
            w for run in runs for w in (self._numerals.code(run) if run.isdecimal() else self._words(run))
        ]

    def read_address(self, found: Found, group: str, other: str) -> Words:
        """A name in a network or of a file: words, digits, and the signs between them that are known."""
        known = self._vocabulary.classes["address"]
        out: Words = []
        for piece in re.findall(r"[^\W\d_]+|\d+|\D", found.text(group).rstrip("/.,;:!")):
            if entry := known.get(piece.lower()):
                out += entry.one.split()
            elif piece.isdecimal():
                out += self._numerals.code(piece)
            elif piece.isalpha():
                out += [w for run in _CAMEL.findall(piece) for w in self._words(run)]
        return out

    def read_dotted(self, found: Found, group: str, other: str) -> Words:
        """Digits one by one with the points between them."""
        point = self._vocabulary.classes["address"]["."].one
        parts = re.findall(r"\d+", found.text(group))
        out = [word for part in parts for word in [point, *self._numerals.digits(part)]]
        return out[1:]

    def read_fraction(self, found: Found, group: str, other: str) -> Words:
        """The denominator of a fraction whose numerator is `other`."""
        return self._numerals.denominator(int(found.text(group)), int(found.text(other) or "1"))

    def _run(self, run: str) -> Words:
        if run.isdecimal():
            return self._numerals.code(run)
        known = self._vocabulary.classes.get("spoken", {})
        if len(run) == 1 or (run.isupper() and len(run) <= MAX_GROUP and run not in known):
            return [c.upper() for c in fold_latin(run) if c.isalpha()]
        return self._words(run)

    def _gender(self, found: Found, digits: str, other: str) -> str:
        if other and (gender := self._vocabulary.gender(found.text(other))):
            return gender
        return self._numerals.gender_between(found.before, found.after, digits)


def roman(text: str) -> int:
    """The value of a Roman numeral."""
    values = [_ROMAN[c] for c in text.upper()]
    following = [*values[1:], 0]
    return sum(v if v >= n else -v for v, n in zip(values, following, strict=True))
