"""Tokens to spoken words."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fapstream.tts.language import language
from fapstream.tts.normalise import Item
from fapstream.tts.segment import Run, Scanner
from fapstream.tts.spelling import fold_greek, fold_latin


def items(lang: str, text: str) -> list[Item]:
    rooms, scanner = language(lang), Scanner()
    events = [*scanner.feed(text), *scanner.end()]
    runs = [event for event in events if isinstance(event, Run)]
    tokens = [token for run in runs for token in rooms.segmenter.tokens(run.text, run.start)]
    return rooms.normalise.take(tokens, True).items


def read(lang: str, text: str) -> str:
    return " ".join(word for item in items(lang, text) for word in item.spoken)


ENGLISH = """
Hello, world! | hello world
It is 21:45. | it is twenty one forty five
at 9:00 | at nine o'clock
in 1984 and 2026 | in nineteen eighty four and twenty twenty six
1,234,567 people | one million two hundred thirty four thousand five hundred sixty seven people
3.14% of it | three point one four percent of it
a -5 and 10-20 | a minus five and ten to twenty
the 1990s | the nineteen nineties
the 21st | the twenty first
$2.50 or 5€ | two dollars and fifty cents or five euros
$5 million more | five million dollars more
Dr. Smith vs. Mr. Jones | doctor smith versus mister jones
e.g. this, i.e. that | for example this that is that
No. 5. No. | number five no
the U.S. and the B.B.K. | the U S and the B B K
NATO XKCD | nato X K C D
pdf B2B | pdf B two B
AT&T & co | A T and T and co
don't rock'n'roll | don't rock'n'roll
naïve Łódź straße | naive lodz strasse
mail me@there.org | mail me at there dot org
5 km | five kilometers
١٢ ＡＢＣ | twelve abc
привет 你好 😀 word | grinning face word
Γεια σου | γεια σου
"""

GREEK = """
Καλημέρα, κόσμε! | καλημέρα κόσμε
Είναι 21:45. | είναι είκοσι μία και σαράντα πέντε
1.500 € και 3,5% | χίλια πεντακόσια ευρώ και τρία κόμμα πέντε τοις εκατό
3 ώρες, 1 άνδρας, 4 παιδιά | τρεις ώρεσ ένας άνδρασ τέσσερα παιδιά
η 5η, ο 21ος | η πέμπτη ο εικοστός πρώτος
25 Μαρτίου 1821 | είκοσι πέντε μαρτίου χίλια οκτακόσια είκοσι ένα
π.χ. ο κ. Νίκος κ.λπ. | παραδείγματος χάρη ο κύριος νίκοσ και λοιπά
η ΕΕ και οι ΗΠΑ | η έψιλον έψιλον και οι ήπα
το ΒΔ | το Β Δ
Ἐν ἀρχῇ ἦν ὁ λόγος | εν αρχή ήν ο λόγοσ
το laptop μου | το laptop μου
"""


@pytest.mark.parametrize("case", ENGLISH.strip().splitlines())
def test_english(case: str) -> None:
    text, spoken = case.split(" | ")
    assert read("en", text) == spoken


@pytest.mark.parametrize("case", GREEK.strip().splitlines())
def test_greek(case: str) -> None:
    text, spoken = case.split(" | ")
    assert read("el", text) == spoken


@given(st.sampled_from(["en", "el"]), st.text(max_size=200))
def test_offsets_are_true_for_any_text(lang: str, text: str) -> None:
    at = 0
    for item in items(lang, text):
        assert text[item.start : item.end] == item.text
        assert at <= item.start < item.end
        assert item.spoken
        at = item.end


def test_folding() -> None:
    assert fold_latin("Ｃafé’s") == "Cafe's"
    assert fold_greek("Καλημέρας") == fold_greek("Καλημε\u0301ρας") == "καλημέρασ"
    assert fold_greek("ΜΑΪ́ΟΥ") == "μαΐου"
