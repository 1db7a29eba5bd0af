"""Talks from files: any frame rate, any sound format, sound and face of different length."""

from __future__ import annotations

import wave
from pathlib import Path

import numpy as np
import pytest

from fapstream.errors import DataError
from fapstream.fap.files import format_fap
from fapstream.fap.sequence import FapSequence
from fapstream.records import FapFrame
from fapstream.viewer.clip import SILENT_RATE, read_clip, read_wav, write_wav

TONE = np.rint(9000 * np.sin(np.arange(4000) / 9)).astype(np.int16)


def fap_file(folder: Path, n: int, fps: int) -> Path:
    frames = [FapFrame(0, np.eye(68, dtype=np.int32)[4] * k) for k in range(n)]
    path = folder / "a.fap"
    path.write_text(format_fap(FapSequence.of(frames, "a", fps)), encoding="ascii")
    return path


def wav_file(folder: Path, data: bytes, width: int = 2, channels: int = 1, rate: int = 8000) -> Path:
    path = folder / "a.wav"
    with wave.open(str(path), "wb") as file:
        file.setnchannels(channels)
        file.setsampwidth(width)
        file.setframerate(rate)
        file.writeframes(data)
    return path


@pytest.mark.parametrize(("fps", "starts"), [(25, [0, 320, 640]), (30, [0, 267, 533]), (7, [0, 1143, 2286])])
def test_frames_are_put_on_the_clock_of_the_sound(tmp_path: Path, fps: int, starts: list[int]) -> None:
    clip = read_clip(fap_file(tmp_path, 5, fps), wav_file(tmp_path, TONE.tobytes()))
    assert [frame.sample for frame in clip.frames[:3]] == starts
    assert [frame.values[4] for frame in clip.frames] == [0, 1, 2, 3, 4]
    assert clip.sample_rate == 8000
    assert clip.faces_end == round(5 * 8000 / fps)


@pytest.mark.parametrize("frames", [2, 40])
def test_the_longer_of_the_two_decides(tmp_path: Path, frames: int) -> None:
    clip = read_clip(fap_file(tmp_path, frames, 25), wav_file(tmp_path, TONE.tobytes()))
    assert clip.samples == max(4000, 320 * frames)
    packet = clip.packet(3)
    assert (packet.turn, packet.start, len(packet.pcm)) == (3, 0, clip.samples)
    assert np.array_equal(packet.pcm[:4000], TONE)
    assert not packet.pcm[4000:].any()


def test_without_sound_it_is_silent(tmp_path: Path) -> None:
    clip = read_clip(fap_file(tmp_path, 25, 25), None)
    assert (clip.sample_rate, clip.samples) == (SILENT_RATE, SILENT_RATE)
    assert not clip.sound.any()


@pytest.mark.parametrize(("fps", "rate"), [("0.000001", 8000), ("25", 400_000)])
def test_what_would_not_fit_in_memory_is_refused(tmp_path: Path, fps: str, rate: int) -> None:
    fap = fap_file(tmp_path, 5, 25)
    fap.write_text(fap.read_text(encoding="ascii").replace("25 5", f"{fps} 5", 1), encoding="ascii")
    with pytest.raises(DataError, match=r"a\.(fap: lasts 5000000 s|wav: 400000 Hz)"):
        read_clip(fap, wav_file(tmp_path, TONE.tobytes(), rate=rate))


def test_other_formats_keep_their_upper_bits_and_the_mean_of_their_channels(tmp_path: Path) -> None:
    wide = np.zeros((4000, 3), np.uint8)
    wide[:, 1:] = TONE.view(np.uint8).reshape(-1, 2)
    assert np.array_equal(read_wav(wav_file(tmp_path, wide.tobytes(), 3))[1], TONE)
    assert np.array_equal(read_wav(wav_file(tmp_path, (TONE.astype("<i4") << 16).tobytes(), 4))[1], TONE)
    byte = (TONE // 256 + 128).astype(np.uint8)
    assert np.abs(read_wav(wav_file(tmp_path, byte.tobytes(), 1))[1].astype(int) - TONE).max() < 256
    both = np.stack([TONE, np.zeros_like(TONE)], 1)
    assert np.abs(read_wav(wav_file(tmp_path, both.tobytes(), 2, 2))[1] - TONE / 2).max() <= 0.5


def test_what_is_written_is_read(tmp_path: Path) -> None:
    write_wav(tmp_path / "b.wav", 22_050, TONE)
    rate, pcm = read_wav(tmp_path / "b.wav")
    assert rate == 22_050
    assert np.array_equal(pcm, TONE)


@pytest.mark.parametrize(
    "data", [b"", b"RIFF", b"no sound at all, but long enough to be some", b"RIFF\x10\0\0\0WAVEfmt "]
)
def test_no_wav_is_told_with_its_name(tmp_path: Path, data: bytes) -> None:
    path = tmp_path / "bad.wav"
    path.write_bytes(data)
    with pytest.raises(DataError, match=r"bad\.wav: no WAV file of plain PCM sound \(.+\); `ffmpeg"):
        read_wav(path)


def test_a_cut_off_wav_is_read_as_far_as_it_goes(tmp_path: Path) -> None:
    path = wav_file(tmp_path, TONE.tobytes())
    path.write_bytes(path.read_bytes()[:-3001])
    _, pcm = read_wav(path)
    assert np.array_equal(pcm, TONE[: len(pcm)])
    assert len(pcm) == 4000 - 1501
