"""Four-part rules."""

from __future__ import annotations

import pytest

from fapstream.errors import DataError
from fapstream.tts.rules import RuleSet


def rewrite(rules: list[tuple[str, str, str, str]], text: str, **classes: str) -> list[str]:
    table = RuleSet([(i, r) for i, r in enumerate(rules, 1)], classes)
    return [phone for match in table.apply(text) for phone in match.output]


def test_the_first_rule_that_matches_wins() -> None:
    assert rewrite([("", "a b", "", "X"), ("", "a", "", "Y"), ("", "b", "", "Z")], "abba") == ["X", "Z", "Y"]


def test_contexts_on_both_sides() -> None:
    rules = [("x", "a", "y", "1"), ("", "a", "", "2")]
    assert rewrite(rules, "xay") == ["1"]
    assert rewrite(rules, "xaz") == ["2"]
    assert rewrite(rules, "ay") == ["2"]


def test_classes_negation_repetition_and_boundaries() -> None:
    rules = [("#", "s", "C* V", "first"), ("", "s", "!V", "dull"), ("", "s", "", "else")]
    classes = {"V": "a e", "C": "t r"}
    assert rewrite(rules, " stra ", **classes) == ["first"]
    assert rewrite(rules, " as ", **classes) == ["dull"]
    assert rewrite(rules, " asa ", **classes) == ["else"]


def test_wide_alternatives_on_the_right() -> None:
    assert rewrite([("", "k", "F", "c"), ("", "k", "", "k")], "kaika", F="ai e") == ["c", "k"]


def test_matches_tell_where_they_were() -> None:
    table = RuleSet([(1, ("", "b c", "", "X Y"))], {})
    assert [(m.start, m.end, m.output) for m in table.apply("abcabc")] == [
        (1, 3, ("X", "Y")),
        (4, 6, ("X", "Y")),
    ]


def test_a_rule_that_cannot_be_compiled_names_its_line() -> None:
    with pytest.raises(DataError) as caught:
        RuleSet([(7, ("C*", "a", "", "x"))], {"C": "t"}, path="some.tsv")
    assert (caught.value.path, caught.value.line) == ("some.tsv", 7)


def test_no_rules_match_nothing() -> None:
    assert list(RuleSet([], {}).apply("abc")) == []


def test_the_greek_table_reads() -> None:
    assert list(RuleSet.read("el/rules.tsv").apply(" ου "))[1].output == ("u",)


def test_left_alternatives_of_several_widths() -> None:
    rules = [("# STEM C", "i", "a", "Y"), ("", "i", "", "i")]
    classes = {"STEM": "p pal", "C": "l n"}
    assert rewrite(rules, " plia ", **classes) == ["Y"]
    assert rewrite(rules, " palnia ", **classes) == ["Y"]
    assert rewrite(rules, " alia ", **classes) == ["i"]


def test_which_words_a_rule_looks_past() -> None:
    rules = [
        ("# t o", "n", "# p", "m"),
        ("", "s", "C* # z", "z"),
        ("", "a", "b #", "A"),
        ("x #", "p", "", "b"),
    ]
    table = RuleSet(enumerate(rules, 1), {"C": "t k"})
    assert [word for word in ("ton", "on", "as", "astk", "asb", "ab", "p") if table.looks_past(word)] == [
        "ton",
        "as",
        "astk",
    ]


def test_a_context_in_the_word_before_does_not_hide_a_look_past_the_end() -> None:
    assert RuleSet([(1, ("x # t o", "n", "# p", "m"))], {}).looks_past("ton")
