"""fapstream head: show, import, export."""

from pathlib import Path

import numpy as np
import pytest

from fapstream.cli import main
from fapstream.cli.head import servable
from fapstream.errors import DataError
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


def test_import_writes_a_head_of_ours(foreign: Path, tmp_path: Path) -> None:
    out = tmp_path / "out.glb"
    assert main(["head", "import", str(foreign), "-o", str(out)]) == 0
    assert read_head(out.read_bytes()).name == "ann"


def test_export_shapes_and_talk(tmp_path: Path) -> None:
    frames = np.zeros((3, 68), np.int32)
    frames[1, [2, 4]] = 300, -390
    fap = tmp_path / "a.fap"
    fap.write_text(format_fap(FapSequence.of_values(frames, "a", 25)), encoding="ascii")
    for options, word in ((["--arkit"], b"jawOpen"), (["--fap", str(fap)], b"raise_b_midlip"),
                          (["--arkit", "--fap", str(fap)], b'"animations"')):  # fmt: skip
        out = tmp_path / "out.glb"
        assert main(["head", "export", "generic", *options, "-o", str(out)]) == 0
        assert word in out.read_bytes()


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


def test_what_is_served_is_always_ours(foreign: Path, tmp_path: Path) -> None:
    served = servable(foreign)
    assert served != foreign
    assert served.stem == "ann"
    assert read_head(served.read_bytes()).fat
    assert servable(served) == served
    (tmp_path / "bad.glb").write_bytes(b"")
    with pytest.raises(DataError):
        servable(tmp_path / "bad.glb")
