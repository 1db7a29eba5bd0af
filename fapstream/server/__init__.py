"""The server: joins sockets to sessions and decides nothing."""

from __future__ import annotations

from fapstream.server.adapting import Adapting
from fapstream.server.app import running
from fapstream.server.connection import Service
from fapstream.server.http import Site, packaged_heads

__all__ = ["Adapting", "Service", "Site", "packaged_heads", "running"]
