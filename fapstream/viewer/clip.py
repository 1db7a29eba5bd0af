"""A talk that is there as a whole: FAP frames and sound on one clock, from files or from a turn."""

from __future__ import annotations

import io
import wave
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from fapstream.adapters.files import read_file
from fapstream.errors import DataError
from fapstream.fap import read_animation
from fapstream.fap.rows import Note
from fapstream.records import FapFrame, Packet, Pcm

SILENT_RATE = 16_000
"""Hz of the clock where there is no sound."""
MAX_RATE = 384_000
MAX_SAMPLES = 1 << 29
"""Three hours at 48 kHz; longer talks would not fit."""


@dataclass(frozen=True, slots=True)
class Clip:
    """`frames` and `pcm` from sample 0 on; silence, or a neutral face, makes up for what is missing."""

    sample_rate: int
    pcm: Pcm
    frames: tuple[FapFrame, ...]
    faces_end: int
    """The sample at which the last frame ends."""
    notes: tuple[Note, ...] = ()
    """What was odd in the file."""

    @property
    def samples(self) -> int:
        """How long it lasts."""
        return max(len(self.pcm), self.faces_end)

    @property
    def sound(self) -> Pcm:
        """The sound, with silence up to the end of the last frame."""
        return np.concatenate([self.pcm, np.zeros(self.samples - len(self.pcm), np.int16)])

    def packet(self, turn: int) -> Packet:
        """All of it."""
        return Packet(turn, 0, self.sound, self.frames)


def read_clip(fap: Path, wav: Path | None) -> Clip:
    """The talk in a FAP file and its sound. Raises OSError, InputError, DataError."""
    rate, pcm = (SILENT_RATE, np.zeros(0, np.int16)) if wav is None else read_wav(wav)
    sequence = read_animation(read_file(fap), str(fap))
    if sequence.length * rate / sequence.fps > MAX_SAMPLES:
        seconds = sequence.length / sequence.fps
        raise DataError(
            str(fap), None, f"lasts {seconds:.0f} s; the most is {MAX_SAMPLES // rate} s at {rate} Hz"
        )
    rows = sequence.low_level()
    starts = [round(k * rate / sequence.fps) for k in range(len(rows) + 1)]
    frames = tuple(FapFrame(start, row) for start, row in zip(starts, rows, strict=False))
    return Clip(rate, pcm, frames, starts[-1], sequence.notes)


def read_wav(path: Path) -> tuple[int, Pcm]:
    """Sample rate in Hz and the sound as mono int16. Raises OSError, InputError, DataError."""
    try:
        with wave.open(io.BytesIO(read_file(path))) as file:
            width, channels, rate = file.getsampwidth(), file.getnchannels(), file.getframerate()
            data = file.readframes(file.getnframes())
    except (wave.Error, EOFError) as e:
        why = str(e) or "it ends too early"
        reason = f"no WAV file of plain PCM sound ({why}); `ffmpeg -i IN -c:a pcm_s16le OUT.wav` makes one"
        raise DataError(str(path), None, reason) from e
    if not 0 < rate <= MAX_RATE:
        raise DataError(str(path), None, f"{rate} Hz; it must be above 0 and at most {MAX_RATE}")
    data = data[: len(data) // (width * channels) * width * channels]
    return rate, _mono(data, width, channels)


def write_wav(path: Path, sample_rate: int, pcm: Pcm) -> None:
    """Mono, 16 bit. Raises OSError."""
    with path.open("wb") as opened, wave.open(opened, "wb") as file:
        file.setnchannels(1)
        file.setsampwidth(2)
        file.setframerate(sample_rate)
        file.writeframes(pcm.astype("<i2").tobytes())


def _mono(data: bytes, width: int, channels: int) -> Pcm:
    """The upper 16 bits of every sample, the mean over the channels."""
    bytes_ = np.frombuffer(data, np.uint8).reshape(-1, width)
    if width == 1:
        samples = (bytes_[:, 0].astype(np.int16) - 128) * 256
    else:
        samples = np.ascontiguousarray(bytes_[:, -2:]).view("<i2")[:, 0]
    if channels > 1:
        samples = np.rint(samples.reshape(-1, channels).mean(axis=1))
    return samples.astype(np.int16)
