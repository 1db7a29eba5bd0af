"""Sessions fuzzed against the state table: whatever a client does in whatever order, over connections that
break, every error is typed, every turn has one end, sound has no gap, and nothing is left behind.
"""

from __future__ import annotations

import asyncio
import json
from pathlib import Path
from typing import Any

from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, precondition, rule

from fapstream.protocol import generated as g
from fapstream.protocol.codec import decode, encode
from tests.unit.fakes import FakeVoices, VirtualLoop
from tests.unit.server.peer import Peer, World

ERRORS = {
    e["code"] for e in json.loads((Path(__file__).parents[3] / "protocol/schema/errors.json").read_text())
}
TURNS = st.integers(1, 6)
TEXTS = st.sampled_from(
    [b"", b"one ", b"One two three. ", b"Four five. Six seven eight! ", b"\xce", b"\xb1 "]
)


class Client(RuleBasedStateMachine):
    """One client that does anything, and a quiet one whom nothing may disturb."""

    def __init__(self) -> None:
        super().__init__()
        self.loop = VirtualLoop()
        self.world = self.run(self._world())
        self.quiet = self._dial(g.Hello())
        self.connect()

    # what it does

    def connect(self) -> None:
        """A fresh session."""
        self.peer = self._dial(g.Hello())
        self.last = self.received = 0
        self.open: set[int] = set()
        self.ends: dict[int, int] = {}
        self.closed = False
        self.listen()

    @rule(turn=TURNS, text=TEXTS, voice=st.sampled_from([None, None, "gr2", "nobody"]))
    def speak(self, turn: int, text: bytes, voice: str | None) -> None:
        if turn > self.last and not self.closed:
            self.last = turn
            self.open.add(turn)
        self.send(g.Speak(turn=turn, text=text, voice=voice))

    @rule(turn=TURNS, kind=st.sampled_from([g.End, g.Interrupt, g.Pause, g.Continue]))
    def steer(self, turn: int, kind: Any) -> None:
        self.send(kind(turn=turn))

    @rule(turn=TURNS, char=st.integers(0, 60), heard=st.none() | st.integers(0, 90_000))
    def splice(self, turn: int, char: int, heard: int | None) -> None:
        self.send(g.Splice(turn=turn, char=char, heard=heard))

    @rule(turn=TURNS, back=st.integers(0, 3))
    def seek(self, turn: int, back: int) -> None:
        self.send(g.Seek(turn=turn, back=back))

    @rule(turn=TURNS, sample=st.integers(0, 2**40), says=st.booleans())
    def acknowledge(self, turn: int, sample: int, says: bool) -> None:
        received = self.received if says else None
        self.send(g.Ack(turn=turn, sample=sample, queue=0, underruns=0, skew=0, received=received))

    @rule(data=st.binary(max_size=12))
    def rubbish(self, data: bytes) -> None:
        if not self.closed:
            self.peer.raw(data)
            self.wait(0.01)

    @rule(seconds=st.sampled_from([0.01, 0.5, 3.0, 20.0]))
    def wait(self, seconds: float) -> None:
        self.run(asyncio.sleep(seconds))
        self.listen()

    @precondition(lambda self: not self.closed)
    @rule(seconds=st.sampled_from([0.0, 2.0, 15.0, 40.0]))
    def lose_the_connection(self, seconds: float) -> None:
        """And come back with what was received."""
        self.listen()
        if self.closed:
            return
        key = self.ready.resume
        self.peer.socket.cut()
        self.run(self.peer.running)
        self.run(asyncio.sleep(seconds))
        self.peer = self._dial(g.Hello(resume=key, received=self.received))
        resumed = bool(self.ready.resumed)
        assert resumed or seconds > g.LINGER_MS / 1000 - 1
        if not resumed:
            self.last = self.received = 0
            self.open, self.ends = set(), {}
        self.listen()

    @precondition(lambda self: self.closed)
    @rule()
    def start_anew(self) -> None:
        self.connect()

    # what is so at any time

    @invariant()
    def nobody_else_is_disturbed(self) -> None:
        self.quiet.send(g.Ping(id=7))
        assert isinstance(self.run(self.quiet.next()), g.Pong)

    def listen(self) -> None:
        """Take everything that has come, and hold it against what may come."""
        self.run(asyncio.sleep(0))
        while not self.peer.quiet():
            message = decode(self.peer.socket.to_client.get_nowait(), "server")
            assert message is not None
            self.received += message.type not in g.EPHEMERAL
            self.check(message)

    def check(self, message: g.Message) -> None:
        match message:
            case g.Error():
                assert message.code in ERRORS - {"internal"}
                self.closed = self.closed or message.fatal
            case g.Begin():
                assert message.turn in self.open
                self.ends[message.turn] = 0
            case g.Packet():
                assert message.turn in self.open
                assert message.sample == self.ends[message.turn]
                assert message.pcm is not None
                self.ends[message.turn] += len(message.pcm)
            case g.Discard():
                self.ends[message.turn] = min(self.ends[message.turn], message.sample)
            case g.Done():
                assert message.turn in self.open
                self.open.discard(message.turn)
                assert message.samples == self.ends.get(message.turn, 0)
                assert message.heard is None or message.heard <= message.samples
            case g.Bye():
                self.closed = True
            case _:
                pass

    def teardown(self) -> None:
        if not self.closed:
            for turn in tuple(self.open):
                self.send(g.Continue(turn=turn), g.Interrupt(turn=turn))
            self.wait(60)
            assert self.closed or not self.open, "every turn has an end"
            self.peer.socket.cut()
        self.quiet.socket.cut()
        self.run(asyncio.sleep(g.LINGER_MS / 1000 + 2))
        assert self.world.gate.inside == 0
        assert all(voice.closes == 1 for voice in self.world.voices.acquired)
        self.run(self.world.lobby.aclose())
        left = [t for t in asyncio.all_tasks(self.loop) if not t.done()]
        assert not left, left
        self.loop.close()

    # how it is done

    def send(self, *messages: g.ClientMessage) -> None:
        if not self.closed:
            self.peer.send(*messages)
            self.run(asyncio.sleep(0.001))
            self.listen()

    def run(self, what: Any) -> Any:
        return self.loop.run_until_complete(what)

    async def _world(self) -> World:
        return World(FakeVoices())

    def _dial(self, hello: g.Hello) -> Peer:
        async def dial() -> tuple[Peer, g.Ready]:
            peer = Peer(self.world.voices, world=self.world)
            peer.socket.to_server.put_nowait(encode(hello))
            ready = await peer.next()
            assert isinstance(ready, g.Ready)
            return peer, ready

        peer, self.ready = self.run(dial())
        return peer


TestSessions = Client.TestCase
TestSessions.settings = settings(max_examples=60, stateful_step_count=25, deadline=None)
