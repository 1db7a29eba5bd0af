"""`fapstream view`: a spoken sentence as pictures, and in a window with sound, measured from outside."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image as Picture
from PIL import ImageGrab
from scipy.signal import correlate, resample_poly

from fapstream.head.gltf import read_head
from fapstream.head.mesh import Head
from fapstream.server import packaged_heads
from fapstream.viewer.camera import lens
from fapstream.viewer.clip import Clip, read_clip, read_wav, write_wav
from fapstream.viewer.look import load_look
from fapstream.viewer.renderer import Renderer
from fapstream.viewer.window import Window, dragged
from tests.e2e.screen import SIZE, Camera, screen
from tests.e2e.sound import RATE, Recorder

TEXT = "Papa pop, papa pop papa. Papa papa pop, papa pop."
FPS = 25
CLOSED = {"p", "b", "m"}
OPEN = {"A", "A:", "a", "AE", "@", "O", "{", "Q", "V"}
FRAME_MS = 40
MOST_LEAD_MS = 100
ENVIRONMENT = {**os.environ, "OPENBLAS_NUM_THREADS": "1"}


def fapstream(*arguments: str, **environment: str) -> subprocess.Popen[str]:
    command = [sys.executable, "-m", "fapstream", *arguments]
    return subprocess.Popen(command, env={**ENVIRONMENT, **environment}, stderr=subprocess.PIPE, text=True)


@pytest.fixture(scope="module")
def talk(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the sentence as a.wav (48 kHz, so that nothing has to be resampled), a.fap and a.json."""
    folder = tmp_path_factory.mktemp("talk")
    options = [f"--{x}={folder / f'a.{x}'}" for x in ("wav", "fap")] + [f"--marks={folder / 'a.json'}"]
    assert fapstream("say", TEXT, "--voice", "us1", "--rate", "0.7", *options).wait(60) == 0
    rate, pcm = read_wav(folder / "a.wav")
    loud = np.clip(np.rint(resample_poly(pcm.astype(float), RATE, rate)), -32768, 32767)
    write_wav(folder / "a.wav", RATE, loud.astype(np.int16))
    return folder


def generic() -> Head:
    return read_head(packaged_heads()["generic"].read_bytes(), "generic")


def mouth_box(head: Head, size: tuple[int, int]) -> tuple[slice, slice]:
    """Rows and columns of a portrait that show the lips, open or closed."""
    camera = lens(head.camera, load_look().fov, size[0] / size[1])
    x, y, z = head.mouth.center
    width, height = head.mouth.size
    corners = np.array([[x - width / 2, y + height, z, 1], [x + width / 2, y - 1.5 * height, z, 1]])
    clip = corners @ (camera.projection @ camera.view).T
    ndc = clip[:, :2] / clip[:, 3:]
    columns = np.rint((ndc[:, 0] + 1) / 2 * size[0]).astype(int)
    rows = np.rint((1 - ndc[:, 1]) / 2 * size[1]).astype(int)
    return slice(*rows), slice(*columns)


def opening(picture: NDArray[np.uint8], box: tuple[slice, slice]) -> int:
    """Pixels in the mouth's box that are no skin and no lips, but teeth or darkness: hardly redder than
    blue."""
    red, _, blue = np.moveaxis(picture[box][..., :3].astype(int), -1, 0)
    return int((red - blue < 35).sum())


def test_a_spoken_sentence_becomes_pictures(talk: Path, tmp_path: Path) -> None:
    """One picture for 40 ms, a head on each, open in vowels and closed in p."""
    started = fapstream(
        "view",
        f"--fap={talk / 'a.fap'}",
        f"--wav={talk / 'a.wav'}",
        "--headless",
        f"--frames={tmp_path}",
        "--size=256x256",
    )
    assert started.wait(300) == 0
    rate, pcm = read_wav(tmp_path / "audio.wav")
    pictures = [np.asarray(Picture.open(path)) for path in sorted(tmp_path.glob("*.png"))]
    assert len(pictures) == np.ceil(len(pcm) * FPS / rate)
    box = mouth_box(generic(), (256, 256))
    gaps = np.array([opening(picture, box) for picture in pictures])
    described = json.loads((talk / "a.json").read_text())
    times = {kind: [] for kind in ("closed", "open")}  # type: dict[str, list[float]]
    for mark in described["marks"]:
        if mark["kind"] == "phone":
            middle = (mark["time_ms"] + mark["duration_ms"] / 2) / 1000
            if mark["text"] in CLOSED:
                times["closed"].append(middle)
            elif mark["text"] in OPEN:
                times["open"].append(middle)
    frames = np.arange(len(gaps)) / FPS
    closed, opened = (np.interp(times[kind], frames, gaps) for kind in ("closed", "open"))
    print(f"teeth and dark pixels: closed {np.median(closed):.0f}, open {np.median(opened):.0f}")
    assert len(closed) >= 12
    assert len(opened) >= 8
    assert np.median(opened) > 3 * np.median(closed)
    assert np.mean(closed < np.median(opened) / 3) > 0.9
    for picture in pictures:
        hair, chin, corner = picture[20:60, 128], picture[150, 100:150], picture[:10, :10]
        assert np.ptp(hair.astype(int), axis=0).max() > 30
        assert abs(chin.mean(axis=0) - corner.mean(axis=(0, 1))).max() > 20


@pytest.fixture(scope="module")
def display() -> Iterator[str]:
    with screen() as found:
        yield found


def test_the_window_is_on_the_voice(talk: Path, card: dict[str, str], display: str, tmp_path: Path) -> None:
    """Filmed from the screen and recorded from the card: the sound is the file's, the lips are on it."""
    recorder = Recorder(card)
    camera = Camera(display)
    time.sleep(0.5)
    files = [f"--fap={talk / 'a.fap'}", f"--wav={talk / 'a.wav'}", f"--trace={tmp_path / 'trace'}"]
    started = fapstream("view", *files, "--size=160x160", DISPLAY=display, **card)
    assert started.wait(60) == 0, started.stderr and started.stderr.read()
    time.sleep(0.3)
    times, pictures = camera.stop()
    recording = recorder.stop()
    _, pcm = read_wav(talk / "a.wav")
    start = beginning(recording.pcm, pcm)
    same = (recording.pcm[start + 480 : start + len(pcm)] == pcm[480 : len(recording.pcm) - start]).mean()

    spoken = (recording.at(start) <= times) & (times <= recording.at(start + len(pcm)))
    gaps = np.array([opening(picture, mouth_box(generic(), SIZE)) for picture in pictures[spoken]], float)
    lag, likeness = lateness(
        times[spoken] - recording.at(start), gaps, read_clip(talk / "a.fap", talk / "a.wav")
    )

    trace = [json.loads(line) for line in (tmp_path / "trace").read_text().splitlines()]
    playing = [row for row in trace if row["face"] is not None]
    slaved = np.array([row["face"] - row["heard"] for row in playing]) * 1000 / RATE
    really = (np.array([row["at"] for row in playing]) - recording.at(start)) * RATE
    clock = (np.array([row["heard"] for row in playing]) - really) * 1000 / RATE
    interval = 1000 * np.median(np.diff([row["at"] for row in playing]))
    print(
        f"{len(playing)} pictures, one in {interval:.0f} ms; face minus heard {np.median(slaved):+.1f} "
        f"ms; clock minus the recording's {np.median(clock):+.1f} ms; lips minus voice {lag:+.0f} ms "
        f"(likeness {likeness:.2f}); {100 * same:.1f} % of the samples as in the file"
    )
    assert same > 0.95
    assert abs(np.median(slaved)) < FRAME_MS / 2 + max(0, interval - MOST_LEAD_MS)
    assert abs(np.median(clock)) < 25
    assert likeness > 0.6
    assert abs(lag) < FRAME_MS + interval / 2, "a picture stands for its interval"


def lateness(times: NDArray[np.float64], gaps: NDArray[np.float64], clip: Clip) -> tuple[float, float]:
    """By how many ms openings seen are later than the file's lips, and how like they are (correlation)."""
    starts = np.array([frame.sample for frame in clip.frames]) / clip.sample_rate
    lips = np.array([-frame.values[[3, 4]].sum() for frame in clip.frames], float)
    lags = np.arange(-400, 401, 5)
    scores = [np.corrcoef(gaps, np.interp(times - lag / 1000, starts, lips))[0, 1] for lag in lags]
    return float(lags[np.argmax(scores)]), float(max(scores))


def beginning(recorded: NDArray[np.int16], pcm: NDArray[np.int16]) -> int:
    """The sample of the recording at which the sound begins: where the two agree best."""
    scores = correlate(recorded.astype(float), pcm.astype(float), "valid", "fft")
    return int(np.argmax(scores))


def test_without_a_card_it_warns_once_and_shows_all_the_same(talk: Path, display: str) -> None:
    camera = Camera(display)
    nobody = {"PULSE_SERVER": "unix:/nowhere", "DISPLAY": display}
    started = fapstream("view", f"--fap={talk / 'a.fap'}", "--size=160x160", **nobody)
    _, complaints = started.communicate(timeout=60)
    _, pictures = camera.stop()
    assert started.returncode == 0
    assert "no sound device can be opened" in complaints
    assert complaints.count("\n") == 1
    box = mouth_box(generic(), SIZE)
    assert np.ptp([opening(picture, box) for picture in pictures if picture.any()]) > 25


def test_a_servers_turn_becomes_pictures(address: str, tmp_path: Path) -> None:
    """What the server says in Greek, as pictures, with its sound; the mouth moves."""
    options = ["--say", "Παπάκια.", "--lang", "el", "--headless", f"--frames={tmp_path}", "--size=128x128"]
    started = fapstream("view", f"ws://{address}/ws", *options, "--fps=12.5")
    _, complaints = started.communicate(timeout=120)
    assert started.returncode == 0, complaints
    rate, pcm = read_wav(tmp_path / "audio.wav")
    assert np.abs(pcm).max() > 2000
    pictures = [np.asarray(Picture.open(path)) for path in sorted(tmp_path.glob("*.png"))]
    assert len(pictures) == np.ceil(len(pcm) * 12.5 / rate)
    gaps = [opening(picture, mouth_box(generic(), (128, 128))) for picture in pictures]
    assert np.ptp(gaps) > 10


def test_a_window_of_another_size_is_filled_and_obeys(display: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Resized, turned by the pointer, reset by R and closed by Escape; what is seen is the screen's."""
    monkeypatch.setenv("DISPLAY", display)
    window = Window("test", (96, 96))
    renderer = Renderer(window.context, generic(), window.software)
    renderer.deform(np.zeros(68))

    def seen(width: int, height: int) -> NDArray[np.int64]:
        for _ in range(3):
            window.show(renderer)
        return np.asarray(ImageGrab.grab((0, 0, width, height), xdisplay=display).convert("RGB")).astype(int)

    small = seen(96, 96)
    window.glfw.set_window_size(window.handle, 160, 120)
    large = seen(160, 120)
    assert abs(large[:30, -30:].mean() - small[:15, -15:].mean()) < 12, "the backdrop reaches the new corner"
    window.view = dragged(window.view, -60, 0)
    turned = seen(160, 120)
    assert np.abs(turned - large).mean() > 2
    press(window, "R")
    assert np.abs(seen(160, 120) - large).mean() < 0.5
    assert not window.closed
    press(window, "ESCAPE")
    assert window.closed
    window.close()


def press(window: Window, key: str) -> None:
    """What glfw calls when a key goes down."""
    glfw = window.glfw
    callback = glfw.set_key_callback(window.handle, None)
    callback(window.handle, getattr(glfw, f"KEY_{key}"), 0, glfw.PRESS, 0)
    glfw.set_key_callback(window.handle, callback)
