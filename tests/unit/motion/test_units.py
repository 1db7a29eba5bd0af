"""Every phone of every language is units, and units are told by their features."""

from __future__ import annotations

import itertools

import pytest

from fapstream.errors import DataError, UnknownLanguage
from fapstream.motion import units as module
from fapstream.motion.units import SIL, TimedUnit, features, unit, units
from fapstream.records import Phone, TimedPhone
from fapstream.tts import LANGUAGES, phone_set


@pytest.mark.parametrize("lang", LANGUAGES)
@pytest.mark.parametrize("stress", [0, 1, 2])
def test_every_phone_of_a_language_is_units_that_fill_it(lang: str, stress: int) -> None:
    for name in phone_set(lang):
        timed = TimedPhone(Phone(name, 100.0, stress=stress), 1000, 2600)
        found = units(timed, lang)
        assert all(u.name in features() for u in found)
        assert (found[0].start, found[-1].end) == (1000, 2600)
        assert all(a.end == b.start for a, b in itertools.pairwise(found))
        assert (found[0].name == SIL) == (name == "_")


def test_stress_is_in_the_name_of_vowels_that_have_it() -> None:
    assert [unit("AA", s) for s in (False, True)] == ["AA0", "AA1"]
    assert [unit("AW", s) for s in (False, True)] == ["AW", "AW"]
    assert units(TimedPhone(Phone("@", 50.0), 0, 10), "en") == (TimedUnit("AH0", 0, 10),)
    assert "stressed" in features()["IY1"]
    assert "unstressed" in features()["IY0"]


def test_greek_palatals_are_a_velar_with_the_lips_of_y() -> None:
    found = units(TimedPhone(Phone("c", 100.0), 0, 1600), "el")
    assert [u.name for u in found] == ["K", "Y"]
    assert found[0].end == found[1].start == 800


def test_a_phone_that_the_table_does_not_have_is_a_pause() -> None:
    assert units(TimedPhone(Phone("?!", 10.0), 5, 9), "en") == (TimedUnit(SIL, 5, 9),)


def test_a_language_without_a_table_is_unknown() -> None:
    with pytest.raises(UnknownLanguage, match="el, en"):
        units(TimedPhone(Phone("a", 10.0), 0, 1), "xx")


@pytest.mark.parametrize(
    "line", ["a", "a\tAA\t10", "a\tAA IY\t-", "a\tQQ\t-", "a\tAA IY\t120", "a\tAA IY\tx"]
)
def test_a_wrong_line_of_a_table_is_named(line: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(
        module, "read_lines", lambda room, name: iter([(7, line)]) if "units" in name else iter([])
    )
    features()
    module._spellings.cache_clear()
    with pytest.raises(DataError, match=r"units_en\.tsv:7"):
        module._spellings("en")
    module._spellings.cache_clear()


def test_features_tell_closures_from_the_rest() -> None:
    closing = {name for name, of in features().items() if "closure" in of}
    assert closing == {"P", "B", "M"}
