"""Sound files of every kind as mono sound, and files that are none or say what is not so."""

from __future__ import annotations

import os
import struct
import sys
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
import soundfile
from numpy.typing import NDArray
from scipy.signal import resample_poly

from fapstream.adapters import sound_file
from fapstream.adapters.sound_file import SpeechUnavailable, read_sound, sound_pieces
from fapstream.errors import ClipError


def sound(rate: int, seconds: float = 0.5, channels: int = 1) -> NDArray[np.float64]:
    """float (n, channels): another tone in every channel."""
    t = np.arange(round(rate * seconds)) / rate
    return np.stack([0.3 * np.sin(2 * np.pi * (200 + 150 * i) * t) for i in range(channels)], axis=1)


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "talk.wav"


@pytest.mark.parametrize("rate", [8000, 11025, 16000, 22050, 44099, 44100, 48000, 192_000])
def test_every_rate_is_what_the_whole_resampled_at_once_is(
    path: Path, rate: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sound_file, "BLOCK", 5000)
    monkeypatch.setattr(sound_file, "PIECE", 1000)
    made = sound(rate, 1.7, 2)
    soundfile.write(path, made, rate, subtype="DOUBLE")
    ratio = Fraction(16000, rate)
    whole = resample_poly(made.mean(axis=1), ratio.numerator, ratio.denominator) * 32768
    read = read_sound(path)
    assert read.dtype == np.int16
    assert len(read) == len(whole)
    np.testing.assert_allclose(read, whole, atol=0.6)
    assert np.array_equal(np.concatenate(list(sound_pieces(path))), read)


@pytest.mark.parametrize("subtype", ["PCM_U8", "PCM_16", "PCM_24", "PCM_32", "FLOAT", "DOUBLE"])
@pytest.mark.parametrize("channels", [1, 2, 6])
def test_every_depth_and_any_channels(path: Path, subtype: str, channels: int) -> None:
    made = sound(16000, channels=channels)
    soundfile.write(path, made, 16000, subtype=subtype)
    atol = 256 if subtype == "PCM_U8" else 1.6
    np.testing.assert_allclose(read_sound(path), made.mean(axis=1) * 32768, atol=atol)


@pytest.mark.parametrize(("form", "subtype"), [("FLAC", "PCM_16"), ("OGG", "VORBIS"), ("RF64", "PCM_16")])
def test_other_files(path: Path, form: str, subtype: str) -> None:
    made = sound(16000)
    soundfile.write(path, made, 16000, format=form, subtype=subtype)
    read = read_sound(path)
    assert len(read) == len(made)
    assert np.corrcoef(read, made[:, 0])[0, 1] > 0.99


def test_sixteen_bits_come_back_as_they_were(path: Path) -> None:
    made = np.random.default_rng(1).integers(-32768, 32768, 5000).astype(np.int16)
    soundfile.write(path, made, 16000)
    assert np.array_equal(read_sound(path), made)


def test_louder_than_full_scale_is_clipped(path: Path) -> None:
    soundfile.write(path, np.array([2.0, -2.0, 1e30]), 16000, subtype="DOUBLE")
    assert read_sound(path).tolist() == [32767, -32768, 32767]


def test_nothing_is_nothing(path: Path) -> None:
    soundfile.write(path, np.zeros(0), 16000)
    assert len(read_sound(path)) == 0


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_no_numbers(path: Path, value: float) -> None:
    made = sound(16000)
    made[7000] = value
    soundfile.write(path, made, 16000, subtype="FLOAT")
    with pytest.raises(ClipError, match="no numbers"):
        read_sound(path)


def test_too_long(path: Path) -> None:
    soundfile.write(path, sound(16000, 2.0), 16000)
    with pytest.raises(ClipError, match=r"talk.wav: lasts 2 s; 1 s are the limit"):
        read_sound(path, limit_s=1.0)
    assert len(read_sound(path, limit_s=2.0)) == 32000


@pytest.mark.parametrize("form", ["WAV", "FLAC"])
@pytest.mark.parametrize("part", [0.02, 0.5, 0.99])
def test_cut_short(path: Path, form: str, part: float) -> None:
    soundfile.write(path, np.random.default_rng(1).normal(0, 0.1, 16000), 16000, format=form)
    data = path.read_bytes()
    path.write_bytes(data[: int(part * len(data))])
    with pytest.raises(ClipError, match=r"cut short|broken|can be read"):
        read_sound(path)


def test_a_stream_that_did_not_know_its_length(path: Path) -> None:
    """What ffmpeg writes into a pipe."""
    soundfile.write(path, sound(16000), 16000)
    data = bytearray(path.read_bytes())
    data[4:8] = data[40:44] = struct.pack("<I", 0xFFFFFFFF)
    path.write_bytes(data)
    assert len(read_sound(path)) == 8000


@pytest.mark.parametrize("told", [(1 << 36) - 1, 0])
def test_a_flac_file_that_lies_about_its_length(path: Path, told: int) -> None:
    soundfile.write(path, sound(16000), 16000, format="FLAC")
    data = bytearray(path.read_bytes())
    fields = int.from_bytes(data[18:26], "big")
    data[18:26] = (fields >> 36 << 36 | told).to_bytes(8, "big")
    path.write_bytes(data)
    with pytest.raises(ClipError, match=r"lasts|does not say"):
        read_sound(path)


@pytest.mark.parametrize("rate", [1, 4000, 200_000, 0x7FFFFFFF])
def test_rates_that_are_none(path: Path, rate: int) -> None:
    soundfile.write(path, sound(16000), 16000)
    data = bytearray(path.read_bytes())
    data[24:28] = struct.pack("<I", rate)
    path.write_bytes(data)
    with pytest.raises(ClipError, match=r"sampled at|no sound file"):
        read_sound(path)


def test_too_many_channels(path: Path) -> None:
    soundfile.write(path, np.zeros((10, 40)), 16000)
    with pytest.raises(ClipError, match="40 channels"):
        read_sound(path)


@pytest.mark.parametrize(
    "data", [b"", b"RIFF", b"hello", b"RIFF\xff\xff\xff\xffWAVE", b"fLaC" + bytes(100), b"OggS" + bytes(99)]
)
def test_no_sound_files(path: Path, data: bytes) -> None:
    path.write_bytes(data)
    with pytest.raises(ClipError, match="no sound file"):
        read_sound(path)


def test_damaged_headers_give_clip_errors(path: Path) -> None:
    """Whatever bytes a header has, it is read or refused, and never with much memory."""
    soundfile.write(path, sound(16000, 0.1, 2), 16000, subtype="FLOAT")
    good = path.read_bytes()
    rng = np.random.default_rng(5)
    for _ in range(300):
        data = bytearray(good)
        for at in rng.integers(0, 60, 3):
            data[at] = rng.integers(256)
        path.write_bytes(data)
        try:
            assert len(read_sound(path)) < 16000 * 3600
        except ClipError:
            continue


def test_no_files(tmp_path: Path) -> None:
    with pytest.raises(OSError, match="nowhere"):
        read_sound(tmp_path / "nowhere.wav")
    with pytest.raises((ClipError, OSError)):
        read_sound(tmp_path)
    if hasattr(os, "mkfifo"):
        os.mkfifo(tmp_path / "pipe")
        with pytest.raises(ClipError, match="no file"):
            read_sound(tmp_path / "pipe")


def test_without_the_package(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "soundfile", None)
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    with pytest.raises(SpeechUnavailable, match=r"fapstream\[speech\]"):
        read_sound(path)
