"""`fapstream view`: which options go together, what is written, what goes wrong."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image as Picture

from fapstream.cli import main, view
from fapstream.fap.files import format_fap
from fapstream.fap.sequence import FapSequence
from fapstream.records import FapFrame
from fapstream.viewer.clip import read_wav, write_wav


@pytest.fixture
def talk(tmp_path: Path) -> list[str]:
    """A third of a second: the jaw opens."""
    frames = []
    for k in range(8):
        values = np.zeros(68, np.int32)
        values[2], values[4], values[9], values[10] = 60 * k, -45 * k, -40 * k, -40 * k
        frames.append(FapFrame(0, values))
    fap, wav = tmp_path / "t.fap", tmp_path / "t.wav"
    fap.write_text(format_fap(FapSequence.of(frames, "t", 25)), encoding="ascii")
    write_wav(wav, 16_000, np.full(5000, 3, np.int16))
    return ["--fap", str(fap), "--wav", str(wav)]


def test_pictures_of_a_file(talk: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "out"
    assert main(["view", *talk, "--headless", "--frames", str(out), "--size", "96x64"]) == 0
    assert capsys.readouterr().out == f"8 pictures and audio.wav in {out}\n"
    pictures = [np.asarray(Picture.open(path), float) for path in sorted(out.glob("*.png"))]
    assert [p.shape for p in pictures] == [(64, 96, 3)] * 8
    changes = [np.abs(p - pictures[0]).mean() for p in pictures]
    assert changes == sorted(changes)
    assert changes[-1] > 0.05
    assert len(read_wav(out / "audio.wav")[1]) == 5120
    (out / "00008.png").touch()
    assert main(["view", *talk, "--headless", "--frames", str(out), "--size", "96x64"]) == 0
    assert "still has pictures of a longer talk, from 00008.png on" in capsys.readouterr().err


def test_oddities_of_a_file_are_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    fap, out = tmp_path / "odd.fap", tmp_path / "out"
    fap.write_text(" ".join(["0"] * 68) + "\n0\n")
    assert main(["view", "--fap", str(fap), "--headless", "--frames", str(out), "--size", "32x32"]) == 0
    assert f"{fap}: line 1: no header" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--wav", "a.wav"], "--wav is the sound of a FAP file"),
        (["--fap", "a.fap", "--say", "Hello"], "not both"),
        (["ws://x/ws", "--fap", "a.fap"], "not both"),
        (["--fap", "a.fap", "--headless"], "--frames DIR go together"),
        (["--fap", "a.fap", "--frames", "d"], "--frames DIR go together"),
        (["--headless", "--frames", "d"], "what is to be seen"),
        (["--fap", "a.fap", "--headless", "--frames", "d", "--trace", "t"], "for a window"),
        (["--fap", "missing.fap", "--headless", "--frames", "d"], "missing.fap"),
        (["--fap", "a.fap", "--headless", "--frames", "d", "--head", "nobody"], "no head called 'nobody'"),
        (["--fap", "a.fap", "--headless", "--frames", "d", "--head", "missing.glb"], "missing.glb"),
    ],
)
def test_wrong_calls_are_told_in_one_line(
    options: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["view", *options]) == 1
    error = capsys.readouterr().err
    assert message in error
    assert error.count("\n") == 1


def test_a_broken_file_is_named_with_its_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    fap = tmp_path / "bad.fap"
    fap.write_text("2.1 a 25 1\n1 0 x\n")
    assert main(["view", "--fap", str(fap), "--headless", "--frames", str(tmp_path / "o")]) == 1
    assert "bad.fap:2" in capsys.readouterr().err
    assert not (tmp_path / "o").exists()


@pytest.mark.parametrize("text", ["", "512", "0x0", "8x512", "9999x9999", "512x512x3", "-5x512"])
def test_sizes_that_are_none(text: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as caught:
        main(["view", f"--size={text}"])
    assert caught.value.code == 2
    assert "no size" in capsys.readouterr().err


def test_a_size() -> None:
    assert view.size("640x480") == (640, 480)


@pytest.mark.parametrize("text", ["0", "nan", "inf", "-25", "fast", "1000"])
def test_rates_that_are_none(text: str) -> None:
    with pytest.raises(SystemExit):
        main(["view", f"--fps={text}"])


def test_help_shows_examples(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["view", "--help"])
    text = capsys.readouterr().out
    assert "ffmpeg" in text
    assert "Escape" in text
