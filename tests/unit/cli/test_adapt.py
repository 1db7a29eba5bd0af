"""fapstream adapt."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image as Picture

from fapstream.adapt import METHODS, read_points
from fapstream.cli import adapt, main
from fapstream.head.gltf import read_head
from tests.unit.adapt.painted import PERSON, photographed, plain
from tests.unit.adapt.persons import FOLDER


@pytest.fixture
def photos(tmp_path: Path) -> list[str]:
    paths = []
    for view, photo in photographed(plain).items():
        path = tmp_path / f"{view}.png"
        Picture.fromarray(photo.pixels).save(path)
        paths.append(str(path))
    return paths


POINTS = str(FOLDER / f"{PERSON}.points.json")


def test_two_photos_and_their_points_become_a_head_and_a_report(
    photos: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out, page, saved = tmp_path / "me.glb", tmp_path / "r.html", tmp_path / "p.json"
    arguments = [
        "adapt",
        *photos,
        "--points",
        POINTS,
        "-o",
        str(out),
        "--report",
        str(page),
        "--save-points",
        str(saved),
    ]
    assert main(arguments) == 0
    captured = capsys.readouterr()
    assert f"{out}: me, {out.stat().st_size} bytes; points off by front " in captured.out
    head = read_head(out.read_bytes())
    assert head.name == "me"
    text = page.read_text()
    assert text.count("<img") >= 3
    assert ("talking" in text) or "without views" in captured.err
    points = read_points(saved.read_text())
    assert points.front.size == (500, 500), "at the size of the photos"


def test_one_photo_will_do(photos: list[str], tmp_path: Path) -> None:
    out = tmp_path / "me.glb"
    assert (
        main(["adapt", photos[0], "--points", POINTS, "-o", str(out), "--method", "fpd", "--name", "One"])
        == 0
    )
    assert read_head(out.read_bytes()).name == "One"


def test_methods_are_those_that_there_are() -> None:
    assert set(adapt.METHODS) == set(METHODS)
    assert adapt.METHODS[0] == next(iter(METHODS))


@pytest.mark.parametrize(
    ("spoil", "says"),
    [
        ("photo", "no picture"),
        ("points", "not JSON"),
        ("shape", "points are of a photo of 1000 x 1000"),
        ("missing", "No such file"),
    ],
)
def test_what_is_wrong_is_said(
    spoil: str, says: str, photos: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    points = tmp_path / "p.json"
    points.write_text((FOLDER / f"{PERSON}.points.json").read_text())
    if spoil == "photo":
        Path(photos[0]).write_bytes(b"GIF89a nothing")
    elif spoil == "points":
        points.write_text("{")
    elif spoil == "shape":
        Picture.fromarray(np.zeros((400, 300, 3), np.uint8)).save(photos[0])
    else:
        photos[1] = str(tmp_path / "nobody.jpg")
    assert main(["adapt", *photos, "--points", str(points), "-o", str(tmp_path / "me.glb")]) == 1
    assert says in capsys.readouterr().err
    assert not (tmp_path / "me.glb").exists()


def test_without_the_extra_it_says_what_to_install(
    photos: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in [name for name in sys.modules if name.startswith("fapstream.adapt")]:
        if not name.startswith("fapstream.adapters"):
            monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "scipy", None)
    monkeypatch.setitem(sys.modules, "scipy.linalg", None)
    assert main(["adapt", *photos, "--points", POINTS, "-o", str(tmp_path / "me.glb")]) == 1
    assert "fapstream[adapt]" in capsys.readouterr().err
