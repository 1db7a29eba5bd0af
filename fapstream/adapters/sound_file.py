"""Sound files that a user hands in, as mono sound at the rate that is wanted (the extra `speech`)."""

from __future__ import annotations

import importlib.util
import os
import stat
import struct
from collections.abc import Iterator
from contextlib import contextmanager
from math import gcd
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from fapstream.errors import ClipError, FapstreamError
from fapstream.records import Pcm

Floats = NDArray[np.float32]

LIMIT_S = 3600.0
RATES = (8000, 192_000)
MAX_CHANNELS = 32
MAX_BYTES = 1 << 32
"""An hour of everything but many channels at high rates."""
BLOCK = 1 << 18
"""Numbers read at once, over all channels."""
PIECE = 1 << 17
"""Samples resampled at once, about."""
TAPS = 10
"""Half the length of the resampling filter, in samples of the slower rate, as resample_poly has it."""
SPARE_S = 0.1
"""A resampled sound may be longer than the header's figures by rounding."""
MAGIC = (b"RIFF", b"RF64", b"fLaC", b"OggS")
"""libsndfile's other readers, some of them rarely used, never see what comes from a stranger."""
STREAMED = 0x7FFFF000
"""A WAV data size from here on, or none, is what programs write that do not know it yet."""
UNTOLD = 1 << 62
"""So many frames has a FLAC file that does not know its length, says libsndfile, and cannot read it."""


class SpeechUnavailable(FapstreamError):
    """Recorded speech cannot be used here."""

    code = "no_speech_in"

    def __init__(self) -> None:
        super().__init__("recorded speech needs more packages: pip install 'fapstream[speech]'")


def installed() -> bool:
    """Whether the package that reads sound files is there."""
    return importlib.util.find_spec("soundfile") is not None


def sound_rate(path: Path, limit_s: float = LIMIT_S) -> int:
    """Samples per second of a sound file. Raises as `read_sound` does."""
    with _opened(path, limit_s) as sound:
        return int(sound.samplerate)


def read_sound(path: Path, rate: int = 16_000, limit_s: float = LIMIT_S) -> Pcm:
    """A WAV, FLAC or OGG file as mono sound, int16 (n,), at `rate` samples per second.

    Channels are averaged. The file is read in pieces into the array that is returned, the only copy.

    Raises OSError, SpeechUnavailable, and ClipError naming the file: no sound file, longer than `limit_s`,
    cut short, sampled below 8 or above 192 kHz, values that are no numbers.
    """
    with _opened(path, limit_s) as sound:
        room = int((min(sound.frames / sound.samplerate, limit_s) + SPARE_S) * rate)
        out = np.empty(room, np.int16)
        at = 0
        for piece in _pieces(sound, path, rate, limit_s):
            out[at : at + len(piece)] = piece
            at += len(piece)
    return out[:at]


def sound_pieces(path: Path, rate: int = 16_000, limit_s: float = LIMIT_S) -> Iterator[Pcm]:
    """The same sound as `read_sound` in pieces of some seconds, for who does not need it all at once.

    Raises the same, what is wrong later in the file when it comes to that.
    """
    with _opened(path, limit_s) as sound:
        yield from _pieces(sound, path, rate, limit_s)


@contextmanager
def _opened(path: Path, limit_s: float) -> Iterator[Any]:
    """The soundfile.SoundFile of a file whose header has been looked at."""
    if not installed():
        raise SpeechUnavailable
    import soundfile

    with open(os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0)), "rb") as file:
        _check_file(path, file)
        try:
            sound = soundfile.SoundFile(file.fileno(), closefd=False)
        except (soundfile.SoundFileError, TypeError, ValueError) as error:
            raise ClipError(f"{path}: is no sound file that can be read: {error}") from None
        with sound:
            _check_header(path, sound, limit_s)
            yield sound


def _check_file(path: Path, file: IO[bytes]) -> None:
    """Raises ClipError for what is not the file of a sound; the file stands at its beginning again."""
    status = os.fstat(file.fileno())
    if not stat.S_ISREG(status.st_mode):
        raise ClipError(f"{path}: is no file")
    if status.st_size > MAX_BYTES:
        raise ClipError(f"{path}: has {status.st_size >> 20} MB; {MAX_BYTES >> 20} MB are the limit")
    head = file.read(12)
    if not head.startswith(MAGIC):
        raise ClipError(f"{path}: is no sound file that can be read; those are WAV, FLAC and OGG")
    if head[:4] == b"RIFF":
        _check_wav(path, file, status.st_size)
    os.lseek(file.fileno(), 0, os.SEEK_SET)


def _check_wav(path: Path, file: IO[bytes], size: int) -> None:
    """Raises ClipError if the sound in a WAV file is shorter than its header says: libsndfile does not."""
    at = 12
    while at + 8 <= size:
        file.seek(at)
        name, length = struct.unpack("<4sI", file.read(8))
        if name == b"data":
            there = size - at - 8
            if there < length < STREAMED:
                raise ClipError(
                    f"{path}: is cut short: {there} bytes of sound, where its header says {length}"
                )
            return
        at += 8 + length + length % 2


def _check_header(path: Path, sound: Any, limit_s: float) -> None:
    rate, channels = sound.samplerate, sound.channels
    if not RATES[0] <= rate <= RATES[1]:
        low, high = RATES[0] // 1000, RATES[1] // 1000
        raise ClipError(f"{path}: is sampled at {rate} Hz; {low} to {high} kHz can be read")
    if channels > MAX_CHANNELS:
        raise ClipError(f"{path}: has {channels} channels; {MAX_CHANNELS} are the limit")
    if sound.frames >= UNTOLD:
        raise ClipError(f"{path}: does not say how long it is; write it to a file once more")
    if sound.frames > limit_s * rate:
        raise _too_long(path, sound.frames / rate, limit_s)


def _too_long(path: Path, seconds: float, limit_s: float) -> ClipError:
    return ClipError(f"{path}: lasts {seconds:.0f} s; {limit_s:.0f} s are the limit")


def _pieces(sound: Any, path: Path, rate: int, limit_s: float) -> Iterator[Pcm]:
    blocks = _mono(sound, path, limit_s)
    if sound.samplerate != rate:
        blocks = _resampled(blocks, sound.samplerate, rate)
    for block in blocks:
        yield np.clip(np.rint(block * 32768), -32768, 32767).astype(np.int16)


def _mono(sound: Any, path: Path, limit_s: float) -> Iterator[Floats]:
    """Blocks of the channels' mean, float32 (n,), full scale at 1."""
    import soundfile

    read = 0
    while True:
        try:
            block = sound.read(BLOCK // sound.channels, dtype="float32", always_2d=True)
        except soundfile.SoundFileError as error:
            at = read / sound.samplerate
            raise ClipError(f"{path}: is broken after {at:.1f} s: {error}") from None
        if not len(block):
            break
        if not np.isfinite(block).all():
            raise ClipError(f"{path}: has values that are no numbers after {read / sound.samplerate:.1f} s")
        read += len(block)
        if read > limit_s * sound.samplerate:
            raise _too_long(path, read / sound.samplerate, limit_s)
        yield block.mean(axis=1, dtype=np.float32)
    if read != sound.frames:
        raise ClipError(f"{path}: is cut short: {read} samples, where its header says {sound.frames}")


def _resampled(blocks: Iterator[Floats], source: int, rate: int) -> Iterator[Floats]:
    """The same at another rate, what resample_poly makes of the whole sound.

    Each piece is resampled with what the filter reaches on both sides, and begins at a whole number of the
    ratio's periods, so that its samples fall where those of the whole sound do.
    """
    from scipy.signal import firwin, resample_poly

    common = gcd(source, rate)
    up, down = rate // common, source // common
    widest = max(up, down)
    taps = firwin(2 * TAPS * widest + 1, 1 / widest, window=("kaiser", 5.0)).astype(np.float32)
    reach = -(-(TAPS * widest // up + 1) // down) * down
    kept, before = np.zeros(0, np.float32), 0
    step = -(-PIECE // down) * down
    for block in blocks:
        kept = np.concatenate([kept, block])
        while len(kept) >= before + step + reach:
            made = resample_poly(kept[: before + step + reach], up, down, window=taps)
            yield made[before * up // down : (before + step) * up // down]
            kept = kept[before + step - reach :]
            before = reach
    if len(kept) > before:
        yield resample_poly(kept, up, down, window=taps)[before * up // down :]
