"""For programs that push text to a running server: `async with fapstream.connect(url) as talker`."""

from __future__ import annotations

from fapstream.client.connection import ServerError, Talker, Turn, connect

__all__ = ["ServerError", "Talker", "Turn", "connect"]
