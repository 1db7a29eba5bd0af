"""One port for everything: the page, the client, the heads, and the websocket."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import AsyncIterator, Sequence
from contextlib import asynccontextmanager
from http import HTTPStatus

from websockets.asyncio.server import Server, ServerConnection, serve
from websockets.datastructures import Headers
from websockets.exceptions import NegotiationError
from websockets.http11 import Request, Response
from websockets.typing import Subprotocol

from fapstream.protocol import adapting
from fapstream.protocol import generated as g
from fapstream.server.adapting import Adapting
from fapstream.server.connection import Connection, Gate
from fapstream.server.http import Answer, Site
from fapstream.server.link import WebSocketLink
from fapstream.server.lobby import Lobby
from fapstream.server.service import Service

log = logging.getLogger("fapstream.server")

WEBSOCKET_PATH = "/ws"
QUEUE_FRAMES = 16
GOODBYE_S = 2.0


class App:
    """The server's state: who is connected."""

    def __init__(
        self, service: Service, site: Site, lobby: Lobby, gate: Gate, pages: Adapting | None = None
    ) -> None:
        self.lobby = lobby
        self._service = service
        self._site = site
        self._gate = gate
        self._pages = pages

    async def handle(self, socket: ServerConnection) -> None:
        """One websocket from its handshake to its end."""
        if socket.subprotocol == adapting.SUBPROTOCOL and self._pages:
            socket.protocol.max_message_size = adapting.MAX_MESSAGE_BYTES
            await self._pages.handle(socket)
            return
        link = WebSocketLink(socket)
        address = socket.remote_address[0] if socket.remote_address else ""
        await Connection(link, address, self._service, self.lobby, self._gate).run()

    def http(self, socket: ServerConnection, request: Request) -> Response | None:
        """Answer a plain request; None lets a websocket handshake go on."""
        path = request.path.partition("?")[0]
        sockets = (WEBSOCKET_PATH, adapting.PATH) if self._pages else (WEBSOCKET_PATH,)
        if path in sockets and "upgrade" in request.headers.get("Connection", "").lower():
            return None
        if path in sockets:
            return _response(Answer(426, (("Upgrade", "websocket"),), b"This address speaks WebSocket.\n"))
        headers = request.headers
        return _response(
            self._site.answer(path, headers.get("Accept-Encoding", ""), headers.get("If-None-Match", ""))
        )


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


@asynccontextmanager
async def running(app: App, host: str, port: int) -> AsyncIterator[Server]:
    """The server, listening. Leaving says goodbye to everyone and closes.

    Raises OSError.
    """
    async with serve(
        app.handle,
        host,
        port,
        process_request=app.http,
        select_subprotocol=_subprotocol,
        compression=None,
        max_size=g.MAX_MESSAGE_BYTES,
        max_queue=QUEUE_FRAMES,
        close_timeout=GOODBYE_S,
        logger=logging.getLogger("fapstream.websockets"),
    ) as server:
        app.lobby.open()
        try:
            yield server
        finally:
            try:
                async with asyncio.timeout(GOODBYE_S):
                    await app.lobby.goodbye("the server is going down")
            except TimeoutError:
                log.warning("some clients did not say goodbye")
            await app.lobby.aclose()
