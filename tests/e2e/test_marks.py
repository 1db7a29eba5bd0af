"""`say` with every engine and language: marks against the sound, frames against the marks, lengths."""

from __future__ import annotations

import json
import wave
from itertools import pairwise
from math import ceil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from fapstream.cli import main
from tests.e2e.boundaries import Phone, offsets_ms

TEXTS = {
    "en": "Peter, Ana, top cat, a potato, happy people, I eat apple tart at Attica, otter, up a tree. "
    "Tap. Cook it. A kit. Take it out.",
    "el": "Πάπας, Άννα, πατέρα, τάπα, κακό, έτοιμη η πίτα, αποτέλεσμα, όταν είπα. Τάκη, πάτα εκεί. "
    "Ακτή. Κάπου τόπος.",
}
VOICES = [
    ("us1", "en"),
    ("en1", "en"),
    ("gr1", "el"),
    ("gr2", "el"),
    ("espeak-en", "en"),
    ("espeak-el", "el"),
]
FPS = 25


def say(
    folder: Path, voice: str, text: str
) -> tuple[int, NDArray[np.int16], list[dict[str, Any]], list[list[int]]]:
    """Sample rate, sound, marks, and the FAP file's frames as [number, FAP 3 ...] by the mask's order."""
    paths = {name: folder / f"{voice}.{name}" for name in ("wav", "fap", "marks")}
    arguments = [f"--{name}={path}" for name, path in paths.items()]
    assert main(["say", text, "--voice", voice, *arguments]) == 0
    with wave.open(str(paths["wav"])) as sound:
        rate = sound.getframerate()
        pcm = np.frombuffer(sound.readframes(sound.getnframes()), "<i2")
    marks = json.loads(paths["marks"].read_text(encoding="utf-8"))["marks"]
    rows = paths["fap"].read_text(encoding="ascii").splitlines()
    return rate, pcm, marks, [[int(v) for v in row.split()] for row in rows[1:]]


def phones_of(marks: list[dict[str, Any]]) -> list[Phone]:
    return [(m["text"], m["sample"], m["sample"] + m["duration"]) for m in marks if m["kind"] == "phone"]


def fap(rows: list[list[int]], number: int) -> NDArray[np.int64]:
    """One FAP's values, frame by frame."""
    mask = rows[0]
    column = 1 + sum(mask[: number - 1])
    return np.array([row[column] for row in rows[1::2]])


@pytest.mark.parametrize(("voice", "lang"), VOICES)
def test_marks_agree_with_the_sound(tmp_path: Path, voice: str, lang: str) -> None:
    """On average within 15 ms, and against silence, where the ear is sharpest, within 10."""
    rate, pcm, marks, _ = say(tmp_path, voice, TEXTS[lang])
    found = offsets_ms(pcm, rate, phones_of(marks))
    assert sum(map(len, found.values())) >= 30
    mean_ms = np.abs(np.concatenate(list(found.values()))).mean()
    print(f"{voice}: marks {mean_ms:.1f} ms from the boundaries heard, on average")
    assert mean_ms <= 15
    for kind in ("vowel after silence", "silence after vowel"):
        assert np.abs(found[kind]).mean() <= 10, kind


@pytest.mark.parametrize(("voice", "lang"), VOICES)
def test_lengths_agree(tmp_path: Path, voice: str, lang: str) -> None:
    """Sound, marks and face are equally long, within 1 ms and one frame."""
    rate, pcm, marks, rows = say(tmp_path, voice, TEXTS[lang])
    frames = len(rows) // 2
    assert abs(frames / FPS - len(pcm) / rate) <= 1 / FPS + 0.001
    phones = phones_of(marks)
    assert all(a[2] == b[1] for a, b in pairwise(phones))
    period_s = 160 / 16000
    assert abs(phones[-1][2] - len(pcm)) / rate <= 2 * period_s + 0.001


@pytest.mark.parametrize(("voice", "lang"), VOICES)
def test_face_agrees_with_the_marks(tmp_path: Path, voice: str, lang: str) -> None:
    """Within one frame of the middle of every p between vowels the lips are as near as they get there."""
    rate, _, marks, rows = say(tmp_path, voice, TEXTS[lang])
    apart = -(fap(rows, 4) + fap(rows, 5))
    phones = phones_of(marks)
    checked = 0
    for before, (name, start, end), after in zip(phones, phones[1:], phones[2:], strict=False):
        if name != "p" or "_" in (before[0], after[0]):
            continue
        first, last = (
            round(s * FPS / rate) for s in ((before[1] + before[2]) / 2, (after[1] + after[2]) / 2)
        )
        middle = (start + end) / 2 / rate * FPS
        near = apart[max(first, ceil(middle - 1)) : int(middle + 1) + 1]
        assert near.min() <= apart[first : last + 1].min() + 2
        assert apart[first : last + 1].max() > near.min() + 40
        checked += 1
    assert checked >= 3
