"""Folders of clips, and what is wrong with them."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from fapstream.errors import ClipError
from fapstream.learn.clips import Folder
from tests.unit.learn.talker import IDS, folder


@pytest.fixture
def here(tmp_path: Path) -> Path:
    return folder(tmp_path, 3, 1)


def test_a_folder_is_read(here: Path) -> None:
    clips = Folder(here)
    assert (len(clips.part("train")), len(clips.part("dev"))) == (3, 1)
    one, *_ = clips.clips(clips.part("train"))
    assert one.landmarks.ids == IDS
    assert np.isfinite(one.landmarks.points).all()
    assert one.words[0].silent
    first, last = one.speech()
    assert (first, last) == (one.words[1].start, one.words[-2].end)
    assert one.words[1].phones[0].start == first


def test_a_lost_face_is_no_number(here: Path) -> None:
    file = dict(np.load(here / "landmarks.npz"))
    file["xyz64"][0, 4] = -32768
    np.savez(here / "landmarks.npz", **file)
    (clip,) = Folder(here).clips(("clip00",))
    assert np.isnan(clip.landmarks.points[4]).all()
    assert np.isfinite(clip.landmarks.points[5]).all()


def changed(path: Path, change: Callable[[dict[str, object]], object]) -> None:
    file = json.loads(path.read_text(encoding="utf-8"))
    change(file)
    path.write_text(json.dumps(file), encoding="utf-8")


@pytest.mark.parametrize("name", ["split.json", "phones.json", "landmarks.npz"])
@pytest.mark.parametrize("content", [None, b"", b"[1, 2", b"\x80nonsense", b"[]"])
def test_a_file_that_is_none_is_named(here: Path, name: str, content: bytes | None) -> None:
    path = here / name
    if content is None:
        path.unlink()
    else:
        path.write_bytes(content)
    with pytest.raises(ClipError, match=name.replace(".", r"\.")):
        Folder(here)


def test_pickles_are_not_opened(here: Path) -> None:
    np.savez(here / "landmarks.npz", xyz64=np.array([{}], object), ids=IDS, names=["a"], nframes=[1])
    with pytest.raises(ClipError, match=r"landmarks\.npz"):
        Folder(here)


def test_a_part_that_there_is_not_is_said_with_those_that_there_are(here: Path) -> None:
    with pytest.raises(ClipError, match="train, dev"):
        Folder(here).part("test")


@pytest.mark.parametrize(
    "rows",
    [
        None,
        [],
        "words",
        [["a", 0.0, 0.1]],
        [["a", 0.0, "x", [["B", 0.0, 0.1]]]],
        [["a", 0.0, 0.1, [["B", 0.2, 0.1], ["IY", 0.0, 0.1]]]],
    ],
)
def test_words_without_times_are_refused_with_the_clips_name(here: Path, rows: object) -> None:
    changed(here / "phones.json", lambda file: file.update(clip01=rows))
    with pytest.raises(ClipError, match="clip01"):
        list(Folder(here).clips(("clip01",)))


def test_a_clip_without_landmarks_or_speech_is_said(here: Path) -> None:
    with pytest.raises(ClipError, match="clip99"):
        list(Folder(here).clips(("clip99",)))
    changed(here / "phones.json", lambda file: file.update(clip01=[["<sil>", 0.0, 1.0, [["SIL", 0.0, 1.0]]]]))
    (clip,) = Folder(here).clips(("clip01",))
    with pytest.raises(ClipError, match="nothing is said"):
        clip.speech()
