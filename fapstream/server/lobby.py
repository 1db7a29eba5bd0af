"""Who is there: conversations by the key that resumes them, channels by name."""

from __future__ import annotations

import asyncio
import logging
import secrets
from collections.abc import Callable, Coroutine
from contextlib import aclosing, suppress
from dataclasses import dataclass, field, replace
from typing import Any

from fapstream.errors import Busy, InputError
from fapstream.ports import Bus
from fapstream.protocol import generated as g
from fapstream.protocol.codec import encode
from fapstream.protocol.session import ServerSession
from fapstream.server.channel import BEAT_S, Channel, Stage
from fapstream.server.conversation import Conversation
from fapstream.server.link import Link
from fapstream.server.listener import Listening
from fapstream.server.service import Service

log = logging.getLogger("fapstream.server")

SHARED = "talk-"
"""What the name of a shared session's own channel begins with."""


SETTLE_S = 0.1
"""What a bus brings at first was spoken before: who listens is told only what becomes of it."""

DRAIN_STEP_S = 0.05
BACK_UP_MS = 3000
"""When a server that goes down may be up again."""


class UnknownChannel(InputError):
    """There is no such channel."""

    code = "unknown_channel"

    def __init__(self, name: str, known: tuple[str, ...]) -> None:
        there = f"; there are: {', '.join(known)}" if known else ": this server has none, see serve --channel"
        super().__init__(f"no channel called {name[:40]!r}{there}")
        self.name = name


@dataclass(slots=True)
class _Guest:
    """A conversation and what goes with it."""

    conversation: Conversation
    leave: Callable[[], None]
    key: str = ""
    stage: Stage | None = None
    tasks: list[asyncio.Task[None]] = field(default_factory=list)


@dataclass(slots=True)
class _Open:
    """A channel somebody listens to, and the task that brings its entries."""

    channel: Channel
    task: asyncio.Task[None]
    listeners: dict[Listening, Link] = field(default_factory=dict)
    settled: asyncio.Task[None] | None = None
    """Done once what the bus had before has come."""


class Lobby:
    """`index`: this process's among its siblings; it is part of resumption keys."""

    def __init__(
        self, service: Service, bus: Bus, channels: tuple[str, ...] = (), index: int = 0,
        listen_token: Callable[[str], str | None] = lambda _: None,
    ) -> None:  # fmt: skip
        self._service = service
        self._bus = bus
        self._names = channels
        self._index = index
        self._listen_token = listen_token
        self._guests: dict[str, _Guest] = {}
        self._channels: dict[str, _Open] = {}
        self._lingering: set[asyncio.Task[None]] = set()
        self._keeper: asyncio.Task[None] | None = None
        self._draining = False

    def open(self) -> None:
        """Begin to look after who is there."""
        self._keeper = asyncio.create_task(self._keep())

    # those who speak

    def enter(
        self, session: ServerSession, hello: g.Hello, link: Link, leave: Callable[[], None]
    ) -> Conversation:
        """A new conversation, greeted. `leave` is called when it is over. Raises UnknownChannel, Busy."""
        if self._draining:
            raise Busy("the server is going down", BACK_UP_MS)
        if hello.channel is not None and hello.channel not in self._names:
            raise UnknownChannel(hello.channel, self._names)
        conversation = Conversation(self._service, session, hello)
        guest = _Guest(conversation, leave)
        name = hello.channel or (SHARED + secrets.token_hex(8) if hello.share else None)
        if name:
            guest.stage = conversation.audience = Stage(self._bus, name, conversation.id)
            guest.tasks.append(asyncio.create_task(self._watch(guest.stage, conversation)))
        guest.key = f"{self._index}.{secrets.token_urlsafe(24)}"
        self._guests[guest.key] = guest
        conversation.start(link)
        link.write(session.send(self._ready(guest)))
        return conversation

    def resume(self, hello: g.Hello, link: Link) -> Conversation | None:
        """The conversation whose key is shown, going on over `link`; None if it cannot."""
        guest = self._guests.get(hello.resume or "")
        if guest is None:
            return None
        conversation, old = guest.conversation, guest.conversation.link
        again = conversation.attach(link, hello.received or 0)
        if again is None:
            return None
        ready = replace(self._ready(guest), resumed=True, received=conversation.session.received)
        link.write(conversation.session.send(ready))
        for data in again:
            link.write(data)
        if old:
            self._later(old.close(1000, "resumed over another connection"))
        return conversation

    def elsewhere(self, key: str | None) -> int | None:
        """The process that has the conversation of a key, if it is not this one."""
        head, dot, _ = (key or "").partition(".")
        if not dot or not head.isascii() or not head.isdecimal() or len(head) > 4:
            return None
        return None if int(head) == self._index else int(head)

    def lost(self, conversation: Conversation, link: Link) -> None:
        """A connection is gone. Unless its client said goodbye it may come back within half a minute."""
        if conversation.link not in (link, None):
            return
        conversation.detach(link)
        closed = conversation.session.state == "closed"
        self._later(self._forget(conversation, conversation.links, 0 if closed else g.LINGER_MS / 1000))

    async def _forget(self, conversation: Conversation, links: int, wait_s: float) -> None:
        """Give it up unless it has another connection meanwhile, even one that was lost again."""
        await asyncio.sleep(wait_s)
        guest = next((x for x in self._guests.values() if x.conversation is conversation), None)
        if guest and conversation.links == links:
            await self._end(guest)

    async def _end(self, guest: _Guest) -> None:
        self._guests.pop(guest.key, None)
        for task in guest.tasks:
            task.cancel()
        await guest.conversation.aclose()
        if guest.stage:
            guest.stage.close()
        guest.leave()

    def _ready(self, guest: _Guest) -> g.Ready:
        name = guest.stage.name if guest.stage else None
        token = self._listen_token(name) if name else None
        return replace(guest.conversation.ready(), resume=guest.key, channel=name, listen=token)

    async def _watch(self, stage: Stage, conversation: Conversation) -> None:
        """Give way when somebody else speaks into the channel."""
        async with aclosing(self._bus.subscribe(stage.name)) as entries:
            async for entry in entries:
                if stage.overtaken(entry):
                    conversation.audience = None
                    await conversation.fail("channel_taken", f"somebody else speaks into {stage.name} now")
                    return

    # those who listen

    def listen(self, listening: Listening, link: Link, wish: g.Listen) -> None:
        """A listener comes, greeted already. Raises UnknownChannel."""
        there = self._channels.get(wish.channel)
        if there is None:
            channel = Channel(wish.channel, self._service.clock.now)
            there = _Open(channel, asyncio.create_task(self._bring(channel)))
            there.settled = asyncio.create_task(asyncio.sleep(SETTLE_S))
            self._channels[wish.channel] = there
        listening.channel = there.channel
        there.listeners[listening] = link
        if there.settled and not there.settled.done():
            there.settled.add_done_callback(lambda _: self._join(there, listening, wish))
        else:
            self._join(there, listening, wish)

    def _join(self, there: _Open, listening: Listening, wish: g.Listen) -> None:
        if listening not in there.listeners:
            return  # it did not wait
        after = None
        if wish.talk is not None and wish.turn is not None:
            after = (wish.talk, wish.turn, wish.sample or 0)
        there.channel.join(listening, after)

    def check_channel(self, name: str) -> None:
        """Raises UnknownChannel for a name that nobody can speak into."""
        if name not in self._names and not name.startswith(SHARED):
            raise UnknownChannel(name, self._names)

    def deafen(self, listening: Listening) -> None:
        """A listener is gone."""
        channel = listening.channel
        there = self._channels.get(channel.name) if channel else None
        if there is None or there.listeners.pop(listening, None) is None:
            return
        there.channel.leave(listening)

    async def _bring(self, channel: Channel) -> None:
        async with aclosing(self._bus.subscribe(channel.name)) as entries:
            async for entry in entries:
                channel.take(entry)

    # housekeeping

    @property
    def speaking(self) -> int:
        """Conversations with turns that are not done, as far as somebody is there to hear them."""
        there = (guest.conversation for guest in self._guests.values() if guest.conversation.link)
        return sum(conversation.busy for conversation in there)

    async def _keep(self) -> None:
        while True:
            await asyncio.sleep(BEAT_S)
            for guest in self._guests.values():
                if guest.stage:
                    guest.stage.beat()
            for there in list(self._channels.values()):
                await self._keep_channel(there)
            self._report()

    def _report(self) -> None:
        meter, guests = self._service.meter, self._guests.values()
        meter.level("sessions", len(guests))
        meter.level("listeners", sum(len(there.listeners) for there in self._channels.values()))
        meter.level("outbox_packets", sum(x.conversation.session.sent.weight for x in guests) // g.PACKET_MS)
        meter.level("text_waiting", sum(x.conversation.text_waiting for x in guests))

    async def _keep_channel(self, there: _Open) -> None:
        if not there.listeners:
            del self._channels[there.channel.name]
            there.task.cancel()
            return
        there.channel.look()
        for listening, link in list(there.listeners.items()):
            if listening.hopeless:
                self._service.meter.count("dropped", label="closed")
                self.deafen(listening)
                self._later(_let_go(link))

    async def drain(self, most_s: float) -> None:
        """Take nothing new, and wait until nobody speaks any longer, or so many seconds."""
        self._draining = True
        with suppress(TimeoutError):
            async with asyncio.timeout(most_s):
                while self.speaking:
                    await asyncio.sleep(DRAIN_STEP_S)

    async def goodbye(self, reason: str) -> None:
        """Tell everyone that the server goes down."""
        goodbyes = [guest.conversation.goodbye(reason) for guest in self._guests.values()]
        for there in self._channels.values():
            goodbyes += [_part(link, reason) for link in there.listeners.values()]
        await asyncio.gather(*goodbyes, return_exceptions=True)

    async def aclose(self) -> None:
        """End everything that is still there."""
        tasks = [*self._lingering, *(there.task for there in self._channels.values())]
        if self._keeper:
            tasks.append(self._keeper)
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
        for guest in list(self._guests.values()):
            await self._end(guest)

    def _later(self, work: Coroutine[Any, Any, None]) -> None:
        task = asyncio.create_task(work)
        self._lingering.add(task)
        task.add_done_callback(self._lingering.discard)


async def _part(link: Link, reason: str) -> None:
    link.write(encode(g.Bye(reason=reason)))
    await link.close(1001, reason)


async def _let_go(link: Link) -> None:
    message = "the connection takes less than is spoken; try again on a better one"
    link.write(encode(g.Error(code="too_slow", message=message, fatal=True)))
    await link.close(1013, "too slow")
