"""For programs that use a running server: `async with fapstream.connect(url) as talker`, and `listen`."""

from __future__ import annotations

from fapstream.client.audience import Audience, listen
from fapstream.client.connection import ServerError, Talker, Turn, connect

__all__ = ["Audience", "ServerError", "Talker", "Turn", "connect", "listen"]
