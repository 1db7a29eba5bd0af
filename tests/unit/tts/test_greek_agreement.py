"""What Greek numbers agree with."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fapstream.tts.greek_agreement import Agreement, Form, plain

AGREEMENT = Agreement()


@pytest.mark.parametrize(
    ("before", "after", "single", "form"),
    [
        ("", "ώρες", False, "f"),
        ("", "άνδρας", True, "m"),
        ("", "παιδιά", False, ""),
        ("των", "ανδρών", False, "g"),
        ("τους", "στρατιώτες", False, "ma"),
        ("στις", "", False, "f"),
        ("οι", "κάτοικοι", False, "m"),
        ("το", "πολλές", False, ""),
        ("έστειλε", "στρατιώτες", False, "ma"),
        ("με", "ετών", False, "g"),
        ("αξίας", "ευρώ", False, "g"),
        ("της", "ώρας", True, "fg"),
    ],
)
def test_forms_by_the_words_around(before: str, after: str, single: bool, form: str) -> None:
    assert AGREEMENT.form(before, after, single).key == form


def test_names() -> None:
    assert AGREEMENT.name("γεώργιος") == Form("m", "", "s")
    assert AGREEMENT.name("γεωργίου") == Form("m", "g", "s")
    assert AGREEMENT.name("παρασκευής") == Form("f", "g", "s")
    assert AGREEMENT.name("θεοδώρων") == Form("m", "g", "p")
    assert AGREEMENT.name("τραπέζι") is None


def test_declension() -> None:
    assert AGREEMENT.declined(["χιλιόμετρα", "την", "ώρα"], "g") == ["χιλιομέτρων", "την", "ώρα"]
    assert AGREEMENT.declined(["κύριος"], "v") == ["κύριε"]
    assert AGREEMENT.declined(["κυρία"], "v") == ["κυρία"]
    assert AGREEMENT.declined(["κυρία"], "") == ["κυρία"]


def test_plain() -> None:
    assert plain("Άνθρωπος") == "ανθρωποσ"


@given(st.text(max_size=20), st.text(max_size=20), st.booleans(), st.sampled_from(["", "n", "m", "f"]))
def test_any_words_give_a_form_that_has_an_ending(before: str, after: str, single: bool, gender: str) -> None:
    form = AGREEMENT.form(before, after, single, gender)
    assert form.key in ("", "m", "ma", "f", "fg", "g")
    assert form.ordinal
    name = AGREEMENT.name(after)
    assert name is None or name.ordinal
