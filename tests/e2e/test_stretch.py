"""Time-stretch as a listener would judge it: a real voice keeps its pitch and its spectrum."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import NDArray

from fapstream.stream.heard import HeardMap
from fapstream.stream.player import Player
from tests.benchmarks.speech import spoken

TEXT = (
    "Whereas recognition of the inherent dignity and of the equal and inalienable rights of all members of "
    "the human family is the foundation of freedom, justice and peace in the world, no one shall be held in "
    "slavery. Everyone has the right to life, liberty and the security of person, and to a nationality. "
)
BLOCK = 160
Sound = NDArray[np.float64]


def listened(rate: int, pcm: NDArray[np.int16], way: int) -> tuple[Sound, HeardMap, int]:
    """A live talk whose store is much too large (way -1) or small (1): what is heard, the map, frames."""
    heard, out = HeardMap(), []
    player = Player(rate, heard.apply)
    player.begin(1, live=True)
    ahead = 4 * rate if way < 0 else rate // 5
    player.push(1, 0, pcm[:ahead])
    for k in range((len(pcm) - ahead) // BLOCK):
        out.append(player.render(BLOCK, k * BLOCK))
        player._jitter.target_s = 0.1 if way < 0 else 1.2
        start = ahead + k * BLOCK
        player.push(1, start, pcm[start : start + BLOCK])
    assert player.stats.underruns == 0
    print(f"{player.stats.stretched_ms:.0f} ms of {1000 * len(pcm) / rate:.0f} ms changed")
    return np.concatenate(out) / 32_768, heard, len(out) * BLOCK


def pitch_hz(sound: Sound, at: int, rate: int) -> float | None:
    """Of 50 ms round `at`, by autocorrelation; None if it is no voice."""
    part = sound[max(0, at - rate // 40) : at + rate // 40]
    if len(part) < rate // 20 or part @ part < 0.02**2 * len(part):
        return None
    part = part * np.hanning(len(part))
    taper = np.hanning(len(part))
    mine, window = (np.correlate(x, x, "full")[len(x) - 1 :] for x in (part, taper))
    likeness = mine / mine[0] / np.maximum(window / window[0], 1e-3)
    least, most = rate // 250, rate // 70
    best = least + int(np.argmax(likeness[least:most]))
    if likeness[best] < 0.7 or not least < best < most - 1:
        return None
    a, b, c = likeness[best - 1 : best + 2]
    return float(rate / (best + 0.5 * (a - c) / (a - 2 * b + c)))


def bands_db(sound: Sound, rate: int) -> Sound:
    """The long-time spectrum in thirds of an octave from 100 Hz to 6 kHz."""
    frames = np.lib.stride_tricks.sliding_window_view(sound, 1024)[::256] * np.hanning(1024)
    power = (np.abs(np.fft.rfft(frames)) ** 2).mean(axis=0)
    edges = 100 * 2 ** (np.arange(19) / 3)
    frequencies = np.fft.rfftfreq(1024, 1 / rate)
    return np.array(
        [
            10 * np.log10(power[(frequencies >= low) & (frequencies < high)].mean() + 1e-12)
            for low, high in pairwise(edges)
            if ((frequencies >= low) & (frequencies < high)).any()
        ]
    )


@pytest.mark.parametrize("way", [-1, 1])
async def test_pitch_and_spectrum_of_a_voice_stay(way: int) -> None:
    """Pitch within 1 % where the same sample is heard, bands of the long-time spectrum within 1 dB."""
    rate, packets = await spoken(TEXT)
    pcm = np.concatenate([packet.pcm for packet in packets])
    out, heard, frames = listened(rate, pcm, way)
    source = pcm / 32_768
    ratios = []
    for frame in range(rate // 10, frames, rate // 50):
        now = heard.at(frame)
        assert now is not None
        before, after = pitch_hz(source, int(now.sample), rate), pitch_hz(out, frame, rate)
        if before and after:
            ratios.append(after / before)
    end = heard.at(frames)
    assert end is not None
    change = bands_db(out, rate) - bands_db(source[: int(end.sample)], rate)
    off = np.abs(np.log(ratios))
    print(
        f"way {way:+d}: pitch {100 * (np.exp(np.mean(np.log(ratios))) - 1):+.2f} % on the mean, "
        f"{100 * np.median(off):.2f} % median, {100 * np.percentile(off, 90):.2f} % p90 of {len(ratios)}; "
        f"spectrum {np.abs(change).max():.2f} dB at most"
    )
    assert len(ratios) > 200
    assert abs(np.mean(np.log(ratios))) < 0.01
    assert np.median(off) < 0.01
    assert np.abs(change).max() < 1.0
