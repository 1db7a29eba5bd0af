"""`fapstream convert`: animation between .fap and .fba, feature points out of heads."""

from __future__ import annotations

import io
import re
import sys
from importlib import resources
from pathlib import Path

import numpy as np
import pytest

from fapstream.adapters.pool import installed
from fapstream.cli import main
from fapstream.cli.convert import bound_points
from fapstream.fap import FapSequence, faps, format_fap, read_animation, read_fap
from fapstream.fap.fdp import read_fdp, read_xfdp
from fapstream.head.gltf import read_head
from fapstream.tts.voices import voice
from tests.unit.head.avatars import avatar

HEAD = resources.files("fapstream").joinpath("assets", "heads", "generic.glb")
STEPS = np.array([f.quant for f in faps()])
WILD = Path(__file__).parents[1] / "fap" / "files"


@pytest.fixture
def walk(tmp_path: Path) -> Path:
    """A .fap file of 50 frames of a mouth."""
    rng = np.random.default_rng(1)
    values = np.zeros((50, 68), np.int32)
    values[:, [2, 3, 4, 50, 51, 47]] = np.cumsum(rng.integers(-30, 31, (50, 6)), axis=0)
    path = tmp_path / "walk.fap"
    path.write_text(format_fap(FapSequence.of_values(values, "walk", 25)), encoding="ascii")
    return path


def load(path: Path) -> FapSequence:
    return read_animation(path.read_bytes(), str(path))


@pytest.mark.parametrize("quant", [1, 3, 10])
def test_to_fba_and_back(walk: Path, quant: int, capsys: pytest.CaptureFixture[str]) -> None:
    fba, back = walk.with_suffix(".fba"), walk.with_name("back.fap")
    assert main(["convert", str(walk), str(fba), f"--fap-quant={quant}"]) == 0
    out, err = capsys.readouterr()
    size = fba.stat().st_size
    assert re.search(
        f"50 frames, 2.00 s at 25 frames a second, {size} bytes, {8 * size / 2000:.2f} kbit/s", out
    )
    assert not err
    assert main(["convert", str(fba), str(back)]) == 0
    assert (np.abs(load(back).low_level() - load(walk).low_level()) <= STEPS * quant / 2).all()
    assert (load(back).name, load(back).fps) == ("walk", 25)


def test_i_frames(walk: Path) -> None:
    fba = walk.with_suffix(".fba")
    assert main(["convert", str(walk), str(fba), "--intra-every=10"]) == 0
    assert fba.read_bytes().count(b"\0\0\1\xbb") == 4


def test_fap_to_fap(walk: Path) -> None:
    out = walk.with_name("out.fap")
    assert main(["convert", str(walk), str(out), "--version=2.0"]) == 0
    assert out.read_text(encoding="ascii") == walk.read_text(encoding="ascii").replace("2.1", "2.0", 1)


def test_a_mask(walk: Path) -> None:
    out = walk.with_name("out.fap")
    assert main(["convert", str(walk), str(out), "--mask=3-5,48"]) == 0
    kept, before = load(out).low_level(), load(walk).low_level()
    assert np.flatnonzero(kept.any(axis=0)).tolist() == [2, 3, 4, 47]
    assert np.array_equal(kept[:, [2, 3, 4, 47]], before[:, [2, 3, 4, 47]])


@pytest.mark.parametrize("suffix", [".fap", ".fba"])
def test_low_level_only(tmp_path: Path, suffix: str) -> None:
    source = WILD / "high_level.fap"
    high, low = tmp_path / f"high{suffix}", tmp_path / f"low{suffix}"
    assert main(["convert", str(source), str(high), "--fap-quant=1"]) == 0
    assert main(["convert", str(source), str(low), "--fap-quant=1", "--low-level-only"]) == 0
    assert any(row.viseme for row in load(high).frames)
    assert not any(row.viseme or row.expression for row in load(low).frames)
    slack = 0 if suffix == ".fap" else STEPS / 2
    for path in (high, low):
        assert (np.abs(load(path).low_level() - load(source).low_level()) <= slack).all()


def test_oddities_go_to_stderr(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    source = WILD / "no_header_no_newline.fap"
    assert main(["convert", str(source), str(tmp_path / "out.fap"), "--fps=12.5"]) == 0
    out, err = capsys.readouterr()
    assert "3 frames, 0.24 s at 12.5 frames a second" in out
    assert f"{source}: line 1: no header" in err
    assert "12.5 frames a second, no whole number" in err


def test_pipes(
    walk: Path, monkeypatch: pytest.MonkeyPatch, capsysbinary: pytest.CaptureFixture[bytes]
) -> None:
    fba = walk.with_suffix(".fba")
    assert main(["convert", str(walk), str(fba), "--fap-quant=1"]) == 0
    capsysbinary.readouterr()
    for source in (walk, fba):
        monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(source.read_bytes())))
        assert main(["convert", "-", "-"]) == 0
        out, err = capsysbinary.readouterr()
        found = read_fap(out.decode("ascii"), "stdout")
        assert (np.abs(found.low_level() - load(walk).low_level()) <= STEPS / 2).all()
        assert b"50 frames" in err


@pytest.mark.parametrize(
    ("name", "data", "message"),
    [
        ("bad.fap", b"hello\n", "bad.fap:1: 'hello' is neither a header"),
        ("bad.fba", b"hello\n", "bad.fba, byte 0 bit 0: no FBA object start code"),
        ("bad.fba", b"\0\0\1\xba\xff", "bad.fba, byte 4 bit 1: body animation is not supported"),
        ("bad.fdp", b"\xff", "bad.fdp is no UTF-8 text"),
        ("bad.glb", b"glTF", "bad.glb"),
        ("none.fap", None, "none.fap"),
        ("what.txt", b"", "no kind of file that can be converted"),
    ],
)
def test_bad_files(
    name: str, data: bytes | None, message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    if data is not None:
        (tmp_path / name).write_bytes(data)
    target = "out.fdp" if name.endswith(("fdp", "glb")) else "out.fap"
    assert main(["convert", str(tmp_path / name), str(tmp_path / target)]) == 1
    assert message in capsys.readouterr().err
    assert not (tmp_path / target).exists()


@pytest.mark.parametrize(
    "arguments",
    [
        ["--mask=0"],
        ["--mask=69"],
        ["--mask=5-3"],
        ["--mask=x"],
        ["--mask="],
        ["--fps=0"],
        ["--fps=x"],
        ["--version=3"],
    ],
)
def test_a_wrong_call_exits_2(arguments: list[str], walk: Path) -> None:
    with pytest.raises(SystemExit) as caught:
        main(["convert", str(walk), "x.fap", *arguments])
    assert caught.value.code == 2


@pytest.mark.parametrize(
    ("source", "target"),
    [("a.fap", "a.fdp"), ("a.fba", "a.glb"), ("a.fdp", "a.xfdp"), ("a.xfdp", "a.fdp"), ("a.fdp", "a.fap")],
)
def test_what_does_not_go(
    source: str, target: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / source).write_bytes(b"")
    assert main(["convert", str(tmp_path / source), str(tmp_path / target)]) == 1
    assert capsys.readouterr().err.startswith("fapstream: ")
    assert not (tmp_path / target).exists()


def test_a_fap_quant_that_cannot_be(walk: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["convert", str(walk), str(walk.with_suffix(".fba")), "--fap-quant=32"]) == 1
    assert "not from 1 to 31" in capsys.readouterr().err


def test_feature_points_of_a_head(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    head = read_head(HEAD.read_bytes(), "generic")
    out, again = tmp_path / "head.fdp", tmp_path / "again.fdp"
    with resources.as_file(HEAD) as path:
        assert main(["convert", str(path), str(out)]) == 0
    points = read_fdp(out.read_text(encoding="utf-8"), "out")
    assert points.keys() == head.fdp.keys()
    assert all(np.allclose(points[name], head.fdp[name], atol=1e-6) for name in points)
    assert f"{len(points)} feature points" in capsys.readouterr().out
    assert main(["convert", str(out), str(again)]) == 0
    assert out.read_bytes() == again.read_bytes()


def test_a_head_bound_as_xfdp(tmp_path: Path) -> None:
    head = read_head(HEAD.read_bytes(), "generic")
    out, again = tmp_path / "head.xfdp", tmp_path / "again.xfdp"
    with resources.as_file(HEAD) as path:
        assert main(["convert", str(path), str(out)]) == 0
    found = read_xfdp(out.read_text(encoding="utf-8"), "out")
    assert found == bound_points(head, "generic.glb")
    assert found.fapu["MW0"] == pytest.approx(head.fapu.mw0)
    chin = next(p for p in found.points if p.name == "2.1")
    part = head.part(chin.mesh)
    away = np.linalg.norm(part.positions[chin.index] - np.array(head.fdp["2.1"]))
    assert away == pytest.approx(np.linalg.norm(part.positions - np.array(head.fdp["2.1"]), axis=1).min())
    assert away < 0.005
    assert {i.fap for i in chin.influences} == {f.fap for f in faps() if "2.1" in f.fdp}
    assert {i.weight for i in chin.influences} == {0.5}
    assert len(chin.indices) > 20
    assert main(["convert", str(out), str(again)]) == 0
    assert out.read_bytes() == again.read_bytes()
    called_fdp = tmp_path / "xml.fdp"
    out.rename(called_fdp)
    assert main(["convert", str(called_fdp), str(out)]) == 0
    assert out.read_bytes() == again.read_bytes()


SPEECH = "3-22,44-46,51-60"
"""Jaw, lips, tongue and lids."""

MINUTE = " ".join(
    [
        "The quick brown fox jumps over the lazy dog, and then it sleeps for a while.",
        "Tomorrow will be sunny, with a light wind from the north in the afternoon.",
        "Please remember to bring the papers that we talked about on Friday; we will need all of them.",
        "Could you tell me where the station is? It is five minutes from here, behind the old market.",
    ]
    * 3
)


@pytest.mark.skipif(not installed(voice("us1")), reason="not installed")
def test_speech_takes_less_than_3_kbit_s(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    fap, fba, wav = (tmp_path / f"a.{x}" for x in ("fap", "fba", "wav"))
    assert main(["say", MINUTE, "--voice=us1", f"--fap={fap}", f"--wav={wav}"]) == 0
    assert main(["convert", str(fap), str(fba), "--fap-quant=3", f"--mask={SPEECH}"]) == 0
    told = re.search(r"([\d.]+) s at 25 frames a second, \d+ bytes, ([\d.]+) kbit/s", capsys.readouterr().out)
    assert told
    assert float(told[1]) > 30
    assert 1 < float(told[2]) < 3


def test_heads_by_name_and_of_others(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out, foreign = tmp_path / "out.fdp", tmp_path / "ann.vrm"
    assert main(["convert", "generic", str(out)]) == 0
    assert len(read_fdp(out.read_text(), "out")) == 84
    foreign.write_bytes(avatar(["jawOpen", "mouthPucker"]))
    assert main(["convert", str(foreign), str(out)]) == 0
    assert 4 < len(read_fdp(out.read_text(), "out")) < 84
    assert "shapes are missing" in capsys.readouterr().err
    assert main(["convert", "generic", str(tmp_path / "out.fap")]) == 1
    assert "generic is a head" in capsys.readouterr().err
