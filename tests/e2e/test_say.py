"""`fapstream say` aloud: real sound through PyAudio, while the text is still arriving."""

from __future__ import annotations

import os
import subprocess
import sys
import time

import numpy as np

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
