"""What is taken from the command line, and what is not."""

from __future__ import annotations

import argparse

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fapstream.cli.arguments import between, port, rate, unicode_text


@pytest.mark.parametrize(("text", "value"), [("1", 1.0), ("0.25", 0.25), ("4", 4.0), ("1e0", 1.0)])
def test_rates(text: str, value: float) -> None:
    assert rate(text) == value


@pytest.mark.parametrize("text", ["0", "-1", "0.24", "4.01", "nan", "inf", "fast", ""])
def test_what_is_no_rate(text: str) -> None:
    with pytest.raises(argparse.ArgumentTypeError, match=r"is not from 0\.25 to 4"):
        rate(text)


@pytest.mark.parametrize("text", ["-1", "65536", "1.5", "x", "", "²"])
def test_what_is_no_port(text: str) -> None:
    assert (port("0"), port("65535")) == (0, 65535)
    with pytest.raises(argparse.ArgumentTypeError, match="whole number from 0 to 65535"):
        port(text)


def test_limits_belong_to_the_range() -> None:
    fps = between(1, 240)
    assert (fps("1"), fps("240"), fps("29.97")) == (1, 240, 29.97)
    for text in ("0.99", "240.1", "x"):
        with pytest.raises(argparse.ArgumentTypeError, match="is not from 1 to 240"):
            fps(text)


@given(st.text())
def test_text_is_left_alone_unless_it_cannot_be_written(text: str) -> None:
    assert unicode_text(text) == text


@given(st.text(st.characters(categories=["Cs", "Ll"])))
def test_surrogates_become_replacement_characters(text: str) -> None:
    made = unicode_text(text)
    made.encode("utf-8")
    if not any("\ud800" <= c <= "\udbff" for c in text):
        assert made == "".join("\ufffd" if "\udc00" <= c <= "\udfff" else c for c in text)
