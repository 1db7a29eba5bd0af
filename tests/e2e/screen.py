"""A screen made of software, and a camera before it that knows when it took each picture."""

from __future__ import annotations

import subprocess
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
from numpy.typing import NDArray
from PIL import ImageGrab

SIZE = (160, 160)
"""Of what is filmed, from the upper left corner, where a window without a manager goes."""
PAUSE_S = 0.02


@contextmanager
def screen() -> Iterator[str]:
    """The DISPLAY of an X server that draws into memory."""
    command = ["Xvfb", "-displayfd", "1", "-screen", "0", "160x160x24", "-nolisten", "tcp", "-noreset"]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    assert process.stdout is not None
    try:
        number = process.stdout.readline().strip()
        if not number:
            raise RuntimeError("Xvfb did not start")
        yield f":{number}"
    finally:
        process.terminate()
        process.wait(5)


class Camera:
    """Films the screen. Pictures are uint8 (height, width, 3); times are wall clock, seconds."""

    def __init__(self, display: str) -> None:
        self._display = display
        self._times: list[float] = []
        self._pictures: list[NDArray[np.uint8]] = []
        self._running = True
        self._thread = threading.Thread(target=self._film, daemon=True)
        self._thread.start()

    def stop(self) -> tuple[NDArray[np.float64], NDArray[np.uint8]]:
        """End; times (n,) and pictures (n, height, width, 3)."""
        self._running = False
        self._thread.join(5)
        return np.array(self._times), np.array(self._pictures)

    def _film(self) -> None:
        while self._running:
            before = time.time()
            picture = ImageGrab.grab((0, 0, *SIZE), xdisplay=self._display)
            self._times.append((before + time.time()) / 2)
            self._pictures.append(np.asarray(picture.convert("RGB")))
            time.sleep(PAUSE_S)
