"""A talk as pictures in files: picture k is the face at k / fps seconds, whatever time it takes to draw."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fapstream.stream import Heard, TurnBuffer
from fapstream.viewer.canvas import Studio
from fapstream.viewer.clip import Clip, write_wav
from fapstream.viewer.face import FaceMixer
from fapstream.viewer.graphics import needed

SOUND = "audio.wav"
PICTURE = "{:05d}.png"

Told = Callable[[int, int], None]


def film(clip: Clip, studio: Studio, folder: Path, fps: float, told: Told = lambda done, total: None) -> int:
    """Write 00000.png and so on, and audio.wav, into `folder`; returns how many pictures. Raises OSError.

    `told` hears after each picture how many there are by now, and will be.
    """
    pictures = needed("PIL.Image")
    folder.mkdir(parents=True, exist_ok=True)
    write_wav(folder / SOUND, clip.sample_rate, clip.sound)
    total = picture_count(clip, fps)
    for k, face in enumerate(faces(clip, fps)):
        image = pictures.fromarray(np.ascontiguousarray(studio.picture(face)[..., :3]))
        image.save(folder / PICTURE.format(k), compress_level=3)
        told(k + 1, total)
    return total


def faces(clip: Clip, fps: float) -> Iterator[NDArray[np.float64]]:
    """The face (68,) of each picture; after the last FAP frame it eases to neutral."""
    buffer, mixer = TurnBuffer(clip.sample_rate), FaceMixer(None)
    buffer.push(clip.packet(1))
    for k in range(picture_count(clip, fps)):
        sample = k * clip.sample_rate / fps
        shown = buffer if sample < clip.faces_end else None
        yield mixer.show(shown, Heard(1, sample, "playing"), k / fps)


def picture_count(clip: Clip, fps: float) -> int:
    """Pictures that begin before the talk is over."""
    return int(np.ceil(clip.samples * fps / clip.sample_rate - 1e-6))
