"""The two ends of a conversation without the wire: bytes in, events out; messages in, bytes out.

The tables of protocol/schema/session.json decide what is allowed; this file only walks them.
"""

from __future__ import annotations

import codecs
from dataclasses import dataclass, field
from typing import cast

import numpy as np

from fapstream import records
from fapstream.errors import LocalProtocolError, RemoteProtocolError
from fapstream.protocol import generated as g
from fapstream.protocol.codec import Side, encode, read, unpack
from fapstream.protocol.faps import Changes, FapDecoder, FapEncoder, Row
from fapstream.protocol.packets import pack_packet
from fapstream.protocol.sent import Sent

FAP_NUMBERS = tuple(range(3, 69))
"""The low-level FAPs, in the order in which frames carry them."""

CLIENT_KEEPS_BYTES = 1 << 20
"""What a client keeps for a resumption; with more than this under way it cannot resume."""

Tables = dict[str, dict[str, str]]


@dataclass(frozen=True, slots=True)
class Text:
    """Decoded text of a turn. `opening` is the message that opened the turn, once."""

    turn: int
    text: str
    opening: g.Speak | None = None


@dataclass(frozen=True, slots=True)
class EndOfText:
    """The turn's text is complete; `text` is what a truncated last character left behind."""

    turn: int
    text: str = ""


ForTurn = g.Speak | g.Hear | g.End | g.Interrupt | g.Splice | g.Seek | g.Pause | g.Continue | g.Ack
OfTurn = g.Begin | g.Packet | g.Discard | g.Done | g.Pause | g.Continue

ClientEvent = (
    g.Hello | g.Listen | Text | EndOfText | g.Hear | g.Interrupt | g.Splice | g.Seek | g.Pause | g.Continue
    | g.Ack | g.Ping | g.Bye
)  # fmt: skip
ServerEvent = (
    g.Ready | g.Live | g.Skip | g.Begin | records.Packet | g.Discard | g.Pause | g.Continue | g.Done
    | g.Pong | g.Error | g.Bye
)  # fmt: skip


@dataclass(slots=True)
class _Turn:
    state: str = "new"
    decoder: codecs.IncrementalDecoder = field(
        default_factory=lambda: codecs.getincrementaldecoder("utf-8")("replace")
    )
    begin: g.Begin | None = None
    samples: int = 0
    """First sample of the packet that has to come next."""
    packets: int = 0
    """Since the last key frame; 0: the next packet begins with one."""
    encoder: FapEncoder = field(default_factory=lambda: FapEncoder(len(FAP_NUMBERS)))
    faps: FapDecoder | None = None


class _Session:
    """What both ends share: the two state tables, and the counts of section 4.3."""

    def __init__(self) -> None:
        self.state = "opening"
        self.turns: dict[int, _Turn] = {}
        self.last_turn = 0
        self.sent = Sent()
        self.received = 0
        """Counted messages that have come."""

    def _unpack(self, data: bytes, sender: Side) -> g.Message | None:
        """The message in a frame; it counts whether or not it can be used. Raises RemoteProtocolError."""
        fields = unpack(data)
        self.received += str(fields.get("type")) not in g.EPHEMERAL
        return read(fields, sender)

    def _advance(self, side: Side, message: g.Message) -> None:
        """Take the session's step, or raise LocalProtocolError and change nothing."""
        table: Tables = g.SESSION_CLIENT if side == "client" else g.SESSION_SERVER
        step = table[self.state].get(message.type)
        if step is None:
            raise LocalProtocolError(f"`{message.type}` does not fit a session that is {self.state}")
        self.state = step

    def _advance_turn(self, side: Side, number: int, kind: str) -> bool:
        """Take the turn's step. False: the turn is over, the message is to be ignored.

        Raises LocalProtocolError and changes nothing if the table has no such step.
        """
        turn = self.turns.get(number)
        if turn is None and number <= self.last_turn:
            return False
        table: Tables = g.TURN_CLIENT if side == "client" else g.TURN_SERVER
        state = turn.state if turn else "new"
        step = table.get(state, {}).get(kind)
        if step is None:
            raise LocalProtocolError(f"`{kind}` does not fit turn {number}, which is {state}")
        if step == "over":
            del self.turns[number]
            return True
        if turn is None:
            turn = self.turns[number] = _Turn()
            self.last_turn = number
        turn.state = step
        return True


class ServerSession(_Session):
    """The server's end."""

    def receive(self, data: bytes) -> list[ClientEvent]:
        """What a frame from the client means; empty if it is to be ignored.

        Raises RemoteProtocolError with the code to answer with; nothing is changed then but the count.
        """
        message = cast(g.ClientMessage | None, self._unpack(data, "client"))
        if message is None:
            return []
        try:
            self._advance("client", message)
        except LocalProtocolError as e:
            raise RemoteProtocolError(str(e)) from e
        if isinstance(message, ForTurn) and self.state == "open":
            return self._receive_turn(message)
        return [cast(ClientEvent, message)]

    def _receive_turn(self, message: ForTurn) -> list[ClientEvent]:
        number = message.turn
        opening = number > self.last_turn
        if opening and not isinstance(message, g.Speak | g.Hear):
            raise RemoteProtocolError(f"there is no turn {number}", "unknown_turn", False, number)
        if opening and isinstance(message, g.Hear) and message.sample_rate is None:
            raise RemoteProtocolError(
                "the first `hear` of a turn has a sample_rate", "bad_message", False, number
            )
        try:
            if not self._advance_turn("client", number, message.type):
                return [message] if isinstance(message, g.Ack) else []
        except LocalProtocolError as e:
            raise RemoteProtocolError(str(e), "bad_message", False, number) from e
        turn = self.turns[number]
        if turn.state == "stopping" and not isinstance(message, g.Interrupt):
            return []
        if isinstance(message, g.Speak):
            return [Text(number, turn.decoder.decode(message.text), message if opening else None)]
        if isinstance(message, g.End):
            return [EndOfText(number, turn.decoder.decode(b"", True))]
        if isinstance(message, g.Splice):
            turn.decoder.reset()
        return [message]

    def send(self, message: g.ServerMessage) -> bytes:
        """The frame for a message. Raises LocalProtocolError, and changes nothing, if it does not fit."""
        data = encode(message)
        if isinstance(message, g.Begin | g.Packet | g.Discard | g.Done):
            if not self._advance_turn("server", message.turn, message.type):
                raise LocalProtocolError(f"turn {message.turn} is over")
            if isinstance(message, g.Discard):
                self.turns[message.turn].packets = 0
        self._advance("server", message)
        if message.type not in g.EPHEMERAL:
            self.sent.append(data, g.PACKET_MS if isinstance(message, g.Packet) else 1)
        return data

    def send_packet(self, packet: records.Packet) -> tuple[bytes, bool]:
        """The frame for the next packet of a turn, and whether it is a key.

        Raises LocalProtocolError, and changes nothing, if it does not fit.
        """
        if not self._advance_turn("server", packet.turn, "packet"):
            raise LocalProtocolError(f"turn {packet.turn} is over")
        turn = self.turns[packet.turn]
        key = turn.packets == 0
        changes = turn.encoder.encode([_row(frame) for frame in packet.frames], key)
        data = pack_packet(packet, changes)
        turn.packets = (turn.packets + 1) % g.KEY_PACKETS
        self.sent.append(data, g.PACKET_MS)
        return data, key

    def resumed(self, received: int) -> list[bytes] | None:
        """The client is back on another connection and has so many counted messages: the frames to send
        again. None if they are kept no longer: the session cannot go on.
        """
        return self.sent.after(received) if self.state == "open" else None


class ClientSession(_Session):
    """The client's end, of a session that speaks or one that listens."""

    def __init__(self) -> None:
        super().__init__()
        self.ready: g.Ready | None = None
        self.again: list[bytes] = []
        """After a `ready` that resumes: frames to be sent again, before any other."""
        self._talk: str | None = None

    def send(self, message: g.ClientMessage) -> bytes:
        """The frame for a message. Raises LocalProtocolError, and changes nothing, if it does not fit."""
        data = encode(message)
        if g.SESSION_CLIENT[self.state].get(message.type) is None:
            raise LocalProtocolError(f"`{message.type}` does not fit a session that is {self.state}")
        if isinstance(message, ForTurn):
            self._advance_turn("client", message.turn, message.type)
        self._advance("client", message)
        if message.type not in g.EPHEMERAL:
            self.sent.append(data, len(data))
            self.sent.shrink(CLIENT_KEEPS_BYTES)
        return data

    def reconnect(self) -> None:
        """The connection was lost: `hello` with `resume`, or `listen` with `talk`, may come next."""
        self.state = "opening"

    def receive(self, data: bytes) -> list[ServerEvent]:
        """What a frame from the server means; late packets of turns that are over are dropped.

        Raises RemoteProtocolError.
        """
        message = cast(g.ServerMessage | None, self._unpack(data, "server"))
        if message is None:
            return []
        try:
            self._advance("server", message)
            if isinstance(message, OfTurn):
                return self._receive_turn(message)
        except LocalProtocolError as e:
            raise RemoteProtocolError(str(e)) from e
        if isinstance(message, g.Ready):
            self._greet(message)
        if isinstance(message, g.Live) and message.talk != self._talk:
            self._forget_turns()
            self._talk = message.talk
        if isinstance(message, g.Pong) and message.received is not None:
            self.sent.forget(message.received)
        return [message]

    def _greet(self, ready: g.Ready) -> None:
        if not ready.faps or not all(1 <= n <= records.N_FAPS for n in ready.faps):
            raise RemoteProtocolError("ready.faps names FAPs that do not exist")
        self.ready, self.again = ready, []
        if ready.resumed:
            again = self.sent.after(ready.received or 0)
            if again is None:
                raise RemoteProtocolError("the server missed more than is kept here: no going on")
            self.again = again
        elif self.state == "open":
            self._forget_turns()
            self.sent, self.received = Sent(), 0

    def _forget_turns(self) -> None:
        self.turns.clear()
        self.last_turn = 0

    def _receive_turn(self, message: OfTurn) -> list[ServerEvent]:
        known = message.turn in self.turns
        watches = self.state == "listening" and isinstance(message, g.Begin)
        if not (known or watches) or not self._advance_turn("server", message.turn, message.type):
            return []
        turn = self.turns.get(message.turn)
        if turn is None:
            return [cast(g.Done, message)]
        if isinstance(message, g.Begin):
            turn.begin, turn.samples = message, message.sample or 0
            turn.faps = FapDecoder(len(self.ready.faps) if self.ready else len(FAP_NUMBERS))
        elif isinstance(message, g.Discard):
            turn.samples = min(turn.samples, message.sample)
        if not isinstance(message, g.Packet):
            return [message]
        packet = self._packet(message, turn)
        return [] if turn.state == "stopping" else [packet]

    def _packet(self, message: g.Packet, turn: _Turn) -> records.Packet:
        where = f"turn {message.turn}: packet at {message.sample}"
        if turn.begin is None or turn.faps is None:
            raise RemoteProtocolError(f"{where} before begin")
        early = message.sample < turn.samples
        if early or (message.sample > turn.samples and turn.state != "watched"):
            raise RemoteProtocolError(f"{where}, expected {turn.samples}")
        rows = turn.faps.decode(Changes(message.mask, message.faps, message.wide, message.key))
        pcm = np.zeros(message.samples or 0, np.int16) if message.pcm is None else message.pcm
        turn.samples = message.sample + len(pcm)
        return records.Packet(
            message.turn,
            message.sample,
            pcm,
            self._frames(rows, message.sample, turn.begin),
            tuple(mark_record(m) for m in message.marks or ()),
            bool(message.hold),
        )

    def _frames(self, rows: list[Row], sample: int, begin: g.Begin) -> tuple[records.FapFrame, ...]:
        numbers = np.frombuffer(self.ready.faps if self.ready else bytes(FAP_NUMBERS), np.uint8)
        first = -(-sample * begin.fps // begin.sample_rate)
        frames = []
        for i, row in enumerate(rows):
            values = np.zeros(records.N_FAPS, np.int32)
            values[numbers - 1] = row
            frames.append(records.FapFrame((first + i) * begin.sample_rate // begin.fps, values))
        return tuple(frames)


def _row(frame: records.FapFrame) -> Row:
    return frame.values[FAP_NUMBERS[0] - 1 : FAP_NUMBERS[-1]]


def mark_record(mark: g.Mark) -> records.Mark:
    """A mark of the protocol as the other rooms have it."""
    start, end = mark.char_start, mark.char_end
    return records.Mark(
        mark.kind, mark.sample, mark.duration, mark.text,
        -1 if start is None else start, -1 if end is None else end,
    )  # fmt: skip
