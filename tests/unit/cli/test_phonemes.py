"""`fapstream phonemes`: what is printed for people and for programs."""

from __future__ import annotations

import io
import json
from typing import Any

import pytest

from fapstream.cli import main
from fapstream.tts import phone_set


def printed(capsys: pytest.CaptureFixture[str], *argv: str) -> str:
    assert main(["phonemes", *argv]) == 0
    return capsys.readouterr().out


def check(described: dict[str, Any], lang: str) -> None:
    """The documented shape."""
    assert described.keys() == {"text", "words"}
    for word in described["words"]:
        assert word.keys() == {"word", "spoken", "path", "syllables", "phones"}
        assert word["phones"]
        for phone in word["phones"]:
            assert phone.keys() == {"phone", "duration_ms", "f0_hz", "stress", "pitch"}
            assert phone["phone"] in phone_set(lang)
            assert 10 < phone["duration_ms"] < 1000
            assert phone["f0_hz"] is None or 40 < phone["f0_hz"] < 500


def test_json(capsys: pytest.CaptureFixture[str]) -> None:
    out = json.loads(printed(capsys, "--json", "Hello world, it is 21:45."))
    check(out, "en")
    assert out["text"] == "Hello world, it is 21:45."
    assert [w["word"] for w in out["words"]] == ["Hello", "world", "it", "is", "21:45"]
    assert [p["phone"] for p in out["words"][1]["phones"]] == ["w", "r=", "l", "d"]


def test_greek(capsys: pytest.CaptureFixture[str]) -> None:
    raw = printed(capsys, "--lang", "el", "--json", "Καλημέρα.")
    assert "Καλημέρα" in raw, "not escaped"
    out = json.loads(raw)
    check(out, "el")
    assert "".join(p["phone"] for p in out["words"][0]["phones"]) == "kalimera"


def test_for_people(capsys: pytest.CaptureFixture[str]) -> None:
    lines = printed(capsys, "Hello world.").splitlines()
    assert [line.split()[0].split(":")[0] for line in lines] == ["Hello", "h", "'", "world", "'"]
    assert lines[4].split()[1].startswith("w:")


def test_lines_from_stdin(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(
        "sys.stdin", io.TextIOWrapper(io.BytesIO(b"One two.\r\n\nThree.\nlast \xff without an end"))
    )
    rows = [json.loads(line) for line in printed(capsys, "-").splitlines()]
    assert [r["text"] for r in rows] == ["One two.", "", "Three.", "last \ufffd without an end"]
    assert [[w["word"] for w in r["words"]] for r in rows] == [
        ["One", "two"], [], ["Three"], ["last", "without", "an", "end"],
    ]  # fmt: skip
    for row in rows:
        check(row, "en")


def test_a_line_does_not_depend_on_the_one_before(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sys.stdin", io.TextIOWrapper(io.BytesIO(b"Same words.\n" * 3)))
    assert len(set(printed(capsys, "-").splitlines())) == 1


def length(out: str) -> float:
    return sum(float(p["duration_ms"]) for w in json.loads(out)["words"] for p in w["phones"])


def test_rate_and_voice(capsys: pytest.CaptureFixture[str]) -> None:
    normal = printed(capsys, "--json", "Hello world.")
    assert length(printed(capsys, "--json", "--rate", "2", "Hello world.")) < 0.75 * length(normal)
    low = json.loads(printed(capsys, "--json", "--voice", "us2", "Hello world."))
    high = json.loads(normal)
    assert low["words"][0]["phones"][-1]["f0_hz"] < high["words"][0]["phones"][-1]["f0_hz"]


@pytest.mark.parametrize("text", ["", "   ", "...", "🙂", "\x00\x07", "\udcff", "\udcff word"])
def test_any_text(text: str, capsys: pytest.CaptureFixture[str]) -> None:
    check(json.loads(printed(capsys, "--json", text)), "en")


def test_an_unknown_voice_exits_1(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["phonemes", "--voice", "nobody", "a"]) == 1
    assert capsys.readouterr().err.startswith("fapstream: no voice called 'nobody'; there are: ")


@pytest.mark.parametrize(
    "argv", [["--lang", "xx", "a"], ["--rate", "fast", "a"], [], ["--rate", "nan", "a"], ["--rate", "0", "a"]]
)
def test_a_wrong_call_exits_2(argv: list[str]) -> None:
    try:
        status: object = main(["phonemes", *argv])
    except SystemExit as e:
        status = e.code
    assert status == 2
