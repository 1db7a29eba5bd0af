"""One port for everything: the page, the client, the heads, the websockets, and what watchers ask."""

from __future__ import annotations

import asyncio
import logging
import ssl
from collections.abc import AsyncIterator, Callable, Sequence
from contextlib import AsyncExitStack, asynccontextmanager
from dataclasses import dataclass, field
from http import HTTPStatus
from pathlib import Path

from websockets.asyncio.server import Server, ServerConnection, serve, unix_serve
from websockets.datastructures import Headers
from websockets.exceptions import NegotiationError
from websockets.http11 import Request, Response
from websockets.typing import Subprotocol

from fapstream.protocol import adapting
from fapstream.protocol import generated as g
from fapstream.server.adapting import Adapting
from fapstream.server.admission import Network, address_of
from fapstream.server.connection import Connection, Gate, HandOver, nowhere
from fapstream.server.health import health
from fapstream.server.http import Answer, Site, plain
from fapstream.server.link import WebSocketLink
from fapstream.server.lobby import Lobby
from fapstream.server.origins import Doors, refusal
from fapstream.server.service import Service

log = logging.getLogger("fapstream.server")

WEBSOCKET_PATH = "/ws"
METRICS_PATH = "/metrics"
QUEUE_FRAMES = 16
GOODBYE_S = 2.0
HANDSHAKE_S = 5.0
"""Who has not asked for anything after so long is cut off."""


@dataclass(slots=True)
class App:
    """The server's state, and the parts that it joins. `metrics` answers /metrics to who may ask."""

    service: Service
    site: Site
    lobby: Lobby
    gate: Gate
    pages: Adapting | None = None
    doors: Doors = field(default_factory=Doors)
    proxies: tuple[Network, ...] = ()
    """Whose X-Forwarded-For is believed."""
    metrics: Callable[[str, Headers], Answer] = lambda address, headers: plain(404, "Not found\n")
    hand_over: HandOver = nowhere
    warm: bool = True
    draining: bool = False

    async def handle(self, socket: ServerConnection) -> None:
        """One websocket from its handshake to its end."""
        address = self._address(socket, socket.request.headers if socket.request else Headers())
        if socket.subprotocol == adapting.SUBPROTOCOL and self.pages:
            socket.protocol.max_message_size = adapting.MAX_MESSAGE_BYTES
            await self.pages.handle(socket, address)
            return
        link = WebSocketLink(socket)
        await Connection(link, address, self.service, self.lobby, self.gate, self.hand_over).run()

    def http(self, socket: ServerConnection, request: Request) -> Response | None:
        """Answer a plain request; None lets a websocket handshake go on."""
        path, headers = request.path.partition("?")[0], request.headers
        sockets = (WEBSOCKET_PATH, adapting.PATH) if self.pages else (WEBSOCKET_PATH,)
        if path in sockets:
            return self._handshake(headers)
        if path == METRICS_PATH:
            return _response(self.metrics(self._address(socket, headers), headers))
        known = health(path, self.warm, self.draining)
        return _response(
            known
            or self.site.answer(path, headers.get("Accept-Encoding", ""), headers.get("If-None-Match", ""))
        )

    def _handshake(self, headers: Headers) -> Response | None:
        if "upgrade" not in headers.get("Connection", "").lower():
            return _response(plain(426, "This address speaks WebSocket.\n", ("Upgrade", "websocket")))
        if reason := refusal(headers.get("Origin"), headers.get("Host"), self.doors):
            return _response(plain(403, reason + "\n"))
        return None

    def _address(self, socket: ServerConnection, headers: Headers) -> str:
        forwarded = ",".join(headers.get_all("X-Forwarded-For"))
        peer = socket.remote_address
        if not isinstance(peer, tuple):  # the private socket: another worker says whose session it passes on
            return forwarded
        return address_of(peer[0], forwarded, self.proxies)


def _response(answer: Answer) -> Response:
    headers = Headers(answer.headers)
    headers["Content-Length"] = str(len(answer.body))
    headers["Connection"] = "close"
    status = HTTPStatus(answer.status)
    return Response(status.value, status.phrase, headers, answer.body)


def _subprotocol(socket: ServerConnection, offered: Sequence[Subprotocol]) -> Subprotocol:
    path = socket.request.path.partition("?")[0] if socket.request else ""
    spoken = adapting.SUBPROTOCOL if path == adapting.PATH else g.SUBPROTOCOL
    if spoken not in offered:
        raise NegotiationError(f"offer the subprotocol {spoken}")
    return Subprotocol(spoken)


@dataclass(frozen=True, slots=True)
class Address:
    """Where a server listens."""

    host: str = "127.0.0.1"
    port: int = 0
    tls: ssl.SSLContext | None = None
    shared: bool = False
    """Other processes listen on the same port."""
    private: Path | None = None
    """A socket for the other workers of the machine."""


@asynccontextmanager
async def running(app: App, address: Address, drain_s: float = 0.0) -> AsyncIterator[Server]:
    """The server, listening. Leaving lets those who speak end within `drain_s`, says goodbye to everyone and
    closes.

    Raises OSError.
    """
    options = {
        "process_request": app.http,
        "select_subprotocol": _subprotocol,
        "compression": None,
        "max_size": g.MAX_MESSAGE_BYTES,
        "max_queue": QUEUE_FRAMES,
        "open_timeout": HANDSHAKE_S,
        "close_timeout": GOODBYE_S,
        "logger": logging.getLogger("fapstream.websockets"),
    }
    tls = {"ssl": address.tls, "ssl_handshake_timeout": HANDSHAKE_S} if address.tls else {}
    async with AsyncExitStack() as stack:
        shared = {"reuse_port": True} if address.shared else {}
        server = await stack.enter_async_context(
            serve(app.handle, address.host, address.port, **options, **tls, **shared)  # type: ignore[arg-type]
        )
        if address.private:
            await stack.enter_async_context(unix_serve(app.handle, str(address.private), **options))
        app.lobby.open()
        try:
            yield server
        finally:
            app.draining = True
            server.close(close_connections=False)
            await app.lobby.drain(drain_s)
            await _goodbye(app.lobby)
            await app.lobby.aclose()
            await asyncio.gather(*(c.close(1001) for c in server.connections), return_exceptions=True)


async def _goodbye(lobby: Lobby) -> None:
    try:
        async with asyncio.timeout(GOODBYE_S):
            await lobby.goodbye("the server is going down")
    except TimeoutError:
        log.warning("some clients did not say goodbye")
