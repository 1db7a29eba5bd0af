"""Folders of clips: a good one is read, and of every other it is said what is wrong with which file."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fapstream.errors import ClipError
from fapstream.learn.clips import FPS, MOST_FRAMES, Clip, Folder, PhoneHeard, WordHeard
from tests.unit.learn.folders import SILENCE, heard, landmarks_file, rows, write

SAID = heard([SILENCE, ("bin", ("B", "IH", "N")), ("at", ("AE", "T")), SILENCE], 0.125, 0.25)


def tracks() -> dict[str, np.ndarray]:
    """Multiples of 1/64 pixel, which the file keeps; one clip is shorter, and loses the face for a frame."""
    rng = np.random.default_rng(0)
    one, two = (np.rint(64 * rng.uniform(-200, 400, (n, 3, 3))) / 64 for n in (30, 20))
    two[7] = np.nan
    return {"one": one, "two": two}


def good(path: Path, **changed: Any) -> Path:
    """A folder, but for what is changed in landmarks.npz."""
    arrays = landmarks_file(tracks(), (13, 14, 152)) | changed
    arrays = {name: value for name, value in arrays.items() if value is not None}
    phones = {"one": rows(SAID), "two": rows(SAID[1:])}
    return write(path, arrays, phones, {"train": ["one"], "dev": ["two"], "none": []})


def test_a_good_folder_is_read(tmp_path: Path) -> None:
    folder = Folder(good(tmp_path))
    assert (folder.part("train"), folder.part("dev"), folder.part("none")) == (("one",), ("two",), ())
    one, two = folder.clips(("one", "two"))
    for clip, points in zip((one, two), tracks().values(), strict=True):
        np.testing.assert_array_equal(clip.landmarks.points, points)
        assert (clip.landmarks.ids, clip.landmarks.fps) == ((13, 14, 152), FPS)
    assert one.name == "one"
    assert [w.text for w in one.words] == ["<sil>", "bin", "at", "<sil>"]
    assert one.words == SAID
    assert one.words[1].phones[1] == PhoneHeard("IH", 0.5, 0.625)
    assert [w.silent for w in one.words] == [True, False, False, True]


def test_speech_is_from_the_first_word_to_the_last(tmp_path: Path) -> None:
    one, two = Folder(good(tmp_path)).clips(("one", "two"))
    assert one.speech() == two.speech() == (0.375, 1.0)
    with pytest.raises(ClipError, match="one: nothing is said"):
        Clip("one", one.landmarks, heard([SILENCE, SILENCE])).speech()
    with pytest.raises(ClipError, match="nothing is said"):
        Clip("one", one.landmarks, ()).speech()


def test_words_are_read_in_lower_case(tmp_path: Path) -> None:
    path = good(tmp_path)
    (path / "phones.json").write_text(json.dumps({"one": [["BIN", 0, 1, [["B", 0, 1]]]]}), encoding="utf-8")
    (clip,) = Folder(path).clips(("one",))
    assert clip.words == (WordHeard("bin", 0.0, 1.0, (PhoneHeard("B", 0.0, 1.0),)),)


@pytest.mark.parametrize("name", ["landmarks.npz", "phones.json", "split.json"])
@pytest.mark.parametrize(
    "spoil",
    [
        Path.unlink,
        lambda path: path.write_bytes(b""),
        lambda path: path.write_bytes(b"\xff\xfe nonsense"),
        lambda path: path.write_bytes(path.read_bytes()[:-30]),
        lambda path: path.write_bytes(b"[1, 2]"),
        lambda path: path.write_bytes(b"PK\x03\x04"),
        lambda path: (path.unlink(), path.mkdir()),
    ],
)  # fmt: skip
def test_a_file_that_is_not_there_or_not_what_it_should_be_is_named(
    name: str, spoil: Callable[[Path], object], tmp_path: Path
) -> None:
    spoil(good(tmp_path) / name)
    with pytest.raises(ClipError, match=re.escape(str(tmp_path / name))):
        Folder(tmp_path)


def test_a_spoilt_array_is_no_landmarks(tmp_path: Path) -> None:
    path = good(tmp_path) / "landmarks.npz"
    with path.open("wb") as file:
        np.savez_compressed(file, **landmarks_file(tracks(), (13, 14, 152)))
    data = bytearray(path.read_bytes())
    data[200:400] = bytes(200)
    path.write_bytes(data)
    with pytest.raises(ClipError, match=r"landmarks\.npz"):
        Folder(tmp_path)


def test_one_array_is_no_landmarks(tmp_path: Path) -> None:
    path = good(tmp_path) / "landmarks.npz"
    with path.open("wb") as file:
        np.save(file, np.zeros((2, 3)))
    with pytest.raises(ClipError, match=r"landmarks\.npz"):
        Folder(tmp_path)


@pytest.mark.parametrize("absent", ["xyz64", "ids", "names", "nframes"])
def test_a_missing_array_is_named(absent: str, tmp_path: Path) -> None:
    with pytest.raises(ClipError, match=rf"landmarks\.npz.*{absent}"):
        Folder(good(tmp_path, **{absent: None}))


class Trap:
    """What a pickle could do."""

    def __reduce__(self) -> Any:
        return pytest.fail, ("a pickle was opened",)


@pytest.mark.parametrize("name", ["xyz64", "ids", "names", "nframes"])
def test_pickles_are_not_opened(name: str, tmp_path: Path) -> None:
    with pytest.raises(ClipError, match=r"landmarks\.npz"):
        Folder(good(tmp_path, **{name: np.array([Trap()], dtype=object)}))


@pytest.mark.parametrize(
    "changed",
    [
        {"xyz64": np.zeros((2, 30, 3, 2), np.int16)},
        {"xyz64": np.zeros((2, 30, 4, 3), np.int16)},
        {"xyz64": np.zeros((1, 30, 3, 3), np.int16)},
        {"xyz64": np.zeros((2, 9), np.int16)},
        {"xyz64": np.zeros((2, 30, 3, 3))},
        {"xyz64": np.full((2, 30, 3, 3), "1")},
        {"ids": np.zeros(4, int)},
        {"ids": np.array(["a", "b", "c"])},
        {"ids": np.array([13, 14, 13])},
        {"ids": np.array(13)},
        {"names": np.array(["one", "two", "three"])},
        {"names": np.array("one")},
        {"nframes": np.array([30])},
        {"nframes": np.array([30, 31])},
        {"nframes": np.array([30, -1])},
        {"nframes": np.array([30.5, 20])},
        {"nframes": np.array([[30, 20]])},
    ],
    ids=lambda changed: "-".join(f"{k}-{v.dtype.kind}{v.shape}" for k, v in changed.items()),
)
def test_arrays_that_do_not_fit_one_another_are_no_landmarks(changed: dict[str, Any], tmp_path: Path) -> None:
    with pytest.raises(ClipError, match=re.escape(str(tmp_path / "landmarks.npz"))):
        Folder(good(tmp_path, **changed))


@pytest.mark.parametrize("part", [5, "one", [1], [["one"]], None, {"one": 1}])
def test_a_part_is_a_list_of_names(part: Any, tmp_path: Path) -> None:
    path = good(tmp_path)
    (path / "split.json").write_text(json.dumps({"train": part}), encoding="utf-8")
    with pytest.raises(ClipError, match=r"split\.json.*'train'"):
        Folder(path)


def test_a_part_that_is_not_there_is_told_with_those_that_are(tmp_path: Path) -> None:
    with pytest.raises(ClipError, match=r"split\.json: no part 'test'; there are train, dev, none"):
        Folder(good(tmp_path)).part("test")


def test_an_unknown_clip_is_named(tmp_path: Path) -> None:
    with pytest.raises(ClipError, match="no landmarks of the clip 'three'"):
        next(Folder(good(tmp_path)).clips(("three",)))


def test_a_clip_without_frames_has_no_face_and_one_too_long_is_refused(tmp_path: Path) -> None:
    (clip,) = Folder(good(tmp_path, nframes=np.array([0, 20]))).clips(("one",))
    assert clip.landmarks.points.shape == (0, 3, 3)
    long = np.zeros((2, MOST_FRAMES + 1, 3, 3), np.int16)
    folder = Folder(good(tmp_path, xyz64=long, nframes=np.array([MOST_FRAMES + 1, MOST_FRAMES])))
    with pytest.raises(ClipError, match=f"one: {MOST_FRAMES + 1} frames"):
        next(folder.clips(("one",)))
    assert len(next(folder.clips(("two",))).landmarks.points) == MOST_FRAMES


NAN, INFINITE = float("nan"), float("inf")


@pytest.mark.parametrize(
    "said",
    [
        None, 5, "bin", [], [[]], [["bin", 0, 1]], [["bin", 0, 1, None]], [["bin", 0, 1, [["B", 0]]]],
        [["bin", 0, 1, [["B", "now", 1]]]], [["bin", None, 1, [["B", 0, 1]]]], [["bin", 0, 1, []]],
        [["bin", 0, 1, [["B", 0, 1], ["IH", 0.5, 1]]]], [["bin", 0, 1, [["B", 0, -1]]]],
        [["bin", 0, 1, [["B", 0, 1]]], ["at", 0, 1, [["AE", 0, 1]]]],
        [["bin", 0, 1, [["B", NAN, 1]]]], [["bin", 0, 1, [["B", 0, INFINITE]]]],
        [["bin", NAN, 1, [["B", 0, 1]]]], [["bin", 0, INFINITE, [["B", 0, 1]]]],
        [["bin", 5, 1, [["B", 0, 1]]]], [["bin", 0, 1, [["B", -0.5, 1]]]],
        [["bin", 0, 1, [["B", 0, 1]]], ["at", 1, 1, []], ["it", 2, 1, [["T", 2, 1]]]],
        [["bin", 0, 1, [["XX", 0, 1]]]], [["bin", 0, 1, [["IH1", 0, 1]]]], [["bin", 0, 1, [["", 0, 1]]]],
        [["bin", 0, 1, [["b", 0, 1]]]],
    ],
    ids=str,
)  # fmt: skip
def test_phones_that_are_none_and_times_that_do_not_ascend_are_told_of_their_clip(
    said: Any, tmp_path: Path
) -> None:
    path = good(tmp_path)
    (path / "phones.json").write_text(json.dumps({"one": said}), encoding="utf-8")
    with pytest.raises(ClipError, match=r"phones\.json: 'one'"):
        list(Folder(path).clips(("one",)))


def test_a_clip_that_nobody_listened_to_is_named(tmp_path: Path) -> None:
    path = good(tmp_path)
    (path / "phones.json").write_text("{}", encoding="utf-8")
    with pytest.raises(ClipError, match=r"phones\.json: 'two'"):
        list(Folder(path).clips(("two",)))


def test_rounded_times_may_run_into_one_another_by_nothing(tmp_path: Path) -> None:
    path = good(tmp_path)
    said = [["bin", 0.1, 0.3, [["B", 0.1, 0.2], ["IH", 0.3 - 1e-9, 0.1]]]]
    (path / "phones.json").write_text(json.dumps({"one": said}), encoding="utf-8")
    assert len(next(Folder(path).clips(("one",))).words[0].phones) == 2
