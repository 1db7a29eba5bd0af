"""Two photos become a head that talks, in both clients; points are found by themselves."""

from __future__ import annotations

import asyncio
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image as Picture
from playwright.async_api import Browser
from skimage import data

from fapstream.adapt import read_points
from fapstream.head.gltf import read_head
from tests.benchmarks.server import server
from tests.e2e.pages import embed
from tests.e2e.test_foreign_head import offsets_while_it_speaks

PHOTOS = Path(__file__).parents[1] / "unit/adapters/photos"
TRUE = PHOTOS / "person601.points.json"


def fapstream(*arguments: str) -> str:
    command = [sys.executable, "-m", "fapstream", *arguments]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with `me.glb`, made from two photos and nothing else, its report and its points."""
    folder = tmp_path_factory.mktemp("adapted")
    photos = (str(PHOTOS / f"person601.{view}.jpg") for view in ("front", "profile"))
    paths = {"-o": "me.glb", "--report": "me.html", "--save-points": "me.json"}
    files = [word for option, name in paths.items() for word in (option, str(folder / name))]
    said = fapstream("adapt", *photos, *files, "--name", "Me")
    assert "points off by" in said
    return folder


def test_found_points_are_near_the_true_ones(made: Path) -> None:
    found, true = read_points((made / "me.json").read_text()), read_points(TRUE.read_text())
    eyes = np.hypot(*np.subtract(true.front.points["3.5"], true.front.points["3.6"]))
    for view in ("front", "profile"):
        seen, wanted = getattr(found, view).points, getattr(true, view).points
        gaps = [np.hypot(*np.subtract(seen[name], wanted[name])) for name in seen if name in wanted]
        assert len(gaps) > 15
        assert np.median(gaps) < 0.04 * eyes
    assert found.facing == true.facing


def test_the_report_shows_it_from_all_sides(made: Path) -> None:
    page = (made / "me.html").read_text()
    for side in ("from in front", "left", "left profile", "right", "right profile", "talking"):
        assert f"<figcaption>{side}</figcaption>" in page


async def test_it_speaks_in_the_browser(
    made: Path, browser: Browser, card: dict[str, str], elsewhere: tuple[Path, str]
) -> None:
    """Lips close where the voice does."""
    page = await browser.new_page(viewport={"width": 320, "height": 320})
    with server("--head", str(made / "me.glb")) as (address, _):
        complaints = await embed(page, elsewhere, address, address)
        await asyncio.sleep(2.0)
        offsets = await offsets_while_it_speaks(page, card)
    assert not complaints
    assert len(offsets) >= 8
    assert np.percentile(np.abs(offsets), 90) <= 50


def test_it_speaks_in_the_viewer(made: Path, tmp_path: Path) -> None:
    fapstream("say", "Papa pop, a lie.", "--wav", str(tmp_path / "a.wav"), "--fap", str(tmp_path / "a.fap"))
    fapstream(
        "view", "--fap", str(tmp_path / "a.fap"), "--wav", str(tmp_path / "a.wav"), "--headless", "--frames",
        str(tmp_path / "out"), "--size", "240x240", "--head", str(made / "me.glb"),
    )  # fmt: skip
    frames = [
        np.asarray(Picture.open(path).convert("RGB"), float)
        for path in sorted((tmp_path / "out").glob("*.png"))
    ]
    assert len(frames) > 20
    mouth = [frame[130:175, 85:155] for frame in frames]
    moved = [np.abs(frame - mouth[0]).mean() for frame in mouth]
    assert max(moved) > 4, "the mouth moves"
    head = read_head((made / "me.glb").read_bytes())
    assert head.name == "Me"


def test_a_real_front_photo_alone_becomes_a_head(tmp_path: Path) -> None:
    """Its depth from symmetry and the average head."""
    photo, out = tmp_path / "astronaut.png", tmp_path / "a.glb"
    Picture.fromarray(data.astronaut()).save(photo)
    fapstream("adapt", str(photo), "-o", str(out))
    head = read_head(out.read_bytes())
    assert 0.035 < head.fapu.mw0 < 0.075
    assert 0.01 < head.fapu.mns0 < 0.03
    nose, mouth = np.array(head.fdp["9.3"]), np.array(head.fdp["8.1"])
    assert 0.002 < nose[2] - mouth[2] < 0.02, "the nose stands out"
    left, right = np.array(head.fdp["3.7"]), np.array(head.fdp["3.12"])
    assert np.abs(left * (-1, 1, 1) - right).max() < 0.006


def test_swapped_photos_are_refused(tmp_path: Path) -> None:
    command = [
        sys.executable, "-m", "fapstream", "adapt", str(PHOTOS / "person601.profile.jpg"),
        str(PHOTOS / "person601.front.jpg"), "-o", str(tmp_path / "me.glb"),
    ]  # fmt: skip
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 1
    assert "fapstream: " in done.stderr
    assert not (tmp_path / "me.glb").exists()
