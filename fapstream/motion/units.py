"""The units that learned models know: the phones of CMUdict, most vowels in a stressed and an unstressed
form.

speech-enabled-avatars, section 3.3. Which units a language's phones are, and what the phones of CMUdict have
in common, is in data/units_LANG.tsv and data/features.tsv.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import NamedTuple

from fapstream.data import names, read_lines
from fapstream.errors import DataError, UnknownLanguage
from fapstream.records import SILENCE, TimedPhone

SIL = "SIL"
WITH_STRESS = frozenset(["AA", "AE", "AH", "AO", "AY", "EH", "ER", "EY", "IH", "IY", "OW", "UW"])
"""Phones that come stressed (1) and unstressed (0)."""


class TimedUnit(NamedTuple):
    """A unit and the samples [start, end) in which it is heard."""

    name: str
    start: int
    end: int


@dataclass(frozen=True, slots=True)
class _Spelling:
    units: tuple[str, ...]
    share: float
    """The part of the phone at which a second unit begins."""


@cache
def features() -> dict[str, frozenset[str]]:
    """What every unit is, by its name; a unit's phone is among its features. Raises DataError."""
    table: dict[str, frozenset[str]] = {}
    for number, line in read_lines("motion", "features.tsv"):
        phone, _, words = line.partition("\t")
        if not words or not phone.isalpha():
            raise DataError("features.tsv", number, "expected a phone and its features")
        of = frozenset((phone, *words.split()))
        if phone in WITH_STRESS:
            table[f"{phone}0"], table[f"{phone}1"] = of | {"unstressed"}, of | {"stressed"}
        else:
            table[phone] = of
    return table


def unit(phone: str, stressed: bool) -> str:
    """The unit of a phone of CMUdict, which is named without its stress digit."""
    return f"{phone}{int(stressed)}" if phone in WITH_STRESS else phone


@cache
def _spellings(lang: str) -> dict[str, _Spelling]:
    """Of every phone of a language, by SAMPA name. Raises UnknownLanguage, DataError."""
    known = tuple(file[6:-4] for file in names("motion") if file.startswith("units_"))
    if lang not in known:
        raise UnknownLanguage(lang, known)
    name, spellings = f"units_{lang}.tsv", {}
    for number, line in read_lines("motion", name):
        try:
            phone, units, share = line.split("\t")
            spelling = _Spelling(tuple(units.split()), 1.0 if share == "-" else float(share) / 100)
            if len(spelling.units) != 1 + (share != "-") or not 0 < spelling.share <= 1:
                raise ValueError("expected one unit, or two and where the second begins")
            for base in spelling.units:
                features()[unit(base, False)]
        except (ValueError, KeyError) as e:
            raise DataError(name, number, str(e)) from None
        spellings[phone] = spelling
    return spellings


def units(timed: TimedPhone, lang: str) -> tuple[TimedUnit, ...]:
    """The units of one phone, in order. A phone that the table does not have is a pause."""
    phone = timed.phone
    spelling = _spellings(lang).get(phone.name) or _spellings(lang)[SILENCE]
    found = [unit(base, phone.stress > 0) for base in spelling.units]
    if len(found) == 1:
        return (TimedUnit(found[0], timed.start, timed.end),)
    middle = timed.start + round(spelling.share * (timed.end - timed.start))
    return (TimedUnit(found[0], timed.start, middle), TimedUnit(found[1], middle, timed.end))
