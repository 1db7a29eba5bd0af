"""Numbers as words: one small engine, and a table `numbers.toml` for each language."""

from __future__ import annotations

import tomllib
from typing import Any

from fapstream.tts.tables import read_text

MAX_DIGITS = 15
"""Longer numbers are read digit by digit."""

Words = list[str]


class Numerals:
    """Cardinals, ordinals, decimals, fractions, years and clock times of one language.

    Every method returns the spoken words. `gender` is "" for the counting form (neuter in Greek), "f" or "m",
    or whatever else the tables of the language have forms for (see greek_agreement.py).
    """

    def __init__(self, lang: str) -> None:
        self._t: dict[str, Any] = tomllib.loads(read_text(f"{lang}/numbers.toml"))
        self.decimal_mark: str = self._t["decimal_mark"]

    @property
    def units(self) -> list[str]:
        """The numbers from nought to nineteen in every gender."""
        genders = [v for key, table in self._t.items() if key.startswith("units_") for v in table.values()]
        return [*self._t["units"], *genders]

    def gender_between(self, before: str, after: str, number: str) -> str:
        """The gender that the ending of the counted noun asks for, as far as the words around can tell."""
        table = "gender_of_one" if number == "1" else "gender_of"
        endings: dict[str, str] = self._t.get(table, {})
        return next((g for ending, g in endings.items() if after.endswith(ending)), "")

    def cardinal(self, n: int, gender: str = "") -> Words:
        """`n` >= 0; beyond MAX_DIGITS digits the digits one by one."""
        if n >= 10**MAX_DIGITS:
            return self.digits(str(n))
        words: Words = []
        for scale in self._t["scales"]:
            count, n = divmod(n, scale["value"])
            if count == 1:
                words += scale.get(f"one_{gender}", scale["one"]).split()
            elif count:
                inner = scale.get(f"gender_{gender}", scale.get("gender", ""))
                words += [*self.cardinal(count, inner), scale.get(f"many_{gender}", scale["many"])]
        return words + self._below_thousand(n, gender) if n or not words else words

    def _below_thousand(self, n: int, gender: str) -> Words:
        exact: dict[str, str] = self._t.get("exact", {})
        if str(n) in exact:
            return [exact[str(n)]]
        words: Words = []
        hundreds, rest = divmod(n, 100)
        if hundreds:
            words += self._hundreds(hundreds, gender).split()
        tens, unit = divmod(rest, 10)
        if rest >= 20:
            words.append(self._t["tens"][tens])
            rest = unit
        if rest or not n:
            words.append(self._unit(rest, gender))
        return words

    def _unit(self, n: int, gender: str) -> str:
        return str(self._t.get(f"units_{gender}", {}).get(str(n), self._t["units"][n]))

    def _hundreds(self, n: int, gender: str) -> str:
        word = str(self._t["hundreds"][n])
        old, new = self._t.get("hundreds_ending", {}).get(gender, ("", ""))
        return word.removesuffix(old) + new if n > 1 and old else word

    def digits(self, text: str) -> Words:
        """Each digit by its name."""
        return [self._t["units"][int(d)] for d in text]

    def number(self, whole: str, fraction: str = "", gender: str = "") -> Words:
        """Digits before and after the decimal mark, as written; leading zeros are read one by one."""
        spelled = len(whole) > MAX_DIGITS or (len(whole) > 1 and whole[0] == "0")
        words = self.digits(whole) if spelled else self.cardinal(int(whole or "0"), gender)
        if not fraction:
            return words
        by_digit = self._t["decimal_mark"] == "." or fraction[0] == "0" or len(fraction) > 2
        tail = self.digits(fraction) if by_digit else self.cardinal(int(fraction), gender)
        return [*words, self._t["point"], *tail]

    def sign(self, sign: str) -> Words:
        """The sign before a number."""
        return str(self._t["minus"] if sign in "-−" else self._t.get("plus", "")).split()

    @property
    def point(self) -> str:
        """The decimal mark as it is read."""
        return str(self._t["point"])

    def until(self) -> Words:
        """What stands between the ends of a range."""
        return str(self._t.get("until", "")).split()

    def code(self, digits: str) -> Words:
        """Digits of a name or number plate: in pairs where years are, as in A320, else as a number."""
        oh, n = self._t.get("digits_zero"), int(digits[:9])
        if len(digits) > 4 or (len(digits) > 1 and digits[0] == "0"):
            return self.digits(digits)
        first, rest = divmod(n, 100)
        if not (oh and first) or (not rest and (n < 1000 or not n % 1000)):
            return self.cardinal(n)
        tail = self.cardinal(rest) if rest else [self._t["long_year"]]
        return [*self.cardinal(first), *([oh] if 0 < rest < 10 else []), *tail]

    def year(self, n: int) -> Words:
        """1984 -> nineteen eighty-four where years are read in pairs, else the cardinal."""
        spans = zip(self._t.get("year_from", []), self._t.get("year_to", []), strict=True)
        if not any(low <= n <= high for low, high in spans):
            return self.cardinal(n)
        century, rest = divmod(n, 100)
        if not rest:
            return [*self.cardinal(century), self._t["long_year"]]
        zero = [self._t["digits_zero"]] if rest < 10 else []
        return [*self.cardinal(century), *zero, *self.cardinal(rest)]

    def decade(self, n: int) -> Words:
        """1990 -> nineteen nineties."""
        return plural(self.year(n))

    def hour(self, n: int) -> Words:
        """The hour of a clock time."""
        if not n and "zero_hour" in self._t:
            return [self._t["zero_hour"]]
        return self.cardinal(n, self._t.get("hour_gender", ""))

    def minute(self, n: int) -> Words:
        """Minutes after an hour: five is `oh five` where that is the custom."""
        zero = self._t.get("digits_zero") if n < 10 else None
        return [zero, *self.cardinal(n)] if zero else self.cardinal(n)

    def half(self, n: int, gender: str = "") -> str:
        """A whole number and a half as one word, "" if the language has none."""
        own: str = self._t.get(f"halves_{gender}", {}).get(str(n), "")
        return own or str(self._t.get("halves", {}).get(str(n), ""))

    def denominator(self, n: int, numerator: int) -> Words:
        """The lower number of a fraction; 1/4 -> quarter, 2/3 -> thirds."""
        table: dict[str, list[str]] = self._t.get("denominators", {})
        one, many = table.get(str(n), ["", ""])
        if one:
            return (one if numerator == 1 else many).split()
        words = self.ordinal(n, self._t.get("denominator_ending", ""))
        plural = self._t.get("denominator_plural", "")
        return words if numerator == 1 or not plural else [*words[:-1], words[-1] + plural]

    def ordinal(self, n: int, suffix: str) -> Words:
        """`suffix` is what was written after the digits: 21st -> twenty first; 21η -> εικοστή πρώτη."""
        stems: dict[str, str] = self._t.get("ordinal_stems", {})
        return self._greek_ordinal(n, suffix, stems) if stems else self._english_ordinal(n)

    def _english_ordinal(self, n: int) -> Words:
        words = self.cardinal(n)
        table: dict[str, str] = self._t["ordinals"]
        return [*words[:-1], table.get(words[-1], words[-1] + table["default"])]

    def _greek_ordinal(self, n: int, suffix: str, stems: dict[str, str]) -> Words:
        parts = [p for p in (n // 1000 * 1000, n // 100 % 10 * 100, n // 10 % 10 * 10, n % 10) if p]
        if str(n % 100) in stems:
            parts = [p for p in parts if p >= 100] + [n % 100]
        if n > 9999 or any(str(p) not in stems for p in parts):
            return [*self.cardinal(n)]
        return [greek_ending(stems[str(p)], suffix) for p in parts]


def plural(words: Words) -> Words:
    """English words with the last in the plural: twenty -> twenties, six -> sixes."""
    last = words[-1]
    many = (
        last.removesuffix("y") + "ies" if last.endswith("y") else last + ("es" if last[-1] in "sx" else "s")
    )
    return [*words[:-1], many]


_ACCENTED = str.maketrans("άέήίόύώ", "αεηιουω")
_ACUTE = {"ο": "ό", "η": "ή", "α": "ά", "ε": "έ", "ω": "ώ", "ι": "ί"}


def greek_ending(stem: str, ending: str) -> str:
    """A Greek adjective's stem and ending joined, with the accent where it belongs.

    Oxytone stems (written without an accent) take it on the ending: εικοστ + η = εικοστή.
    """
    if stem.translate(_ACCENTED) != stem:
        return stem + ending
    if ending in ("ου", "ους"):
        return stem + ending.replace("ου", "ού")
    if ending == "οι":
        return stem + "οί"
    return stem + _ACUTE.get(ending[0], ending[0]) + ending[1:]
