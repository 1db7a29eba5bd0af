"""`fapstream say` aloud: real sound through PyAudio, while the text is still arriving."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fapstream.fap import read_fap
from tests.e2e.sound import RATE, Recorder

WORDS = ["One", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten."]


def test_it_speaks_while_text_arrives(card: dict[str, str]) -> None:
    """Words at 4 a second; the voice is heard before half of them have been written."""
    recorder = Recorder(card)
    time.sleep(0.5)
    command = [sys.executable, "-m", "fapstream", "say", "-", "--play", "--voice", "us1"]
    process = subprocess.Popen(command, stdin=subprocess.PIPE, env={**os.environ, **card})
    assert process.stdin is not None
    written = []
    for word in WORDS:
        process.stdin.write(f"{word} ".encode())
        process.stdin.flush()
        written.append(time.time())
        time.sleep(0.25)
    process.stdin.close()
    assert process.wait(20) == 0
    time.sleep(0.3)
    recording = recorder.stop()
    loud = np.abs(recording.pcm.astype(int)) > 500
    first = recording.at(int(np.argmax(loud)))
    assert first < written[len(WORDS) // 2], "nothing was heard before half of the text had come"
    assert loud.any()
    spoken_s = (len(loud) - np.argmax(loud[::-1]) - np.argmax(loud)) / RATE
    assert 2.0 < spoken_s < 8.0


TALK = "Bring the blue box back by five, and tell me more about it."


def said(folder: Path, name: str, *options: str) -> tuple[NDArray[np.int32], list[tuple[str, float]]]:
    """FAP frames (n, 68), and the words with their times in seconds."""
    fap, marks = folder / f"{name}.fap", folder / f"{name}.json"
    command = [sys.executable, "-m", "fapstream", "say", *options, "--fap", str(fap), "--marks", str(marks)]
    subprocess.run(command, check=True, timeout=60)
    found = json.loads(marks.read_text(encoding="utf-8"))["marks"]
    words = [(m["text"], m["time_ms"] / 1000) for m in found if m["kind"] == "word"]
    frames = read_fap(fap.read_text(encoding="ascii"), str(fap)).frames
    return np.array([frame.values for frame in frames]), words


def test_a_recording_moves_the_mouth_as_the_text_did(tmp_path: Path) -> None:
    """Of a voice only its sound, and the transcript: the same words at the same times, and nearly the same
    lips."""
    wav = tmp_path / "talk.wav"
    text, words = said(tmp_path, "text", TALK, "--voice", "us1", "--wav", str(wav))
    heard, heard_words = said(tmp_path, "heard", "--speech", str(wav), "--transcript", TALK)
    assert [word for word, _ in heard_words] == [word for word, _ in words]
    apart = [abs(a - b) for (_, a), (_, b) in zip(words, heard_words, strict=True)]
    assert np.median(apart) < 0.03
    n = min(len(text), len(heard))
    lips = [-(frames[:n, 3] + frames[:n, 4]) for frames in (text, heard)]
    assert np.corrcoef(*lips)[0, 1] > 0.85


def test_words_that_are_not_said_are_refused(tmp_path: Path) -> None:
    wav = tmp_path / "talk.wav"
    said(tmp_path, "text", TALK, "--voice", "us1", "--wav", str(wav))
    command = [sys.executable, "-m", "fapstream", "say", "--fap", str(tmp_path / "no.fap")]
    wrong = "Quite different things about elephants happened yesterday in the garden"
    done = subprocess.run(
        [*command, "--speech", str(wav), "--transcript", wrong], capture_output=True, text=True, timeout=60
    )
    assert done.returncode
    assert "do not fit" in done.stderr
    assert "Traceback" not in done.stderr
