"""The editor page's socket: one thing at a time, only the newest points, and no more pages than there may
be.
"""

from __future__ import annotations

import asyncio
import random
import threading
import time
from typing import Any

import pytest
from websockets.asyncio.client import connect
from websockets.exceptions import InvalidStatus
from websockets.typing import Subprotocol

from fapstream.errors import InputError
from fapstream.protocol import adapting
from fapstream.protocol.adapting import decode, encode
from fapstream.server import Adapting, Address, running
from fapstream.server.adapting import MOST_WAITING, Message
from fapstream.server.admission import Admission, Limits
from fapstream.server.gate import Gate
from fapstream.server.tokens import Grant, mint
from tests.unit.fakes import LoopClock, OpenGate, fake_app
from tests.unit.server.peer import FakeLink
from tests.unit.server.test_app import port


class Work:
    """Answers with what it was given; may be held up."""

    def __init__(self) -> None:
        self.free = threading.Event()
        self.free.set()
        self.seen: list[Message] = []
        self.closed = False

    def ready(self) -> Message:
        return {"type": "ready"}

    def answer(self, message: Message) -> Message:
        self.seen.append(message)
        self.free.wait(5)
        if self.closed:
            return {"type": "error", "code": "internal", "message": "it ended", "fatal": True}
        return {"type": "fit", "seq": message.get("seq"), "size": len(message.get("data", b""))}

    def close(self) -> None:
        self.closed = True
        self.free.set()


class FakeSocket(FakeLink):
    """With a `send` as websockets has it."""

    async def send(self, message: bytes) -> None:
        self.write(message)


class Page:
    """A page on a fake socket."""

    def __init__(self, work: Work | None = None, pages: Adapting | None = None) -> None:
        self.work = work or Work()
        self.socket = FakeSocket()
        pages = pages or Adapting(lambda: self.work, OpenGate())
        self.task = asyncio.create_task(pages.handle(self.socket, "127.0.0.1"))
        self.say(type="hello")

    async def get(self) -> dict[str, Any]:
        return decode(await asyncio.wait_for(self.socket.to_client.get(), 5))

    def say(self, **message: Any) -> None:
        self.socket.to_server.put_nowait(encode(message))

    async def leave(self) -> None:
        self.socket.to_server.put_nowait(None)
        await asyncio.wait_for(self.task, 5)


async def test_messages_are_answered_in_turn() -> None:
    page = Page()
    assert (await page.get())["type"] == "ready"
    page.say(type="photo", seq=1, data=b"123")
    page.say(type="head", seq=2)
    assert [(await page.get())["seq"] for _ in range(2)] == [1, 2]
    await page.leave()


async def test_points_that_are_overtaken_are_not_answered() -> None:
    page = Page()
    await page.get()
    page.work.free.clear()
    page.say(type="points", seq=1)
    while not page.work.seen:
        await asyncio.sleep(0)
    for seq in (2, 3, 4):
        page.say(type="points", seq=seq)
    while page.socket.to_server.qsize():
        await asyncio.sleep(0)
    page.work.free.set()
    assert [(await page.get())["seq"] for _ in range(2)] == [1, 4]
    await page.leave()
    assert [m["seq"] for m in page.work.seen] == [1, 4]


async def test_who_asks_for_too_much_at_once_is_told() -> None:
    page = Page()
    await page.get()
    page.work.free.clear()
    for seq in range(MOST_WAITING + 3):
        page.say(type="photo", seq=seq, data=b"")
    assert (await page.get())["code"] == "busy"
    page.work.free.set()
    assert (await page.get())["type"] in ("fit", "error")
    await page.leave()


async def test_who_leaves_in_the_middle_ends_the_work() -> None:
    page = Page()
    await page.get()
    page.work.free.clear()
    page.say(type="head", seq=1)
    while not page.work.seen:
        await asyncio.sleep(0)
    await page.leave()
    assert page.work.closed


async def test_a_session_that_came_to_its_end_ends_the_page() -> None:
    page = Page()
    await page.get()
    page.work.close()
    page.say(type="head", seq=1)
    assert (await page.get())["code"] == "internal"
    await asyncio.wait_for(page.task, 5)


@pytest.mark.parametrize("data", [b"\xc1", "text", b"\x80"])
async def test_what_is_no_message_ends_the_page(data: bytes | str) -> None:
    page = Page()
    await page.get()
    page.socket.to_server.put_nowait(data)
    answer = await page.get()
    assert (answer["type"], answer["fatal"]) == ("error", True)
    await asyncio.wait_for(page.task, 5)


async def test_a_server_that_cannot_says_why() -> None:
    def refused() -> Work:
        raise InputError("pip install something")

    page = Page(pages=Adapting(refused, OpenGate()))
    answer = await page.get()
    assert answer["fatal"]
    assert "something" in answer["message"]
    await asyncio.wait_for(page.task, 5)


@pytest.mark.parametrize("first", [{"type": "photo", "data": b""}, {"type": "hello", "token": 5}])
async def test_nothing_is_taken_before_hello(first: Message) -> None:
    page = Page()
    page.socket.to_server.get_nowait()
    page.say(**first)
    answer = await page.get()
    assert (answer["code"], answer["fatal"]) == ("protocol", True)
    await asyncio.wait_for(page.task, 5)


async def test_where_tokens_are_asked_for_one_is_needed() -> None:
    secret = b"s" * 32
    gate = Gate(Admission(Limits(), random.Random(1)), LoopClock(), (secret,))
    for grant, code in ((None, "unauthorised"), ("speak", "unauthorised"), ("adapt", None)):
        page = Page(pages=Adapting(lambda: Work(), gate))
        page.socket.to_server.get_nowait()
        token = grant and mint(secret, Grant(frozenset({grant})), 60, time.time())
        page.say(type="hello", token=token)
        assert (await page.get()).get("code") == code
        page.socket.to_server.put_nowait(None)
        await asyncio.wait_for(page.task, 5)


async def test_only_so_many_pages_at_once() -> None:
    most = 4
    rest = iter([Work() for _ in range(most + 1)])
    gate = Gate(Admission(Limits(adapting=most, adapting_per_address=9), random.Random(1)), LoopClock())
    pages = Adapting(lambda: next(rest), gate)
    opened = [Page(pages=pages) for _ in range(most)]
    for page in opened:
        assert (await page.get())["type"] == "ready"
    late = Page(pages=pages)
    assert (await late.get())["code"] == "busy"
    await opened[0].leave()
    again = Page(pages=pages)
    assert (await again.get())["type"] == "ready"
    for page in (*opened[1:], again):
        await page.leave()


async def test_large_photos_go_over_a_real_socket_and_only_there() -> None:
    made = Work()
    async with running(fake_app(pages=Adapting(lambda: made, OpenGate())), Address()) as server:
        url = f"ws://127.0.0.1:{port(server)}"
        spoken = [Subprotocol(adapting.SUBPROTOCOL)]
        async with connect(url + adapting.PATH, subprotocols=spoken) as socket:
            await socket.send(encode({"type": "hello"}))
            assert decode(await socket.recv())["type"] == "ready"
            await socket.send(encode({"type": "photo", "seq": 1, "data": bytes(8 << 20)}))
            assert decode(await socket.recv())["size"] == 8 << 20
        with pytest.raises(InvalidStatus):
            await connect(url + "/ws", subprotocols=spoken)
        with pytest.raises(InvalidStatus):
            await connect(url + adapting.PATH, subprotocols=[Subprotocol("fapstream.v1")])


async def test_a_server_without_an_editor_has_no_such_socket() -> None:
    async with running(fake_app(), Address()) as server:
        with pytest.raises(InvalidStatus) as e:
            await connect(
                f"ws://127.0.0.1:{port(server)}{adapting.PATH}",
                subprotocols=[Subprotocol(adapting.SUBPROTOCOL)],
            )
        assert e.value.response.status_code == 404
