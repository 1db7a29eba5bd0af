"""Numbers as words: one small engine, and a table `numbers.toml` for each language."""

from __future__ import annotations

import tomllib
from typing import Any

from fapstream.tts.tables import read_text

MAX_DIGITS = 15
"""Longer numbers are read digit by digit."""

Words = list[str]


class Numerals:
    """Cardinals, ordinals, decimals, years, clock times and sums of money of one language.

    Every method returns the spoken words. `gender` is "" for the counting form (neuter in Greek), "f" or "m".
    """

    def __init__(self, lang: str) -> None:
        self._t: dict[str, Any] = tomllib.loads(read_text(f"{lang}/numbers.toml"))
        self.decimal_mark: str = self._t["decimal_mark"]
        self.group_mark: str = self._t["group_mark"]
        self.ordinal_suffixes: list[str] = self._t["ordinal_suffixes"]
        self.signs: list[str] = list(self._t["money"])
        self.percent: str = self._t["percent"]
        self.scale_words = frozenset(self._t["scale_words"])

    def gender_before(self, next_word: str, number: str) -> str:
        """The gender that the ending of the counted noun asks for, as far as an ending can tell."""
        table = "gender_of_one" if number == "1" else "gender_of"
        endings: dict[str, str] = self._t.get(table, {})
        return next((g for ending, g in endings.items() if next_word.endswith(ending)), "")

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
                words += [*self.cardinal(count, scale.get("gender", "")), scale["many"]]
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
        tail = self.digits(fraction) if by_digit else self.cardinal(int(fraction))
        return [*words, self._t["point"], *tail]

    def minus(self) -> str:
        return str(self._t["minus"])

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
        words = self.year(n)
        last = words[-1]
        return [*words[:-1], last.removesuffix("y") + "ies" if last.endswith("y") else last + "s"]

    def clock(self, hour: int, minute: int, second: int = 0) -> Words:
        """21:45 -> twenty one forty five; είκοσι μία και σαράντα πέντε."""
        gender = self._t.get("hour_gender", "")
        words = self.cardinal(hour, gender)
        if "hour_exact" in self._t:
            words = self._english_minutes(hour, words, minute)
        elif minute:
            words += [self._t["and"], *self.cardinal(minute)]
        return [*words, self._t["and"], *self.cardinal(second)] if second else words

    def _english_minutes(self, hour: int, words: Words, minute: int) -> Words:
        if not minute:
            exact = self._t["hour_exact" if 1 <= hour <= 12 else "hour_exact_24"]
            return [*words, exact] if hour else [self._t["zero_hour"], exact]
        zero = [self._t["digits_zero"]] if minute < 10 else []
        return [*words, *zero, *self.cardinal(minute)]

    def coins(self, sign: str) -> str:
        """The currency's plural: $ -> dollars."""
        return str(self._t["money"][sign][1])

    def money(self, sign: str, whole: str, fraction: str = "") -> Words:
        """A sum: $2.50 -> two dollars and fifty cents."""
        one, many, cent, cents = self._t["money"][sign]
        gender = self._t.get("money_gender", {}).get(sign, "")
        if len(fraction) not in (0, 2):
            return [*self.number(whole, fraction, gender), many]
        words = [*self.number(whole, "", gender), one if int(whole) == 1 else many]
        if not fraction or fraction == "00":
            return words
        coin = cent if fraction == "01" else cents
        return [*words, self._t["and"], *self.cardinal(int(fraction)), coin]

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
