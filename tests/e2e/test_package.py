"""What travels in the wheel is enough to speak and to serve."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from fapstream.server import packaged_heads

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The package built as a wheel and unpacked, far from the checkout."""
    folder = tmp_path_factory.mktemp("wheel")
    pip = [sys.executable, "-m", "pip", "--disable-pip-version-check", "-q"]
    subprocess.run([*pip, "wheel", "--no-deps", "-w", str(folder), str(ROOT)], check=True)
    [wheel] = folder.glob("fapstream-*.whl")
    subprocess.run([*pip, "install", "--no-deps", "--target", str(folder / "site"), str(wheel)], check=True)
    return folder / "site"


def run(installed: Path, *arguments: str) -> str:
    environment = {**os.environ, "PYTHONPATH": str(installed)}
    command = [sys.executable, "-m", "fapstream", *arguments]
    return subprocess.run(
        command, check=True, capture_output=True, text=True, cwd=installed.parent, env=environment
    ).stdout


def test_the_client_and_a_head_travel_with_it(installed: Path) -> None:
    needed = [
        "server/web/fap-head.js",
        "server/web/index.html",
        "assets/look/head.frag",
        "assets/look/look.json",
    ]
    for name in (*needed, *(f"assets/heads/{head}.glb" for head in packaged_heads())):
        assert (installed / "fapstream" / name).stat().st_size > 500, name
    [information] = installed.glob("fapstream-*.dist-info")
    assert {p.name for p in (information / "licenses").iterdir()} == {"LICENSE", "NOTICE"}


def test_it_speaks_from_there(installed: Path, tmp_path: Path) -> None:
    run(
        installed,
        "say",
        "Hello world.",
        "--wav",
        str(tmp_path / "a.wav"),
        "--marks",
        str(tmp_path / "a.json"),
    )
    assert (tmp_path / "a.wav").stat().st_size > 20_000
    marks = json.loads((tmp_path / "a.json").read_text(encoding="utf-8"))["marks"]
    assert [m["text"] for m in marks if m["kind"] == "word"] == ["Hello", "world"]
