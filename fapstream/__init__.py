"""fapstream: text in, voice and MPEG-4 face out, streamed on one clock.

async with fapstream.connect("ws://127.0.0.1:8765/ws") as talker:
    turn = await talker.say("Hello world.", lang="en")
    async for event in turn:
        ...
"""

from __future__ import annotations

from typing import TYPE_CHECKING

__version__ = "0.1.0"
__all__ = ["__version__", "connect", "listen"]

if TYPE_CHECKING:
    from fapstream.client import connect, listen


def __getattr__(name: str) -> object:
    """Load the client only when it is asked for: the pure rooms do without sockets."""
    if name in ("connect", "listen"):
        from fapstream import client

        return getattr(client, name)
    raise AttributeError(name)
