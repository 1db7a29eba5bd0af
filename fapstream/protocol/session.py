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
from fapstream.protocol.codec import Side, decode, encode

FAP_NUMBERS = tuple(range(3, 69))
"""The low-level FAPs, in the order in which frames carry them."""

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


ClientEvent = g.Hello | Text | EndOfText | g.Interrupt | g.Ack | g.Ping | g.Bye
ServerEvent = g.Ready | g.Begin | records.Packet | g.Done | g.Pong | g.Error | g.Bye


@dataclass(slots=True)
class _Turn:
    state: str = "new"
    decoder: codecs.IncrementalDecoder = field(
        default_factory=lambda: codecs.getincrementaldecoder("utf-8")("replace")
    )
    samples: int = 0
    begin: g.Begin | None = None


class _Session:
    """What both ends share: the two state tables."""

    def __init__(self) -> None:
        self.state = "opening"
        self.turns: dict[int, _Turn] = {}
        self.last_turn = 0

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

        Raises RemoteProtocolError with the code to answer with; nothing is changed then.
        """
        message = cast(g.ClientMessage | None, decode(data, "client"))
        if message is None:
            return []
        try:
            self._advance("client", message)
        except LocalProtocolError as e:
            raise RemoteProtocolError(str(e)) from e
        if isinstance(message, g.Speak | g.End | g.Interrupt | g.Ack):
            return self._receive_turn(message)
        return [message]

    def _receive_turn(self, message: g.Speak | g.End | g.Interrupt | g.Ack) -> list[ClientEvent]:
        number = message.turn
        opening = number > self.last_turn
        if opening and not isinstance(message, g.Speak):
            raise RemoteProtocolError(f"there is no turn {number}", code="unknown_turn", fatal=False)
        try:
            if not self._advance_turn("client", number, message.type):
                return []
        except LocalProtocolError as e:
            raise RemoteProtocolError(str(e), code="bad_message", fatal=False) from e
        turn = self.turns[number]
        if turn.state == "stopping" and not isinstance(message, g.Interrupt):
            return []
        if isinstance(message, g.Speak):
            return [Text(number, turn.decoder.decode(message.text), message if opening else None)]
        if isinstance(message, g.End):
            return [EndOfText(number, turn.decoder.decode(b"", True))]
        return [message]

    def send(self, message: g.ServerMessage) -> bytes:
        """The frame for a message. Raises LocalProtocolError, and changes nothing, if it does not fit."""
        data = encode(message)
        if isinstance(message, g.Begin | g.Packet | g.Done) and not self._advance_turn(
            "server", message.turn, message.type
        ):
            raise LocalProtocolError(f"turn {message.turn} is over")
        self._advance("server", message)
        return data

    def send_packet(self, packet: records.Packet) -> bytes:
        """The frame for a packet of the pipeline."""
        return self.send(packet_message(packet))


class ClientSession(_Session):
    """The client's end."""

    def __init__(self) -> None:
        super().__init__()
        self.ready: g.Ready | None = None

    def send(self, message: g.ClientMessage) -> bytes:
        """The frame for a message. Raises LocalProtocolError, and changes nothing, if it does not fit."""
        data = encode(message)
        if g.SESSION_CLIENT[self.state].get(message.type) is None:
            raise LocalProtocolError(f"`{message.type}` does not fit a session that is {self.state}")
        if isinstance(message, g.Speak | g.End | g.Interrupt | g.Ack):
            self._advance_turn("client", message.turn, message.type)
        self._advance("client", message)
        return data

    def receive(self, data: bytes) -> list[ServerEvent]:
        """What a frame from the server means; late packets of turns that are over are dropped.

        Raises RemoteProtocolError.
        """
        message = cast(g.ServerMessage | None, decode(data, "server"))
        if message is None:
            return []
        try:
            self._advance("server", message)
            if isinstance(message, g.Begin | g.Packet | g.Done):
                return self._receive_turn(message)
        except LocalProtocolError as e:
            raise RemoteProtocolError(str(e)) from e
        if isinstance(message, g.Ready):
            if not message.faps or not all(1 <= n <= records.N_FAPS for n in message.faps):
                raise RemoteProtocolError("ready.faps names FAPs that do not exist")
            self.ready = message
        return [message]

    def _receive_turn(self, message: g.Begin | g.Packet | g.Done) -> list[ServerEvent]:
        turn = self.turns.get(message.turn)
        if turn is None or not self._advance_turn("server", message.turn, message.type):
            return []
        if isinstance(message, g.Begin):
            turn.begin = message
        if not isinstance(message, g.Packet):
            return [message]
        if turn.begin is None:
            raise RemoteProtocolError(f"turn {message.turn}: packet before begin")
        if message.sample != turn.samples:
            raise RemoteProtocolError(
                f"turn {message.turn}: packet at {message.sample}, expected {turn.samples}"
            )
        turn.samples += len(message.pcm)
        return [] if turn.state == "stopping" else [self._packet(message, turn.begin)]

    def _packet(self, message: g.Packet, begin: g.Begin) -> records.Packet:
        numbers = np.frombuffer(self.ready.faps if self.ready else bytes(FAP_NUMBERS), np.uint8)
        if len(message.faps) % len(numbers):
            raise RemoteProtocolError(f"{len(message.faps)} FAP values are no frames of {len(numbers)}")
        rows = message.faps.reshape(-1, len(numbers))
        values = np.zeros((len(rows), records.N_FAPS), np.int32)
        values[:, numbers - 1] = rows
        first = -(-message.sample * begin.fps // begin.sample_rate)
        frames = tuple(
            records.FapFrame((first + i) * begin.sample_rate // begin.fps, row)
            for i, row in enumerate(values)
        )
        marks = tuple(
            records.Mark(
                m.kind, m.sample, m.duration, m.text,
                -1 if m.char_start is None else m.char_start, -1 if m.char_end is None else m.char_end,
            )
            for m in message.marks or ()
        )  # fmt: skip
        return records.Packet(
            message.turn, message.sample, message.pcm, tuple(frames), marks, bool(message.hold)
        )


def packet_message(packet: records.Packet) -> g.Packet:
    """A packet of the pipeline as the protocol has it."""
    first, last = FAP_NUMBERS[0] - 1, FAP_NUMBERS[-1]
    rows = [frame.values[first:last] for frame in packet.frames]
    return g.Packet(
        turn=packet.turn,
        sample=packet.start,
        pcm=packet.pcm,
        faps=np.concatenate(rows) if rows else np.zeros(0, np.int32),
        marks=tuple(_mark_message(m) for m in packet.marks) or None,
        hold=True if packet.hold else None,
    )


def _mark_message(mark: records.Mark) -> g.Mark:
    return g.Mark(
        kind=mark.kind,
        sample=mark.sample,
        duration=mark.duration,
        text=mark.text,
        char_start=None if mark.char_start < 0 else mark.char_start,
        char_end=None if mark.char_end < 0 else mark.char_end,
    )
