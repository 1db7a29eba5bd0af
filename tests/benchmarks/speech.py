"""What a voice says of a text, as packets: the real pipeline, without a server."""

from __future__ import annotations

from fapstream.adapters.pool import VoicePool
from fapstream.pipeline import Pipeline
from fapstream.records import Packet, TurnFormat
from fapstream.talk import Talk
from fapstream.tts import FrontEnd, Manner


async def spoken(text: str, voice: str = "us1") -> tuple[int, list[Packet]]:
    """Sample rate in Hz, and the turn's packets."""
    pool = VoicePool()
    try:
        chosen = pool.find(voice, None)
        turn = TurnFormat(1, chosen.name, chosen.lang, chosen.sample_rate, 25)
        frontend = FrontEnd(chosen.lang, Manner().of(chosen))
        synthesizer = await pool.acquire(chosen)
        talk = Talk(Pipeline(turn, frontend, 1), synthesizer, None)
        talk.feed(text)
        talk.end()
        packets = [packet async for packet in talk.packets()]
        await talk.aclose()
        await synthesizer.aclose()
        return chosen.sample_rate, packets
    finally:
        await pool.aclose()
