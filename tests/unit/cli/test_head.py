"""fapstream head: show, import, export."""

from pathlib import Path

import numpy as np
import pytest

from fapstream.cli import main
from fapstream.fap.files import format_fap
from fapstream.fap.sequence import FapSequence
from fapstream.head.gltf import read_head
from tests.unit.head.avatars import avatar


@pytest.fixture
def foreign(tmp_path: Path) -> Path:
    path = tmp_path / "ann.glb"
    path.write_bytes(avatar(["jawOpen", "mouthPucker"]))
    return path


def test_show_a_packaged_head(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["head", "show", "generic"]) == 0
    out = capsys.readouterr().out
    assert "skin" in out
    assert "low-level FAPs that move it: 66 of 66" in out
    assert "MW0 " in out


def test_show_a_foreign_head(foreign: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["head", "show", str(foreign)]) == 0
    captured = capsys.readouterr()
    assert "without effect" in captured.out
    assert captured.err.count("shapes are missing") == 1
    assert "mouthSmileLeft" in captured.err


def test_import_writes_a_head_of_ours(
    foreign: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out.glb"
    assert main(["head", "import", str(foreign), "-o", str(out)]) == 0
    assert read_head(out.read_bytes()).name == "ann"
    assert capsys.readouterr().out == f"{out}: ann, a head of ours, {out.stat().st_size} bytes\n"


def test_export_shapes_and_talk(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    frames = np.zeros((3, 68), np.int32)
    frames[1, [2, 4]] = 300, -390
    fap = tmp_path / "a.fap"
    fap.write_text(format_fap(FapSequence.of_values(frames, "a", 25)), encoding="ascii")
    for options, word in ((["--arkit"], b"jawOpen"), (["--fap", str(fap)], b"raise_b_midlip"),
                          (["--arkit", "--fap", str(fap)], b'"animations"')):  # fmt: skip
        out = tmp_path / "out.glb"
        assert main(["head", "export", "generic", *options, "-o", str(out)]) == 0
        assert word in out.read_bytes()
        assert ("3 frames, 0.12 s" in capsys.readouterr().out) == ("--fap" in options)


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (["show", "nobody"], "no head called 'nobody'"),
        (["show", "/nowhere/x.glb"], "No such file"),
        (["export", "generic", "--keep", "--fap", "x.fap", "-o", "y.glb"], "--keep does not go with --fap"),
    ],
)
def test_what_cannot_be_done_is_said_in_one_line(
    arguments: list[str], reason: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["head", *arguments]) == 1
    error = capsys.readouterr().err
    assert reason in error
    assert error.count("\n") == 1


def test_a_file_that_is_no_head(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "x.glb").write_bytes(b"glTF nothing much")
    assert main(["head", "show", str(tmp_path / "x.glb")]) == 1
    assert "not a GLB file" in capsys.readouterr().err


@pytest.mark.parametrize("name", ["huge.glb", "talk.fap"])
def test_a_file_that_is_too_large_is_not_read(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / name
    with path.open("wb") as file:
        file.truncate(1 << 40)
    head, options = (path, []) if name.endswith(".glb") else ("generic", ["--fap", str(path)])
    assert main(["head", "export", str(head), *options, "-o", str(tmp_path / "x.glb")]) == 1
    assert f"{path}: more than" in capsys.readouterr().err
