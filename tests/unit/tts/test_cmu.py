"""Phones of the CMU Pronouncing Dictionary and ours."""

from __future__ import annotations

import pytest

from fapstream.tts import phone_set
from fapstream.tts.cmu import VOWELS, Phones, from_cmu, stressed, to_cmu

RECORD: tuple[Phones, ...] = (("R", "EH1", "K", "ER0", "D"), ("R", "IH0", "K", "AO1", "R", "D"))


@pytest.mark.parametrize("name", sorted(phone_set("en")))
def test_every_phone_there_and_back(name: str) -> None:
    if phone_set("en")[name].kind != "vowel":
        assert from_cmu(to_cmu(name)) == (name, 0)
        return
    assert to_cmu(name + "1")[:-1] in VOWELS
    for stress in (0, 1, 2):
        back = {"@": "@" if not stress else "V", "V": "V" if stress else "@"}.get(name, name)
        assert from_cmu(to_cmu(f"{name}{stress}")) == (back, stress)


@pytest.mark.parametrize("unknown", ["Q", "", "ii1"])
def test_no_phones(unknown: str) -> None:
    with pytest.raises((KeyError, IndexError)):
        to_cmu(unknown)


@pytest.mark.parametrize(
    ("plain", "readings", "expected"),
    [
        ("R EH K ER D", RECORD, "R EH1 K ER0 D"),
        ("R IH K AO R D", RECORD, "R IH0 K AO1 R D"),
        ("R AH K AO R D", RECORD, "R AH0 K AO1 R D"),
        ("DH IY", [("DH", "AH0")], "DH IY0"),
        ("F AE M AH L IY", [("F", "AE1", "M", "L", "IY0")], "F AE1 M AH0 L IY0"),
        ("F AE M L IY", [("F", "AE1", "M", "AH0", "L", "IY0")], "F AE1 M L IY0"),
        ("S", [("S",)], "S"),
        ("AA B", [], "AA0 B"),
    ],
)
def test_stress_comes_from_the_reading_that_is_most_alike(
    plain: str, readings: list[Phones], expected: str
) -> None:
    assert " ".join(stressed(plain.split(), readings)) == expected
