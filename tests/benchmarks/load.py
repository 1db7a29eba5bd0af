"""Clients by the hundred in one process: raw websockets that cost little, so that the server is measured.

They speak the protocol as SPEC.md has it, and look only at what they need.
"""

from __future__ import annotations

import asyncio
import os
import resource
import struct
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import msgpack

from fapstream.protocol import generated as g
from fapstream.protocol.codec import encode
from fapstream.stream.pacer import GROUP_S, LEAD_S, Pacer

ACK_S = 0.25
START_S = 0.06
"""Sound in store before a simulated card starts."""

SENTENCES = {
    "en": (
        "The quick brown fox jumps over the lazy dog while seven birds watch from a branch of the tree. ",
        "Nobody had expected the second train to arrive before noon, least of all the stationmaster. ",
        "In nineteen eighty four the harbour froze over, and people walked to the islands across the ice. ",
        "She asked whether the letters had come; they had not, and would not for another week. ",
        "Bread, cheese, a few olives and half a bottle of wine were all that was left on the table. ",
    ),
    "el": (
        "Η θάλασσα ήταν ήρεμη εκείνο το πρωί, και τα καΐκια γύριζαν αργά στο λιμάνι. ",
        "Κανείς δεν περίμενε ότι το δεύτερο τρένο θα έφτανε πριν από το μεσημέρι. ",
        "Ρώτησε αν είχαν έρθει τα γράμματα, μα δεν είχαν έρθει ακόμη. ",
    ),
}


def raise_file_limit() -> None:
    """As many sockets as the system allows."""
    _, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (hard, hard))


Take = Callable[[bytes], None]
Lost = Callable[[], None]


class RawSocket(asyncio.Protocol):
    """A websocket client of few microseconds a message. `take` gets every binary message."""

    def __init__(self, host: str, take: Take, lost: Lost = lambda: None) -> None:
        self._host = host
        self._take = take
        self._lost = lost
        self._data = bytearray()
        self._open = False
        self.opened: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        self.closed = False

    def connection_made(self, transport: Any) -> None:
        self.transport = transport
        transport.write(
            (
                f"GET /ws HTTP/1.1\r\nHost: {self._host}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\nSec-WebSocket-Version: 13\r\n"
                f"Sec-WebSocket-Protocol: {g.SUBPROTOCOL}\r\n\r\n"
            ).encode()
        )

    def data_received(self, data: bytes) -> None:
        buffer = self._data
        buffer += data
        if not self._open:
            end = buffer.find(b"\r\n\r\n")
            if end < 0:
                return
            if not buffer.startswith(b"HTTP/1.1 101"):
                self.opened.set_exception(ConnectionError(bytes(buffer[:200]).decode("latin-1")))
                self.transport.abort()
                return
            del buffer[: end + 4]
            self._open = True
            self.opened.set_result(None)
        while (frame := self._frame()) is not None:
            opcode, payload = frame
            if opcode == 2:
                self._take(payload)
            elif opcode == 9:
                self._write(0x8A, payload)
            elif opcode == 8:
                self._write(0x88, payload)
                self.transport.close()

    def _frame(self) -> tuple[int, bytes] | None:
        buffer = self._data
        if len(buffer) < 2:
            return None
        length, at = buffer[1] & 127, 2
        if length == 126:
            if len(buffer) < 4:
                return None
            length, at = struct.unpack_from(">H", buffer, 2)[0], 4
        elif length == 127:
            if len(buffer) < 10:
                return None
            length, at = struct.unpack_from(">Q", buffer, 2)[0], 10
        if len(buffer) < at + length:
            return None
        frame = buffer[0] & 15, bytes(buffer[at : at + length])
        del buffer[: at + length]
        return frame

    def send(self, message: g.ClientMessage) -> None:
        """One message; the mask is zero."""
        self._write(0x82, encode(message))

    def _write(self, head: int, payload: bytes) -> None:
        n = len(payload)
        size = (
            bytes((128 | n,))
            if n < 126
            else struct.pack(">BH", 254, n)
            if n < 65536
            else struct.pack(">BQ", 255, n)
        )
        self.transport.write(bytes((head,)) + size + b"\0\0\0\0" + payload)

    def connection_lost(self, exc: Exception | None) -> None:
        self.closed = True
        if not self.opened.done():
            self.opened.set_exception(exc or ConnectionError("closed"))
        self._lost()


async def connect(address: str, take: Take, lost: Lost = lambda: None) -> RawSocket:
    """A socket to the server at `address` (host:port)."""
    host, _, port = address.rpartition(":")
    _, socket = await asyncio.get_running_loop().create_connection(
        lambda: RawSocket(address, take, lost), host, int(port)
    )
    await socket.opened
    return socket


@dataclass(slots=True)
class Tally:
    """What talkers saw since `clear`."""

    lateness_ms: list[float] = field(default_factory=list)
    first_ms: list[float] = field(default_factory=list)
    underruns: int = 0
    errors: list[str] = field(default_factory=list)
    sound_s: float = 0.0

    def clear(self) -> None:
        self.lateness_ms.clear()
        self.first_ms.clear()
        self.underruns = 0
        self.sound_s = 0.0


class Talker:
    """Has one turn after another spoken, acknowledges as a card would play, and notes what is late."""

    def __init__(
        self,
        number: int,
        tally: Tally,
        voices: list[tuple[str, str]],
        sentences: int = 3,
        channel: str | None = None,
    ) -> None:
        self.number = number
        self._sentences = sentences
        self._channel = channel
        self._tally = tally
        self._voice, self._lang = voices[number % len(voices)]
        self._turn = 0
        self._asked = self._first = 0.0
        self._rate = 16000
        self._received = self._messages = 0
        self._play: float | None = None
        self._socket: RawSocket | None = None
        self._acks: asyncio.TimerHandle | None = None
        self.stopping = False

    async def start(self, address: str) -> None:
        """Connect and begin to speak."""
        self._socket = await connect(address, self._take, self._stop_acks)
        self._socket.send(g.Hello(client="load", channel=self._channel))

    def stop(self) -> None:
        """Leave."""
        self.stopping = True
        self._stop_acks()
        if self._socket and not self._socket.closed:
            self._socket.send(g.Bye())
            self._socket.transport.close()

    def _stop_acks(self) -> None:
        if self._acks:
            self._acks.cancel()

    def _speak(self) -> None:
        sentences = SENTENCES[self._lang]
        k = self.number + 3 * self._turn
        text = "".join(sentences[(k + i * (1 + k % 3)) % len(sentences)] for i in range(self._sentences))
        self._turn += 1
        self._received, self._play = 0, None
        assert self._socket
        self._asked = time.perf_counter()
        self._socket.send(g.Speak(turn=self._turn, text=text.encode(), voice=self._voice, lang=self._lang))
        self._socket.send(g.End(turn=self._turn))

    def _take(self, data: bytes) -> None:
        message = msgpack.unpackb(data)
        kind = message["type"]
        self._messages += kind not in g.EPHEMERAL
        if kind == "packet":
            self._packet(message)
        elif kind == "begin":
            self._rate = message["sample_rate"]
        elif kind == "done":
            if message["reason"] != "end":
                self._tally.errors.append(str(message))
            if not self.stopping:
                self._later()
        elif kind == "ready":
            self._speak()
            self._ack()
        elif kind == "error":
            self._tally.errors.append(message["code"])

    def _later(self) -> None:
        """The next turn, once this one has been heard."""
        left = self._play_end() - time.perf_counter() if self._play else 0.0
        asyncio.get_running_loop().call_later(
            max(0.0, left), lambda: None if self.stopping else self._speak()
        )

    def _play_end(self) -> float:
        return (self._play or 0.0) + self._received / self._rate

    def _packet(self, message: dict[str, Any]) -> None:
        now = time.perf_counter()
        start = message["sample"] / self._rate
        samples = len(message["pcm"]) // 2
        if message["sample"] == 0:
            self._first = now
            self._pacer = Pacer(self._rate, LEAD_S - GROUP_S, GROUP_S)
            self._pacer.sent(0, 0, now)
            self._tally.first_ms.append(1000 * (now - self._asked))
        due = max(self._first, self._pacer.due(message["sample"], now))
        self._tally.lateness_ms.append(1000 * (now - due))
        if self._play is not None and now > self._play + start:
            self._tally.underruns += 1
            self._play = now - start
        self._received += samples
        self._tally.sound_s += samples / self._rate
        if self._play is None and self._received >= START_S * self._rate:
            self._play = now

    def _ack(self) -> None:
        self._acks = asyncio.get_running_loop().call_later(ACK_S, self._ack)
        if self._play is None or not self._socket or self._socket.closed:
            return
        heard = max(0, min(self._received, int((time.perf_counter() - self._play) * self._rate)))
        self._socket.send(
            g.Ack(turn=self._turn, sample=heard, queue=self._received - heard, underruns=0, skew=0,
                  received=self._messages)
        )  # fmt: skip


# what it costs


def tree(pid: int) -> list[int]:
    """A process and all that descend from it."""
    found, todo = [], [pid]
    while todo:
        one = todo.pop()
        found.append(one)
        try:
            for task in os.listdir(f"/proc/{one}/task"):
                with open(f"/proc/{one}/task/{task}/children") as f:
                    todo += [int(child) for child in f.read().split()]
        except OSError:
            continue
    return found


def cpu_s(pid: int) -> dict[str, float]:
    """CPU seconds of a process tree so far, by the name of the program."""
    tick = os.sysconf("SC_CLK_TCK")
    out: dict[str, float] = {}
    for one in tree(pid):
        try:
            with open(f"/proc/{one}/stat") as f:
                name, rest = f.read().split("(", 1)[1].rsplit(")", 1)
        except OSError:
            continue
        fields = rest.split()
        out[name] = out.get(name, 0.0) + (int(fields[11]) + int(fields[12])) / tick
    return out


def pss_kb(pid: int) -> int:
    """Memory of a process tree, shared pages by share."""
    total = 0
    for one in tree(pid):
        try:
            with open(f"/proc/{one}/smaps_rollup") as f:
                total += sum(int(line.split()[1]) for line in f if line.startswith("Pss:"))
        except OSError:
            continue
    return total


async def speak_on(address: str, n: int, voices: list[tuple[str, str]]) -> None:
    """So many talkers until the process is ended; says `up` once all speak."""
    talkers = [Talker(number, Tally(), voices) for number in range(n)]
    for talker in talkers:
        await talker.start(address)
        await asyncio.sleep(0.03)
    print("up", flush=True)
    await asyncio.Event().wait()


if __name__ == "__main__":
    raise_file_limit()
    asyncio.run(speak_on(sys.argv[1], int(sys.argv[2]), [("us1", "en"), ("us2", "en"), ("gr2", "el")]))
