"""Turns from a server: into the show as they come, or collected as a clip."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager, contextmanager
from dataclasses import dataclass

import numpy as np
from websockets.exceptions import InvalidStatus, InvalidURI, WebSocketException

from fapstream.adapters.stdin import chunks
from fapstream.client import Talker, Turn, connect, listen
from fapstream.errors import FapstreamError, InputError
from fapstream.protocol import generated as g
from fapstream.records import FapFrame, Packet
from fapstream.viewer.clip import SILENT_RATE, Clip
from fapstream.viewer.show import Show

ACK_S = 0.25
STDIN = "-"


class ConnectionLost(FapstreamError):
    """There is no server, or no longer."""

    code = "connection_lost"


@dataclass(frozen=True, slots=True)
class Wish:
    """What is to be said by which server. `text` "-" is standard input as it arrives, None nothing."""

    url: str
    text: str | None = None
    lang: str | None = None
    voice: str | None = None
    rate: float = 1.0
    token: str | None = None
    channel: str | None = None
    """Listen to this channel; nothing is said then."""


async def perform(wish: Wish, show: Show) -> None:
    """Say it, or listen, and stay connected. Raises ConnectionLost, ServerError, InputError."""
    if wish.channel is not None:
        await _attend(wish, wish.channel, show)
        return
    async with _connected(wish) as talker:
        if wish.text is not None:
            await _perform_turn(talker, wish, show)
        await talker.closed()


async def collect(wish: Wish) -> Clip:
    """The whole turn, as fast as the server makes it. Raises ConnectionLost, ServerError, InputError."""
    packets: list[Packet] = []
    begin: g.Begin | None = None
    async with _connected(wish) as talker, _speaking(talker, wish) as turn:
        async for event in turn:
            if isinstance(event, g.Begin):
                begin = event
            elif isinstance(event, Packet):
                packets.append(event)
                await talker.acknowledge(turn, event.start + len(event.pcm))
    if begin is None:
        return Clip(SILENT_RATE, np.zeros(0, np.int16), (), 0)
    frames: list[FapFrame] = [frame for packet in packets for frame in packet.frames]
    pcm = np.concatenate([packet.pcm for packet in packets] or [np.zeros(0, np.int16)])
    end = frames[-1].sample + begin.sample_rate // begin.fps if frames else 0
    return Clip(begin.sample_rate, pcm, tuple(frames), end)


async def _attend(wish: Wish, channel: str, show: Show) -> None:
    """What is spoken into a channel, as it is spoken."""
    begun = 0
    with _understood(wish.url):
        async with listen(wish.url, channel, token=wish.token) as audience:
            async for event in audience:
                match event:
                    case g.Live():
                        show.close()
                        begun = 0
                    case g.Begin() if event.turn != begun:
                        begun = event.turn
                        show.begin(event.turn, event.sample_rate, live=True)
                    case Packet():
                        show.push(event)
                    case g.Discard():
                        show.discard(event.turn, event.sample)
                    case g.Pause() | g.Continue():
                        show.pause(isinstance(event, g.Pause))
                    case g.Done():
                        show.end(event.turn)
                    case _:
                        pass


async def _perform_turn(talker: Talker, wish: Wish, show: Show) -> None:
    async with _speaking(talker, wish) as turn:
        reporter = asyncio.create_task(_report(talker, turn, show))
        try:
            async for event in turn:
                if isinstance(event, g.Begin):
                    show.begin(event.turn, event.sample_rate)
                elif isinstance(event, Packet):
                    show.push(event)
                elif isinstance(event, g.Discard):
                    show.discard(event.turn, event.sample)
                else:
                    show.end(event.turn)
        finally:
            reporter.cancel()
            await asyncio.gather(reporter, return_exceptions=True)


async def _report(talker: Talker, turn: Turn, show: Show) -> None:
    """Tell the server what is heard."""
    while True:
        await asyncio.sleep(ACK_S)
        ack = show.ack(turn.number)
        if ack:
            await talker.send(ack)


@asynccontextmanager
async def _speaking(talker: Talker, wish: Wish) -> AsyncIterator[Turn]:
    """A turn whose text is written meanwhile."""
    turn = await talker.speak(lang=wish.lang, voice=wish.voice, rate=wish.rate)
    feeder = asyncio.create_task(_feed(turn, wish.text or ""))
    try:
        yield turn
        await feeder
    finally:
        feeder.cancel()
        await asyncio.gather(feeder, return_exceptions=True)


async def _feed(turn: Turn, text: str) -> None:
    if text == STDIN:
        async for data in chunks():
            await turn.append(data)
    else:
        await turn.append(text)
    await turn.end()


@asynccontextmanager
async def _connected(wish: Wish) -> AsyncIterator[Talker]:
    with _understood(wish.url):
        async with connect(wish.url, lang=wish.lang, voice=wish.voice, token=wish.token) as talker:
            yield talker


@contextmanager
def _understood(url: str) -> Iterator[None]:
    """What goes wrong with a connection, in our own words."""
    try:
        yield
    except InvalidURI as e:
        raise InputError(f"{url!r} is no address of a server; one is ws://127.0.0.1:8765/ws") from e
    except InvalidStatus as e:
        raise ConnectionLost(
            f"{url} answers with HTTP {e.response.status_code}; a server's address ends in /ws"
        ) from e
    except (OSError, WebSocketException, TimeoutError) as e:
        raise ConnectionLost(
            f"no connection to {url}: {e or type(e).__name__}; is `fapstream serve` running?"
        ) from e
