"""Text sent to the packet in which the first phone begins, with its FAPs, over loopback; beside what the
voices need by themselves, in the same run.

The sentence has 20 words and is sent whole. Leading silence does not count: the packet is the one that holds
the onset of the first sounding phone. Then the same while others speak, on a server with a worker for each
processor, each time over a new connection; last, a text that arrives at 5 words a second.
"""

from __future__ import annotations

import argparse
import asyncio
import json
import os
import select
import shutil
import subprocess
import sys
import time

import numpy as np

import fapstream
from fapstream.adapters.mbrola_process import LIBSTDBUF, database
from fapstream.client import Talker
from fapstream.records import SILENCE, Packet
from fapstream.tts import FrontEnd, Manner, pho
from fapstream.tts.realise import realise
from fapstream.tts.voices import voice
from tests.benchmarks.server import server

SENTENCE = (
    "The quick brown fox jumps over the lazy dog while seven small birds watch from a branch of the tree."
)
WARM_UP = 20
WORDS_PER_S = 5.0


async def first_packet_ms(talker: Talker, text: str) -> float:
    """One turn, from the sending of its text to the packet with the first sounding phone."""
    start = time.perf_counter()
    turn = await talker.say(text)
    try:
        async for event in turn:
            if isinstance(event, Packet) and event.frames and has_onset(event):
                return 1000 * (time.perf_counter() - start)
        raise RuntimeError("the turn was silent")
    finally:
        await turn.interrupt()


def has_onset(packet: Packet) -> bool:
    """Whether a sounding phone begins in the packet."""
    return any(m.kind == "phone" and m.text != SILENCE for m in packet.marks)


async def trickle_ms(talker: Talker) -> tuple[float, float]:
    """Text at 5 words/s: ms from sending the first word to its onset packet, and to the third word."""
    turn = await talker.speak()
    start = time.perf_counter()
    third = 2 / WORDS_PER_S

    async def feed() -> None:
        for i, word in enumerate(SENTENCE.split()[:6]):
            await asyncio.sleep(max(0.0, start + i / WORDS_PER_S - time.perf_counter()))
            await turn.append(word + " ")

    feeder = asyncio.create_task(feed())
    async for event in turn:
        if isinstance(event, Packet) and has_onset(event):
            heard = 1000 * (time.perf_counter() - start)
            break
    feeder.cancel()
    await turn.interrupt()
    return heard, 1000 * third


async def measure(address: str, runs: int) -> tuple[list[float], list[float]]:
    """Latencies of whole sentences and of trickling text."""
    async with fapstream.connect(f"ws://{address}/ws", lang="en") as talker:
        for _ in range(WARM_UP):
            await first_packet_ms(talker, SENTENCE)
        whole = [await first_packet_ms(talker, SENTENCE) for _ in range(runs)]
        trickled = [(await trickle_ms(talker))[0] for _ in range(5)]
    return whole, trickled


def mbrola_floor_ms(runs: int) -> list[float]:
    """A warm MBROLA given a ready .pho of the sentence: to its first byte."""
    us1 = voice("us1")
    frontend = FrontEnd("en", Manner().of(us1))
    lines = "".join(
        pho.lines(realise(u.phones, us1), us1.sample_rate) for u in frontend.feed(SENTENCE) + frontend.end()
    )
    preload = next(str(p) for p in LIBSTDBUF if p.exists())
    process = subprocess.Popen(
        ["mbrola", "-e", str(database(us1)), "-", "-.raw"], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL, env={**os.environ, "LD_PRELOAD": preload, "_STDBUF_O": "0"},
    )  # fmt: skip
    assert process.stdin is not None
    assert process.stdout is not None
    out = []
    fd = process.stdout.fileno()
    for _ in range(runs + WARM_UP):
        start = time.perf_counter()
        process.stdin.write((lines + "#\n").encode())
        process.stdin.flush()
        os.read(fd, 65536)
        out.append(1000 * (time.perf_counter() - start))
        while select.select([fd], [], [], 0.02)[0]:
            os.read(fd, 65536)
    process.kill()
    process.wait()
    return out[WARM_UP:]


def espeak_ng_ms(runs: int) -> list[float]:
    """The espeak-ng command on the same text: to the first byte of sound."""
    if shutil.which("espeak-ng") is None:
        return []
    return [_command_ms(["espeak-ng", "-v", "en-us", "--stdout", SENTENCE]) for _ in range(runs)]


def _command_ms(command: list[str]) -> float:
    start = time.perf_counter()
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
    assert process.stdout is not None
    process.stdout.read(64)
    elapsed = 1000 * (time.perf_counter() - start)
    process.stdout.read()
    process.wait()
    return elapsed


def in_a_crowd(others: int, runs: int) -> list[float]:
    """Text to first packet while so many others speak."""
    workers = str(os.cpu_count() or 1)
    most = ("--max-sessions-per-address", "999", "--max-sessions", "999", "--workers", workers)
    with server("--lang", "en", "--voice", "us1", *most) as (address, _):
        crowd = subprocess.Popen(
            [sys.executable, "-m", "tests.benchmarks.load", address, str(others)],
            stdout=subprocess.PIPE, text=True,
        )  # fmt: skip
        assert crowd.stdout
        try:
            crowd.stdout.readline()
            return asyncio.run(whole_sentences(address, runs))
        finally:
            crowd.kill()
            crowd.wait()


async def whole_sentences(address: str, runs: int) -> list[float]:
    """One after the other, each on a connection that another worker may have."""
    out = []
    for _ in range(runs):
        async with fapstream.connect(f"ws://{address}/ws", lang="en") as talker:
            out.append(await first_packet_ms(talker, SENTENCE))
        await asyncio.sleep(0.02)
    return out


def main() -> None:
    """Print the table, or one JSON object."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--runs", type=int, default=200)
    parser.add_argument("--others", type=int, default=100, help="that speak at the same time")
    args = parser.parse_args()
    floor = mbrola_floor_ms(args.runs)
    espeak = espeak_ng_ms(min(args.runs, 30))
    with server("--lang", "en", "--voice", "us1") as (address, _):
        whole, trickled = asyncio.run(measure(address, args.runs))
    crowded = in_a_crowd(args.others, args.runs)
    rows: list[tuple[str, str, list[float]]] = [
        ("first_packet_ms", "text sent to first phone's packet with FAPs, loopback", whole),
        ("mbrola_floor_ms", "warm MBROLA alone, ready .pho to first byte", floor),
        ("espeak_ng_ms", "espeak-ng command, text to first byte", espeak),
        ("crowded_ms", f"the first again, while {args.others} others speak", crowded),
        ("trickle_ms", f"text at {WORDS_PER_S:g} words/s: first word heard (third arrives at 400)", trickled),
    ]
    figures = {
        f"{key}_p{q}": round(float(np.percentile(values, q)), 3)
        for key, _, values in rows
        if values
        for q in (50, 99)
    }
    figures["ratio_to_mbrola_p50"] = round(figures["first_packet_ms_p50"] / figures["mbrola_floor_ms_p50"], 1)
    if args.json:
        print(json.dumps(figures))
        return
    print(f"{'':<66}{'p50':>9}{'p99':>9}  ms")
    for key, label, values in rows:
        if values:
            print(f"{label:<66}{figures[key + '_p50']:>9.2f}{figures[key + '_p99']:>9.2f}")


if __name__ == "__main__":
    main()
