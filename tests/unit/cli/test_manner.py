"""The options that say how a text is read."""

from __future__ import annotations

import argparse
from pathlib import Path

import pytest

from fapstream.cli import main
from fapstream.cli.manner import add_manner, look_ahead, manner
from fapstream.errors import DataError, InputError
from fapstream.tts import DEFAULT_LOOK_AHEAD, PHRASE, Manner


def asked(*argv: str, complete: bool = True) -> Manner:
    parser = argparse.ArgumentParser()
    add_manner(parser)
    return manner(parser.parse_args(argv), "en", complete)


def test_what_is_not_asked_for_stays() -> None:
    assert asked() == Manner(look_ahead=PHRASE)
    assert asked(complete=False) == Manner(look_ahead=DEFAULT_LOOK_AHEAD)


def test_options() -> None:
    found = asked("--rate=2", "--pitch=1.5", "--volume=0", "--look-ahead=0")
    assert (found.rate, found.pitch, found.volume, found.look_ahead) == (2.0, 1.5, 0.0, 0)
    assert look_ahead("phrase") == PHRASE
    for bad in ("-1", "many", "9999999"):
        with pytest.raises(argparse.ArgumentTypeError):
            look_ahead(bad)


def test_files(tmp_path: Path) -> None:
    lexicon, profile = tmp_path / "l.tsv", tmp_path / "p.toml"
    lexicon.write_text("﻿Bjork\tb j O1 r k\n", encoding="utf-8")
    profile.write_text("rate = 1.5\nvolume = 0.5\n")
    found = asked(f"--lexicon={lexicon}", f"--profile={profile}", "--volume=2")
    assert found.lexicon == {"bjork": (("b", "j", "O1", "r", "k"),)}
    assert (found.rate, found.volume) == (1.5, 2.0), "an option comes before the profile"


def test_bad_files_are_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    bad = tmp_path / "bad.tsv"
    bad.write_bytes(b"\xff\xfe")
    with pytest.raises(InputError, match="not UTF-8"):
        asked(f"--lexicon={bad}")
    bad.write_text("word phones\n")
    with pytest.raises(DataError, match=r"bad\.tsv:1"):
        asked(f"--lexicon={bad}")
    assert main(["phonemes", f"--lexicon={tmp_path}/none.tsv", "a"]) == 1
    assert "none.tsv" in capsys.readouterr().err


def test_it_is_heard(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    lexicon = tmp_path / "l.tsv"
    lexicon.write_text("Hello\tt E1 s t\n")
    assert main(["phonemes", f"--lexicon={lexicon}", "Hello"]) == 0
    shown = capsys.readouterr().out
    assert "user" in shown
    assert "' t:" in shown
