"""Picture k is the face at k / fps, and the sound lies beside it."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from PIL import Image as Picture

from fapstream.head.mesh import Material
from fapstream.records import FapFrame
from fapstream.viewer.canvas import Studio
from fapstream.viewer.clip import Clip, read_wav
from fapstream.viewer.film import faces, film, picture_count
from tests.unit.viewer.heads import square, squares

RATE = 16_000


def clip(n: int = 10, sound: int = 0) -> Clip:
    """FAP 5 counts up by ten each frame of 40 ms."""
    frames = tuple(FapFrame(640 * k, np.eye(68, dtype=np.int32)[4] * 10 * k) for k in range(n))
    return Clip(RATE, np.full(sound, 7, np.int16), frames, 640 * n)


@pytest.mark.parametrize(
    ("fps", "count", "values"), [(25, 10, [0, 10, 20]), (50, 20, [0, 5, 10]), (12.5, 5, [0, 20, 40])]
)
def test_the_face_of_a_picture_is_that_of_its_time(fps: float, count: int, values: list[float]) -> None:
    found = [face[4] for face in faces(clip(), fps)]
    assert len(found) == picture_count(clip(), fps) == count
    assert found[:3] == pytest.approx(values)


def test_after_the_last_frame_it_eases_to_neutral() -> None:
    found = [face[4] for face in faces(clip(10, sound=640 * 20), 25)]
    assert len(found) == 20
    assert found[9] == 90
    assert all(a >= b for a, b in pairwise(found[9:]))
    assert found[-1] == 0


def test_pictures_and_sound_are_written(tmp_path: Path) -> None:
    head = squares(square("shirt", 0.0, 0.1, Material("white", roughness=1.0)))
    studio = Studio(head, (32, 48))
    assert film(clip(4, sound=100), studio, tmp_path / "new" / "folder", 25) == 4
    names = sorted(path.name for path in (tmp_path / "new" / "folder").iterdir())
    assert names == ["00000.png", "00001.png", "00002.png", "00003.png", "audio.wav"]
    rate, pcm = read_wav(tmp_path / "new" / "folder" / "audio.wav")
    assert (rate, len(pcm), pcm[0]) == (RATE, 4 * 640, 7)
    with Picture.open(tmp_path / "new" / "folder" / "00002.png") as picture:
        assert (picture.size, picture.mode) == ((32, 48), "RGB")
        face = np.zeros(68)
        face[4] = 20
        assert np.array_equal(np.asarray(picture), studio.picture(face)[..., :3])
    studio.close()
