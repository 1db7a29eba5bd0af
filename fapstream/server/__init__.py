"""The server: joins sockets to sessions and decides nothing."""

from __future__ import annotations

from fapstream.server.adapting import Adapting
from fapstream.server.app import Address, App, running
from fapstream.server.connection import Gate
from fapstream.server.http import Site, packaged_heads
from fapstream.server.lobby import Lobby
from fapstream.server.service import Service

__all__ = ["Adapting", "Address", "App", "Gate", "Lobby", "Service", "Site", "packaged_heads", "running"]
