"""The measures for Greek pronunciations."""

from __future__ import annotations

from pathlib import Path

import pytest

from fapstream.tts.tables import phone_set
from tests.benchmarks import greek_list
from tests.benchmarks.greek_list import Phones, from_ipa, merged, read_list, score


def phones(text: str) -> Phones:
    return tuple(text.split())


def test_the_table_is_of_our_phones() -> None:
    ours = {phone for found in greek_list.IPA.values() for phone in found}
    assert ours == set(phone_set("el")) - {"_"}


def test_reading_a_list(tmp_path: Path) -> None:
    path = tmp_path / "list.tsv"
    path.write_text("έτσι\te t s i\nμια\tm i a\nμια\tm ɲ a\n", encoding="utf-8")
    assert read_list(path) == {"έτσι": [phones("e ts i")], "μια": [phones("m i a"), phones("m J a")]}
    with pytest.raises(KeyError):
        from_ipa(["q"])


@pytest.mark.parametrize(
    ("text", "same"),
    [
        ("p e D j a", "p e D i a"),
        ("m a t C a", "m a t i a"),
        ("L a", "l i a"),
        ("k a L i", "k a l i"),
        ("c a n i", "k i a n i"),
        ("c e r o", "k e r o"),
        ("a N gj e l o s", "a n g e l o s"),
        ("j a", "G i a"),
        ("l a m b a", "l a m b a"),
    ],
)
def test_merging(text: str, same: str) -> None:
    assert merged(phones(text)) == phones(same)


@pytest.mark.parametrize(
    ("ours", "listed", "kind", "right"),
    [
        ("e c i", "e c i", None, (1, 1, 1)),
        ("e k i", "e c i", "palatal only", (0, 1, 1)),
        ("p e D i a", "p e D j a", "synizesis only", (0, 1, 1)),
        ("l a b a", "l a m b a", "nasal before a voiced stop only", (0, 0, 1)),
        ("k o s m o s", "k o z m o s", "s or z only", (0, 0, 0)),
        ("k a l a", "k a l o", "other", (0, 0, 0)),
    ],
)
def test_scoring(ours: str, listed: str, kind: str | None, right: tuple[int, int, int]) -> None:
    result = score({"w": phones(ours)}, {"w": [phones("x"), phones(listed)]})
    assert (result.strict, result.merged, result.nasal) == right
    assert [name for name, words in result.differences.items() if words] == ([kind] if kind else [])


def test_our_side_is_without_stress() -> None:
    assert greek_list.ours(["Καλημέρα"]) == {"Καλημέρα": phones("k a l i m e r a")}
