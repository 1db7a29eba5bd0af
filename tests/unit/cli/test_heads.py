"""Heads by name or file, ours or anybody's."""

from __future__ import annotations

from pathlib import Path

import pytest

from fapstream.cli.heads import opened, packaged, servable
from fapstream.errors import DataError, InputError
from fapstream.head.gltf import read_head
from tests.unit.head.avatars import avatar


@pytest.fixture
def foreign(tmp_path: Path) -> Path:
    path = tmp_path / "ann.glb"
    path.write_bytes(avatar(["jawOpen", "mouthPucker"]))
    return path


def test_a_name_is_a_head_in_the_package() -> None:
    assert opened("generic").part("skin")
    name, file = servable("generic")
    assert (name, file.name) == ("generic", "generic.glb")


@pytest.mark.parametrize("find", [opened, servable])
def test_a_name_that_there_is_not(find: object) -> None:
    assert callable(find)
    with pytest.raises(InputError, match=r"no head called 'nobody'; there are .*generic"):
        find("nobody")


@pytest.mark.parametrize("find", [opened, servable])
def test_files_that_are_no_heads(find: object, tmp_path: Path) -> None:
    assert callable(find)
    bad = tmp_path / "bad.glb"
    bad.write_bytes(b"glTF")
    with pytest.raises(DataError, match=r"bad\.glb"):
        find(str(bad))
    with pytest.raises(FileNotFoundError):
        find(str(tmp_path / "none.glb"))


def test_a_foreign_head_says_what_it_lacks(foreign: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert opened(str(foreign)).name == "ann"
    assert capsys.readouterr().err.count("shapes are missing") == 1


def test_what_is_served_is_always_ours(foreign: Path, tmp_path: Path) -> None:
    name, served = servable(str(foreign))
    assert name == "ann"
    assert served != foreign
    assert read_head(served.read_bytes()).fat
    assert servable(str(served)) == ("ann", served)
    mine = tmp_path / "mine.GLB"
    mine.write_bytes(packaged("generic").read_bytes())
    assert servable(str(mine)) == ("mine", mine)


def test_what_a_file_is_called_can_be_in_an_address(tmp_path: Path) -> None:
    for file, name in (
        ("My Avatar (2).glb", "My-Avatar-2"),
        ("κεφάλι.glb", "head"),
        ("a" * 99 + ".glb", "a" * 64),
    ):
        path = tmp_path / file
        path.write_bytes(avatar(["jawOpen", "mouthPucker"]))
        assert servable(str(path))[0] == name
