"""What a talker costs: CPU milliseconds for a second of speech, by part, beside MBROLA's own floor.

Many talks in one process, each with its own text, without a network: text in, packets out. By default as fast
as they can; `--paced` takes packets as a listener does, who is sent the first second and a half at once.
"""

from __future__ import annotations

import argparse
import asyncio
import functools
import json
import resource
import subprocess
import time
from collections import Counter
from collections.abc import Callable
from contextlib import aclosing
from pathlib import Path
from typing import Any

from fapstream.adapters.mbrola_process import database
from fapstream.adapters.pool import VoicePool
from fapstream.adapters.spares import watch_by_descriptor
from fapstream.motion import FaceTrack
from fapstream.pipeline import Pipeline
from fapstream.records import TurnFormat
from fapstream.stream import Loudness, Packetizer
from fapstream.stream.pacer import LEAD_S
from fapstream.talk import Talk
from fapstream.tts import FrontEnd, Manner
from fapstream.tts.pho import Realiser
from fapstream.tts.voices import Voice, voice

TEXT = (Path(__file__).parent / "data" / "udhr_en.txt").read_text(encoding="utf-8").split("\n")
PARTS: dict[str, tuple[tuple[type, str], ...]] = {
    "front end": ((Pipeline, "feed"), (Pipeline, "end"), (Pipeline, "hold")),
    "realise": ((Realiser, "write"),),
    "face": ((FaceTrack, "add"), (FaceTrack, "frames")),
    "packets": ((Packetizer, "add"), (Packetizer, "cut"), (Loudness, "add"), (Loudness, "apply")),
}
"""Methods that do not call each other; what is left is the pipeline itself, asyncio and the pipes."""


class Meter:
    """CPU time spent in each part, s."""

    def __init__(self) -> None:
        self.seconds = dict.fromkeys(PARTS, 0.0)
        for part, methods in PARTS.items():
            for owner, name in methods:
                self._watch(part, owner, name)

    def _watch(self, part: str, owner: type, name: str) -> None:
        method: Callable[..., Any] = getattr(owner, name)

        @functools.wraps(method)
        def timed(*args: Any, **kwargs: Any) -> Any:
            start = time.thread_time()
            try:
                return method(*args, **kwargs)
            finally:
                self.seconds[part] += time.thread_time() - start

        setattr(owner, name, timed)


def text_of(k: int) -> str:
    """Talker k's own text: the same articles, begun elsewhere."""
    at = 7 * k % len(TEXT)
    return "\n".join(TEXT[at:] + TEXT[:at])


async def talker(pool: VoicePool, chosen: Voice, k: int, seconds: float, paced: bool) -> float:
    """One talk; returns the seconds of sound taken."""
    turn = TurnFormat(1, chosen.name, chosen.lang, chosen.sample_rate, 25)
    loop = asyncio.get_running_loop()
    start = loop.time() + 0.001 * k
    heard = (lambda: max(0.0, loop.time() - start)) if paced else None
    pipeline = Pipeline(turn, FrontEnd(chosen.lang, Manner().of(chosen)), seed=k)
    talk = Talk(pipeline, await pool.acquire(chosen), heard)
    talk.feed(text_of(k))
    end = 0.0
    try:
        async with aclosing(talk.packets()) as packets:
            async for packet in packets:
                end = (packet.start + len(packet.pcm)) / chosen.sample_rate
                if paced and (early := start + end - LEAD_S - loop.time()) > 0:
                    await asyncio.sleep(early)
                if end >= seconds:
                    break
    finally:
        await talk.aclose()
    return end


async def run(
    chosen: Voice, talkers: int, seconds: float, paced: bool, events: Counter[str] | None = None
) -> float:
    """Seconds of sound of all talkers together. `events` counts what happened in the pool."""
    watch_by_descriptor()
    counted = Counter[str]() if events is None else events
    pool = VoicePool(on_event=lambda event: counted.update([event]))
    try:
        return sum(await asyncio.gather(*(talker(pool, chosen, k, seconds, paced) for k in range(talkers))))
    finally:
        await pool.aclose()


def children_s() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def floor_ms(chosen: Voice, text: str) -> float:
    """MBROLA alone on a ready file, by file in and file out: CPU ms for a second of sound."""
    front, realiser = FrontEnd(chosen.lang, Manner().of(chosen)), Realiser(chosen)
    lines = "".join(realiser.write(u).lines for u in front.feed(text) + front.end())
    before = children_s()
    sound = subprocess.run(
        ["mbrola", "-e", str(database(chosen)), "-", "-.raw"], input=lines.encode(), capture_output=True
    ).stdout
    return 1000 * (children_s() - before) / (len(sound) / 2 / chosen.sample_rate)


def measure(chosen: Voice, talkers: int, seconds: float, paced: bool) -> dict[str, float]:
    """CPU ms for a talker's second, by part."""
    floor = floor_ms(chosen, text_of(0))
    asyncio.run(run(chosen, 1, 2.0, False))  # tables are read
    meter = Meter()
    children, own, wall = children_s(), time.process_time(), time.perf_counter()
    events = Counter[str]()
    spoken = asyncio.run(run(chosen, talkers, seconds, paced, events))
    own, children, wall = time.process_time() - own, children_s() - children, time.perf_counter() - wall
    figures = dict(meter.seconds)
    figures["asyncio, pipes and the rest"] = own - sum(meter.seconds.values())
    figures["python in all"] = own
    figures["mbrola processes"] = children
    return {
        **{part: round(1000 * s / spoken, 3) for part, s in figures.items()},
        "mbrola's floor": round(floor, 3),
        "programs started": events["start"],
        "times real time": round(spoken / wall, 1),
    }


def main() -> None:
    """Print the table, or one JSON object."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--talkers", type=int, default=20)
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--voice", default="us1")
    parser.add_argument("--paced", action="store_true")
    args = parser.parse_args()
    figures = measure(voice(args.voice), args.talkers, args.seconds, args.paced)
    if args.json:
        print(json.dumps(figures))
        return
    print(f"{args.talkers} talkers, {args.seconds:g} s each; CPU ms for a talker's second")
    for part, value in figures.items():
        print(f"{part:<32}{value:>9.3f}")


if __name__ == "__main__":
    main()
