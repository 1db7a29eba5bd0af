"""How Greek reads what the patterns find: numbers that agree with their nouns, kings, saints, addresses."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping

from fapstream.tts.greek_agreement import OPEN, Agreement, Form, plain
from fapstream.tts.numerals import Numerals
from fapstream.tts.patterns import Entry, Found, Vocabulary, Words
from fapstream.tts.readers import Readers, roman
from fapstream.tts.tables import read_rows

_UNITS = ("scale", "unit", "sign", "currency")
"""Vocabulary classes whose words are counted and declined."""
_PIECE = re.compile(
    r"[A-ZΑ-ΩΆΈΉΊΌΎΏΪΫ]+(?![a-zα-ωά-ώΐΰ])|[A-ZΑ-ΩΆΈΉΊΌΎΏΪΫ]?[a-zα-ωά-ώΐΰ]+|\d+|[^\W\d_]+|[./@:_-]+"
)
_ACCENTED = "άέήίόύώ"
_ACUTE = str.maketrans("αεηιουω", "άέήίόύώ")
_VOWELS = "αεηιουω"


class GreekReaders(Readers):
    """The readers of the Greek patterns."""

    def __init__(self, numerals: Numerals, vocabulary: Vocabulary, words: Callable[[str], list[str]]) -> None:
        """Raises DataError."""
        super().__init__(numerals, vocabulary, words)
        self._agreement = Agreement()
        self._stems: dict[str, dict[str, str]] = {"number": {}, "tens": {}, "tail": {}, "whole": {}}
        for _, (kind, written, read) in read_rows("el/compounds.tsv", 3):
            self._stems[kind][written] = read

    # numbers

    def read_number(self, found: Found, group: str, other: str) -> Words:
        """A number as it may be; a plus before it is read."""
        plus = ["συν"] if found.text(group).startswith("+") else []
        return plus + super().read_number(found, group, other)

    def read_counted(self, found: Found, group: str, other: str) -> Words:
        """What is counted, in the case that the words around ask for; `other`: how many of it."""
        entry = self._entry(found.text(group))
        if entry is None:
            return []
        single = found.text(other).lstrip("+-−") == "1"
        form = self._agreement.form(found.before, "", single, entry.gender or "n")
        return self._agreement.declined((entry.one if single else entry.many).split(), form.case)

    def read_cents_number(self, found: Found, group: str, other: str) -> Words:
        """How many hundredths of the currency with the sign `other`."""
        entry = self._vocabulary.entry("cents", found.text(other))
        return self._numerals.cardinal(int(found.text(group)), entry.gender if entry else "")

    def read_until(self, found: Found, group: str, other: str) -> Words:
        """Between the groups `a` and `b`: a range if something is counted or they are years, else a score."""
        a, b = (_value(found.text(name)) for name in "ab")
        if a >= b:
            return []
        governor = self._agreement.before(found.before) or OPEN
        ranged = (a > 1000 and b < 2200) or governor.number == "p"
        return ["έως"] if ranged or self._is_noun(found.after) else []

    def read_half(self, found: Found, group: str, other: str) -> Words:
        """A whole number and a half of what is counted."""
        entry = self._vocabulary.entry("span", found.text(other))
        gender = entry.gender if entry else self._gender(found, "2", "")
        return [self._numerals.half(int(found.text(group)), gender)]

    def read_fraction(self, found: Found, group: str, other: str) -> Words:
        """The denominator: one second, two thirds."""
        single = found.text(other) == "1"
        governor = self._agreement.before(found.before) or OPEN
        form = Form("n", "g" if governor.case == "g" else "", "s" if single else "p")
        return self._numerals.ordinal(int(found.text(group)), form.ordinal)

    def read_compound(self, found: Found, group: str, other: str) -> Words:
        """A number and the word written after it as one: 15χρονος, 24ωρο."""
        number = found.text(group)
        tail = _begun(found.text(other), self._stems["tail"])
        whole = _begun(number + tail, self._stems["whole"])
        if whole[0].isalpha():
            return self._words(whole)
        stem = self._stem(int(number))
        if not stem:
            return self._numerals.number(number, "", self._gender(found, number, "")) + self._words(tail)
        return self._words(_compound(stem, tail))

    # dates and times

    def read_day(self, found: Found, group: str, other: str) -> Words:
        """The day of a month."""
        if (day := int(found.text(group))) == 1:
            governor = self._agreement.before(found.before) or OPEN
            return ["πρώτης" if governor.number == "s" and governor.case == "g" else "πρώτη"]
        return self._numerals.cardinal(day, "f")

    def read_minutes(self, found: Found, group: str, other: str) -> Words:
        """The minutes after an hour, nothing at the full hour."""
        minute = int(found.text(group))
        return ["και", *self._numerals.cardinal(minute)] if minute else []

    def read_century(self, found: Found, group: str, other: str) -> Words:
        """A century, abbreviated; `other`: the ending of the ordinal before it."""
        ending = plain(found.text(other))
        return ["αιώνας" if ending == "οσ" else "αιώνων" if ending == "ων" else "αιώνα"]

    # ordinals and names

    def read_ordinal(self, found: Found, group: str, other: str) -> Words:
        """An ordinal; `other`: its written ending, that of the neuter if there is none."""
        digits = re.sub(r"\D", "", found.text(group))
        ending = plain(found.text(other)) or "ο"
        ending = ending[:-1] + "ς" if ending.endswith("σ") else ending
        return self._numerals.ordinal(int(digits[:9]), ending) if digits else []

    def read_keraia(self, found: Found, group: str, other: str) -> Words:
        """A Greek numeral as an ordinal that agrees with the words around it."""
        value = self._vocabulary.entry("keraia", found.text(group))
        return self._ordinal(found, int(value.one)) if value else []

    def read_roman(self, found: Found, group: str, other: str) -> Words:
        """A Roman numeral: an ordinal with names and centuries, else a cardinal."""
        value = roman(found.text(group).translate(str.maketrans("ΙΧ", "IX")))
        if self._agreement.name(found.before) or plain(found.after).startswith("αιων"):
            return self._ordinal(found, value)
        return self._numerals.cardinal(value)

    def read_declined(self, found: Found, group: str, other: str) -> Words:
        """A title or the like that agrees with the article before it."""
        written = found.text(group)
        entry = self._vocabulary.entry("declined", written) or self._vocabulary.entry("law", written)
        form = self._agreement.before(found.before) or OPEN
        if entry is None:
            return []
        words = (entry.many if form.gender == "f" else entry.one).split()
        address = not form.case and not found.before and found.after.endswith(("ε", "έ"))
        return self._agreement.declined(words, "v" if address else form.case)

    def read_saint(self, found: Found, group: str, other: str) -> Words:
        """Saint, by the name after it and the article before it."""
        governor = self._agreement.before(found.before) or OPEN
        name = self._agreement.name(found.after)
        if name is None:
            several = plain(found.after).endswith(("οι", "ων", "ουσ"))
            name = self._agreement.after(found.after, not several)
        gender = name.gender if name.gender in ("m", "f") else governor.gender or "m"
        form = Form(gender, governor.case or name.case, governor.number or name.number or "s")
        ending = form.ordinal
        if gender == "f":
            return ["αγία" + ending.removeprefix("η")]
        return ["άγι" + ending if ending in ("ος", "ο", "οι") else "αγί" + ending]

    # letters and addresses

    def read_elided(self, found: Found, group: str, other: str) -> Words:
        """What is left of a word that has lost its vowel."""
        return [found.text(group).lower()]

    def read_pieces(self, found: Found, group: str, other: str) -> Words:
        """Words written as one, cut where capitals and digits begin; signs by their names in addresses."""
        out: Words = []
        for piece in _PIECE.findall(found.text(group).rstrip(".,:-")):
            if piece.isdecimal():
                out += self._numerals.number(piece)
            elif piece[0].isalpha():
                known = self._vocabulary.classes["abbreviation"].get(piece)
                out += known.one.split() if known else self._words(piece)
            else:
                entries = [self._vocabulary.entry("address", sign) for sign in piece]
                out += [word for entry in entries if entry for word in entry.one.split()]
        return out

    # how things agree

    def _gender(self, found: Found, digits: str, other: str) -> str:
        entry = self._entry(found.text(other)) if other else None
        gender = (entry.gender or "n") if entry else ""
        single = digits == "1" and "," not in found.match.group()
        return self._agreement.form(found.before, found.after, single, gender).key

    def _entry(self, written: str) -> Entry | None:
        entries = (self._vocabulary.entry(name, written) for name in _UNITS) if written else ()
        return next((entry for entry in entries if entry), None)

    def _is_noun(self, word: str) -> bool:
        form = self._agreement.after(word, False)
        return len(word) > 3 and form is not OPEN and form.number != "x"

    def _ordinal(self, found: Found, value: int) -> Words:
        form = self._agreement.name(found.before) or self._agreement.before(found.before)
        if form is None or not (form.gender and form.number):
            noun = self._agreement.after(found.after, True)
            usual = Form("m" if plain(found.before).endswith("οσ") else "f", "", "s")
            form = noun if noun.gender else usual
        return self._numerals.ordinal(value, form.ordinal)

    def _stem(self, number: int) -> str:
        if stem := self._stems["number"].get(str(number)):
            return stem
        tens, unit = divmod(number, 10)
        return self._stems["tens"].get(f"{tens}0", "") and (
            self._stems["tens"][f"{tens}0"] + self._stems["tens"].get(str(unit), "")
        )


def _value(number: str) -> int:
    return int(re.sub(r"\D", "", number.partition(",")[0]) or "0")


def _begun(text: str, beginnings: Mapping[str, str]) -> str:
    """The text with its beginning replaced, if the table has one for it."""
    return next((new + text[len(old) :] for old, new in beginnings.items() if text.startswith(old)), text)


def _compound(stem: str, tail: str) -> str:
    """A stem and a word joined; the accent goes on the stem's last vowel unless the word has its own."""
    accented = any(c in _ACCENTED for c in tail)
    if plain(tail[0]) == "α" and stem[-1] == "α":
        stem, tail = (stem[:-1], tail) if accented else (stem, tail[1:])
    if accented or not tail:
        return stem + tail
    last = max(at for at, c in enumerate(stem) if c in _VOWELS)
    return stem[:last] + stem[last].translate(_ACUTE) + stem[last + 1 :] + tail
