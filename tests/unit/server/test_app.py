"""One port for HTTP and the websocket, over real loopback sockets."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from typing import Any

import pytest
from websockets.asyncio.client import ClientConnection, connect
from websockets.asyncio.server import Server
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.typing import Subprotocol

from fapstream.protocol import generated as g
from fapstream.protocol.codec import decode, encode
from fapstream.server import Address, Site, running
from tests.unit.fakes import FakeVoices, fake_app

PROTOCOLS = [Subprotocol(g.SUBPROTOCOL)]


@pytest.fixture
async def server() -> AsyncIterator[Server]:
    async with running(fake_app(), Address()) as made:
        yield made


def port(server: Server) -> int:
    return int(server.sockets[0].getsockname()[1])


def url(server: Server) -> str:
    return f"ws://127.0.0.1:{port(server)}/ws"


async def get(
    server: Server, path: str, *headers: str, method: str = "GET"
) -> tuple[int, dict[str, str], bytes]:
    """(status, headers, body) of a plain HTTP request."""
    reader, writer = await asyncio.open_connection("127.0.0.1", port(server))
    lines = [f"{method} {path} HTTP/1.1", "Host: x", *headers, "", ""]
    writer.write("\r\n".join(lines).encode())
    answer = await asyncio.wait_for(reader.read(), 5)
    writer.close()
    head, _, body = answer.partition(b"\r\n\r\n")
    status, *fields = head.decode().split("\r\n")
    return int(status.split()[1]), dict(f.lower().split(": ", 1) for f in fields), body


async def receive(socket: ClientConnection) -> Any:
    data = await asyncio.wait_for(socket.recv(), 5)
    assert isinstance(data, bytes)
    return decode(data, "server")


async def binary(socket: ClientConnection) -> AsyncIterator[bytes]:
    """Every message until the connection ends."""
    async with asyncio.timeout(5):
        async for data in socket:
            assert isinstance(data, bytes)
            yield data


async def test_files(server: Server) -> None:
    status, headers, body = await get(server, "/heads/generic.glb")
    assert status == 200
    assert headers["content-type"] == "model/gltf-binary"
    assert headers["access-control-allow-origin"] == "*"
    assert int(headers["content-length"]) == len(body)
    assert body == Site().answer("/heads/generic.glb").body
    status, _, body = await get(server, "/heads/generic.glb?x", f"If-None-Match: {headers['etag']}")
    assert (status, body) == (304, b"")
    status, headers, _ = await get(server, "/", "Accept-Encoding: gzip")
    assert (status, headers["content-encoding"]) == (200, "gzip")
    assert (await get(server, "/../../etc/passwd"))[0] == 404


async def test_the_websockets_address_wants_a_websocket(server: Server) -> None:
    status, headers, body = await get(server, "/ws")
    assert (status, headers["upgrade"]) == (426, "websocket")
    assert b"WebSocket" in body


@pytest.mark.parametrize("offered", [None, [Subprotocol("fapstream.v9")]])
async def test_a_handshake_without_the_subprotocol_is_refused(
    server: Server, offered: list[Subprotocol] | None
) -> None:
    with pytest.raises(InvalidStatus) as caught:
        await connect(url(server), subprotocols=offered)
    assert caught.value.response.status_code == 400
    assert g.SUBPROTOCOL.encode() in (caught.value.response.body or b"")


async def test_a_websocket_elsewhere_is_refused(server: Server) -> None:
    with pytest.raises(InvalidStatus) as caught:
        await connect(url(server) + "x", subprotocols=PROTOCOLS)
    assert caught.value.response.status_code == 404


@pytest.mark.parametrize("garbage", [b"\x16\x03\x01\x02\x00\x01", b"GET / HTTP/9.9\r\n\r\n", b"A" * 70000])
async def test_what_is_no_http_hurts_nobody(server: Server, garbage: bytes) -> None:
    _, writer = await asyncio.open_connection("127.0.0.1", port(server))
    writer.write(garbage)
    async with connect(url(server), subprotocols=PROTOCOLS) as socket:
        await socket.send(encode(g.Hello()))
        assert isinstance(await receive(socket), g.Ready)
    writer.close()


async def test_a_turn_over_a_real_socket(server: Server) -> None:
    async with connect(url(server), subprotocols=PROTOCOLS) as socket:
        assert socket.subprotocol == g.SUBPROTOCOL
        assert "Sec-WebSocket-Extensions" not in (socket.response.headers if socket.response else {})
        await socket.send(encode(g.Hello(fps=50)))
        assert (await receive(socket)).heads == ("generic",)
        await socket.send(encode(g.Speak(turn=1, text="Hello wörld.".encode())))
        await socket.send(encode(g.End(turn=1)))
        at = 0
        assert isinstance(await receive(socket), g.Begin)
        while isinstance(message := await receive(socket), g.Packet):
            assert message.sample == at
            at += len(message.pcm)
        assert message == g.Done(turn=1, reason="end", samples=at)


async def test_a_message_that_is_too_long_closes_the_session(server: Server) -> None:
    async with connect(url(server), subprotocols=PROTOCOLS) as socket:
        await socket.send(encode(g.Hello()))
        await receive(socket)
        await socket.send(b"\0" * (g.MAX_MESSAGE_BYTES + 1))
        with pytest.raises(ConnectionClosed) as caught:
            await asyncio.wait_for(socket.recv(), 5)
        assert caught.value.rcvd
        assert caught.value.rcvd.code == 1009


async def test_going_down_says_goodbye_and_gives_the_voices_back() -> None:
    voices = FakeVoices()
    async with running(fake_app(voices), Address()) as server:
        socket = await connect(url(server), subprotocols=PROTOCOLS)
        await socket.send(encode(g.Hello()))
        await socket.send(encode(g.Speak(turn=1, text=b"Hello there, this is long. " * 20)))
        while not isinstance(await receive(socket), g.Packet):
            pass
        quiet = await connect(url(server), subprotocols=PROTOCOLS)
    messages = [decode(data, "server") async for data in binary(socket)]
    assert isinstance(messages[-1], g.Bye)
    assert messages[-1].reason
    assert not any(isinstance(m, g.Error) for m in messages)
    assert [v.closes for v in voices.acquired] == [1]
    assert not [data async for data in binary(quiet)]
    assert quiet.close_code == 1001
    assert not server.is_serving()


async def test_a_port_that_is_taken_is_told(server: Server) -> None:
    with pytest.raises(OSError, match="address already in use"):
        async with running(fake_app(), Address(port=port(server))):
            pass
