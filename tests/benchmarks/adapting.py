"""A page that makes heads: photos in, points moved as by a hand, a head out, and again."""

from __future__ import annotations

import asyncio
from pathlib import Path
from typing import Any

from websockets.asyncio.client import ClientConnection, connect
from websockets.typing import Subprotocol

from fapstream.protocol import adapting

PHOTOS = Path(__file__).parents[1] / "unit/adapters/photos"
MOVES = 30
"""Points are sent so often, ten times a second, before a head is asked for."""


async def adapt(address: str) -> None:
    """Until it is cancelled. Raises RuntimeError if the server cannot."""
    uri = f"ws://{address}{adapting.PATH}"
    async with connect(
        uri, subprotocols=[Subprotocol(adapting.SUBPROTOCOL)], max_size=adapting.MAX_MESSAGE_BYTES
    ) as socket:
        await _ask(socket, type="hello")
        seq = 0
        while True:
            points = {}
            for view in ("front", "profile"):
                data = (PHOTOS / f"person601.{view}.jpg").read_bytes()
                found = await _ask(socket, type="photo", view=view, data=data)
                points[view] = {name: row[:2] for name, row in found["points"].items()}
            for _ in range(MOVES):
                seq += 1
                next(iter(points["front"].values()))[0] += 0.5
                await _ask(socket, type="points", seq=seq, **points)
                await asyncio.sleep(0.1)
            seq += 1
            await _ask(socket, type="head", seq=seq, name="Somebody", **points)


async def _ask(socket: ClientConnection, **message: Any) -> dict[str, Any]:
    await socket.send(adapting.encode(message))
    answer = adapting.decode(await socket.recv())
    if answer["type"] == "error":
        raise RuntimeError(answer["message"])
    return answer
