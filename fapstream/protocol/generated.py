"""Generated from protocol/schema by tools/generate_protocol.py. Do not edit."""

# ruff: noqa: E501
from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

SUBPROTOCOL = "fapstream.v1"
MAX_MESSAGE_BYTES = 1048576
MAX_FRAGMENT_BYTES = 65536
MAX_PENDING_TEXT = 262144
MAX_PENDING_TURNS = 16
HELLO_DEADLINE_MS = 5000
INTERRUPT_DEADLINE_MS = 2000
PACKET_MS = 40
MAX_FAPS = 68
LONGEST_LOOK_AHEAD = 1000
KEY_PACKETS = 25
RING_MS = 10000
LINGER_MS = 30000


@dataclass(frozen=True, slots=True)
class FieldSpec:
    """What the codec checks of one field; see protocol/SPEC.md for the types."""

    name: str
    type: str
    optional: bool = False
    min: int | None = None
    max: int | None = None
    enum: tuple[str | int, ...] = ()
    of: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Voice:
    """Part of a message: voice."""

    name: str
    """what `speak.voice` takes"""
    lang: str
    """language it speaks, `en` or `el`"""
    engine: str
    """`mbrola` or `espeak`"""
    sample_rate: int
    """Hz"""
    description: str | None = None
    """for people"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Mark:
    """Part of a message: mark."""

    kind: Literal["phone", "word", "caption", "expression", "mark", "warning"]
    """what begins, or is met in the text"""
    sample: int
    """sample of the turn at which it begins to be heard"""
    duration: int
    """samples"""
    text: str
    """phone name, word as written, caption, expression name, name of an SSML mark, or what is wrong with the mark-up"""
    char_start: int | None = None
    """first code point in the turn's text"""
    char_end: int | None = None
    """one past the last code point"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Hello:
    """First message of a session that speaks; nothing else is taken before it."""

    type: ClassVar[str] = "hello"
    client: str | None = None
    """program and version, for logs"""
    fps: Literal[25, 50] | None = None
    """FAP frames a second; 25 if absent"""
    lang: str | None = None
    """default language of turns"""
    voice: str | None = None
    """default voice of turns"""
    token: str | None = None
    """what allows it, where the server asks for that"""
    share: bool | None = None
    """let others listen to this session; `ready` says how"""
    channel: str | None = None
    """speak into this channel of the server, for all who listen to it"""
    resume: str | None = None
    """go on with the session whose `ready.resume` this is"""
    received: int | None = None
    """with `resume`: counted messages of that session received"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Listen:
    """First message of a session that only watches and listens to what is spoken into a channel."""

    type: ClassVar[str] = "listen"
    channel: str
    """a channel of the server, or `ready.channel` of a session that is shared"""
    client: str | None = None
    """program and version, for logs"""
    token: str | None = None
    """what allows it: of scope `listen`, or `ready.listen` of a shared session"""
    prefer: Literal["sound", "face"] | None = None
    """what is still sent when the connection is too slow for both; sound if absent"""
    talk: str | None = None
    """after a lost connection: the `live.talk` that was being heard"""
    turn: int | None = None
    """with `talk`: the turn being received"""
    sample: int | None = None
    """with `turn`: samples of it received"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Speak:
    """A fragment of a turn's text; the first one opens the turn."""

    type: ClassVar[str] = "speak"
    turn: int
    """chosen by the client, ascending"""
    text: bytes
    """UTF-8 bytes (`bin`), or a whole `str`"""
    lang: str | None = None
    """language of this turn; read from the first fragment only"""
    voice: str | None = None
    """voice of this turn; read from the first fragment only"""
    rate: int | None = None
    """speaking rate in percent; read from the first fragment only"""
    pitch: int | None = None
    """pitch in percent of the voice's own; read from the first fragment only"""
    volume: int | None = None
    """loudness in percent; read from the first fragment only"""
    look_ahead: int | None = None
    """words after a word that are waited for before it is spoken; the server's default if absent, 1000 for the whole phrase; read from the first fragment only"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Hear:
    """A fragment of a turn's sound: somebody speaks himself, and the face follows; the first one opens the turn."""

    type: ClassVar[str] = "hear"
    turn: int
    """chosen by the client, ascending"""
    pcm: NDArray[np.int16]
    """mono little-endian int16 samples, as they are recorded or faster"""
    sample_rate: int | None = None
    """Hz; in the first fragment, and read from there only"""


@dataclass(frozen=True, slots=True, kw_only=True)
class End:
    """The turn's text or sound is complete."""

    type: ClassVar[str] = "end"
    turn: int
    """the turn"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Interrupt:
    """Stop the turn and drop what has not been heard. Turns queued behind it go on."""

    type: ClassVar[str] = "interrupt"
    turn: int
    """the turn"""
    heard: int | None = None
    """samples of the turn heard until now; the server's own reckoning counts if absent"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Splice:
    """The turn's text is revised: what follows `char` is dropped, and `speak` goes on from there."""

    type: ClassVar[str] = "splice"
    turn: int
    """the turn"""
    char: int
    """code points of the turn's text that stay"""
    heard: int | None = None
    """samples of the turn heard until now; the server's own reckoning counts if absent"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Seek:
    """Say it again from the beginning of a sentence."""

    type: ClassVar[str] = "seek"
    turn: int
    """the turn"""
    back: int
    """0: the sentence being heard; 1: the one before it; and so on"""
    heard: int | None = None
    """samples of the turn heard until now; the server's own reckoning counts if absent"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Pause:
    """The turn stops where it is, until `continue`. From a server: the speaker has done so."""

    type: ClassVar[str] = "pause"
    turn: int
    """the turn"""
    heard: int | None = None
    """sample at which it stops; from a client: samples heard until now"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Continue:
    """The turn goes on after `pause`."""

    type: ClassVar[str] = "continue"
    turn: int
    """the turn"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Ack:
    """What the listener has, sent a few times a second while a turn plays."""

    type: ClassVar[str] = "ack"
    turn: int
    """the turn being heard"""
    sample: int
    """sample of the turn being heard now"""
    queue: int
    """samples received and not yet heard"""
    underruns: int
    """times the sound ran dry since the session began"""
    skew: int
    """picture minus sound in microseconds; positive: the face is late"""
    received: int | None = None
    """counted messages received; what the server keeps for a resumption ends there"""
    late: int | None = None
    """packets that came after their sound was due, since the session began"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Ping:
    """Answered at once by `pong`; browsers cannot see websocket pings."""

    type: ClassVar[str] = "ping"
    id: int
    """returned as it is"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Bye:
    """The sender closes the session in peace."""

    type: ClassVar[str] = "bye"
    reason: str | None = None
    """for people"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Ready:
    """Answer to `hello` and `listen`: what this server can do."""

    type: ClassVar[str] = "ready"
    server: str
    """program and version"""
    session: str
    """identifies the session in logs"""
    fps: Literal[25, 50]
    """FAP frames a second of every turn"""
    faps: bytes
    """the FAP numbers of one frame, in order; low-level FAPs only"""
    voices: tuple[Voice, ...]
    """voices that can be asked for"""
    heads: tuple[str, ...]
    """names of head files under `/heads/`"""
    resume: str | None = None
    """for `hello.resume` after a lost connection; to be kept secret"""
    resumed: bool | None = None
    """the session asked for goes on; if absent it is a new one"""
    received: int | None = None
    """with `resumed`: counted messages that the server had received of the session"""
    channel: str | None = None
    """what others `listen` to, if the session is shared"""
    listen: str | None = None
    """token to listen with, if the server asks for tokens"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Live:
    """To a listener: whether somebody speaks into the channel, and who."""

    type: ClassVar[str] = "live"
    channel: str
    """the channel"""
    on: bool
    """somebody is there to speak"""
    talk: str | None = None
    """names the speaker's session; with a new one the turns known so far are over"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Skip:
    """To a listener: something was left out; the next packet may lie later than the last one ended, or belong to another turn."""

    type: ClassVar[str] = "skip"
    reason: Literal["slow", "bus"]
    """`slow`: the connection took too little; `bus`: lost between the server's parts"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Begin:
    """A turn's format. Comes before its first packet."""

    type: ClassVar[str] = "begin"
    turn: int
    """the turn"""
    voice: str
    """voice that speaks it; empty in a turn of `hear`"""
    lang: str
    """its language"""
    sample_rate: int
    """Hz; the unit of every sample number of the turn"""
    fps: Literal[25, 50]
    """FAP frames a second"""
    delay: int | None = None
    """of a turn of `hear`: how many samples later than it came sound can be sent back, as the face needs them"""
    sample: int | None = None
    """to a listener who comes late: where its packets begin; 0 if absent"""
    marks: tuple[Mark, ...] | None = None
    """to a listener who comes late: the word and the caption in force there"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Packet:
    """40 ms of a turn: sound, the FAP frames of exactly those samples, and the marks that begin in them. The last packet of a turn may be shorter."""

    type: ClassVar[str] = "packet"
    turn: int
    """the turn"""
    sample: int
    """number of the first sample; packets of a turn follow each other without a gap"""
    pcm: NDArray[np.int16] | None = None
    """mono little-endian int16 samples; absent if the sound was left out"""
    samples: int | None = None
    """how many, if the sound was left out"""
    key: bool | None = None
    """the first frame starts from the neutral face instead of the frame before it"""
    mask: bytes | None = None
    """frames x ceil(n / 8) bytes, n = len(ready.faps): bit b of byte a set if channel 8 a + b changes in that frame; absent if there are no frames, or they were left out"""
    faps: NDArray[np.int16] | None = None
    """new values of the changed channels in FAP units, frame by frame"""
    wide: NDArray[np.int32] | None = None
    """instead of `faps` if a value needs more than 16 bits"""
    marks: tuple[Mark, ...] | None = None
    """in order of sample"""
    hold: bool | None = None
    """the text has run dry: what follows may come late without being a fault"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Discard:
    """The turn was revised (`splice`, `seek`): what it has from `sample` on is void, and a packet begins there."""

    type: ClassVar[str] = "discard"
    turn: int
    """the turn"""
    sample: int
    """the first void sample"""
    char: int
    """code point of the turn's text at which it goes on; after a `splice` more than was asked for if more had been heard"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Done:
    """The turn is over; no packet of it follows."""

    type: ClassVar[str] = "done"
    turn: int
    """the turn"""
    reason: Literal["end", "interrupted", "failed"]
    """why"""
    samples: int
    """samples of the turn sent in all"""
    heard: int | None = None
    """after an interrupt: samples heard, never more than were sent"""
    char: int | None = None
    """after an interrupt: code points of the turn's text heard, to the end of the last word begun"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Pong:
    """Answer to `ping`."""

    type: ClassVar[str] = "pong"
    id: int
    """as in the ping"""
    received: int | None = None
    """counted messages received from the client; it need not keep them for a resumption"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Error:
    """Something could not be done. What was accepted before stands."""

    type: ClassVar[str] = "error"
    code: str
    """one of schema/errors.json; more may come"""
    message: str
    """what was wrong, where, and what to do"""
    fatal: bool
    """the server closes the session after this"""
    turn: int | None = None
    """the turn concerned"""
    retry_ms: int | None = None
    """when it may be tried again"""


ClientMessage = Hello | Listen | Speak | Hear | End | Interrupt | Splice | Seek | Pause | Continue | Ack | Ping | Bye
ServerMessage = Pause | Continue | Bye | Ready | Live | Skip | Begin | Packet | Discard | Done | Pong | Error
Message = ClientMessage | ServerMessage

STRUCTS: dict[str, tuple[type, tuple[FieldSpec, ...]]] = {
    "voice": (Voice, (FieldSpec(name="name", type="str", max=64), FieldSpec(name="lang", type="str", max=16), FieldSpec(name="engine", type="str", max=16), FieldSpec(name="sample_rate", type="int", min=8000, max=48000), FieldSpec(name="description", type="str", max=200, optional=True),)),
    "mark": (Mark, (FieldSpec(name="kind", type="str", enum=("phone", "word", "caption", "expression", "mark", "warning")), FieldSpec(name="sample", type="int", min=0), FieldSpec(name="duration", type="int", min=0), FieldSpec(name="text", type="str", max=4096), FieldSpec(name="char_start", type="int", min=0, optional=True), FieldSpec(name="char_end", type="int", min=0, optional=True),)),
}

MESSAGES: dict[str, tuple[type[Message], str, tuple[FieldSpec, ...]]] = {
    "hello": (Hello, "client", (FieldSpec(name="client", type="str", max=200, optional=True), FieldSpec(name="fps", type="int", enum=(25, 50), optional=True), FieldSpec(name="lang", type="str", max=16, optional=True), FieldSpec(name="voice", type="str", max=64, optional=True), FieldSpec(name="token", type="str", max=4096, optional=True), FieldSpec(name="share", type="bool", optional=True), FieldSpec(name="channel", type="str", max=64, optional=True), FieldSpec(name="resume", type="str", max=128, optional=True), FieldSpec(name="received", type="int", min=0, optional=True),)),
    "listen": (Listen, "client", (FieldSpec(name="channel", type="str", max=64), FieldSpec(name="client", type="str", max=200, optional=True), FieldSpec(name="token", type="str", max=4096, optional=True), FieldSpec(name="prefer", type="str", enum=("sound", "face"), optional=True), FieldSpec(name="talk", type="str", max=64, optional=True), FieldSpec(name="turn", type="int", min=1, max=2147483647, optional=True), FieldSpec(name="sample", type="int", min=0, optional=True),)),
    "speak": (Speak, "client", (FieldSpec(name="turn", type="int", min=1, max=2147483647), FieldSpec(name="text", type="text", max=65536), FieldSpec(name="lang", type="str", max=16, optional=True), FieldSpec(name="voice", type="str", max=64, optional=True), FieldSpec(name="rate", type="int", min=25, max=400, optional=True), FieldSpec(name="pitch", type="int", min=25, max=400, optional=True), FieldSpec(name="volume", type="int", min=0, max=400, optional=True), FieldSpec(name="look_ahead", type="int", min=0, max=1000, optional=True),)),
    "hear": (Hear, "client", (FieldSpec(name="turn", type="int", min=1, max=2147483647), FieldSpec(name="pcm", type="i16", max=8192), FieldSpec(name="sample_rate", type="int", min=8000, max=48000, optional=True),)),
    "end": (End, "client", (FieldSpec(name="turn", type="int", min=1, max=2147483647),)),
    "interrupt": (Interrupt, "client", (FieldSpec(name="turn", type="int", min=1, max=2147483647), FieldSpec(name="heard", type="int", min=0, optional=True),)),
    "splice": (Splice, "client", (FieldSpec(name="turn", type="int", min=1, max=2147483647), FieldSpec(name="char", type="int", min=0), FieldSpec(name="heard", type="int", min=0, optional=True),)),
    "seek": (Seek, "client", (FieldSpec(name="turn", type="int", min=1, max=2147483647), FieldSpec(name="back", type="int", min=0, max=100), FieldSpec(name="heard", type="int", min=0, optional=True),)),
    "pause": (Pause, "both", (FieldSpec(name="turn", type="int", min=1, max=2147483647), FieldSpec(name="heard", type="int", min=0, optional=True),)),
    "continue": (Continue, "both", (FieldSpec(name="turn", type="int", min=1, max=2147483647),)),
    "ack": (Ack, "client", (FieldSpec(name="turn", type="int", min=1, max=2147483647), FieldSpec(name="sample", type="int", min=0), FieldSpec(name="queue", type="int", min=0), FieldSpec(name="underruns", type="int", min=0), FieldSpec(name="skew", type="int"), FieldSpec(name="received", type="int", min=0, optional=True), FieldSpec(name="late", type="int", min=0, optional=True),)),
    "ping": (Ping, "client", (FieldSpec(name="id", type="int", min=0, max=4294967295),)),
    "bye": (Bye, "both", (FieldSpec(name="reason", type="str", max=200, optional=True),)),
    "ready": (Ready, "server", (FieldSpec(name="server", type="str", max=200), FieldSpec(name="session", type="str", max=64), FieldSpec(name="fps", type="int", enum=(25, 50)), FieldSpec(name="faps", type="u8", max=68), FieldSpec(name="voices", type="list", of="voice", max=256), FieldSpec(name="heads", type="list", of="str", max=256), FieldSpec(name="resume", type="str", max=128, optional=True), FieldSpec(name="resumed", type="bool", optional=True), FieldSpec(name="received", type="int", min=0, optional=True), FieldSpec(name="channel", type="str", max=64, optional=True), FieldSpec(name="listen", type="str", max=4096, optional=True),)),
    "live": (Live, "server", (FieldSpec(name="channel", type="str", max=64), FieldSpec(name="on", type="bool"), FieldSpec(name="talk", type="str", max=64, optional=True),)),
    "skip": (Skip, "server", (FieldSpec(name="reason", type="str", enum=("slow", "bus")),)),
    "begin": (Begin, "server", (FieldSpec(name="turn", type="int", min=1, max=2147483647), FieldSpec(name="voice", type="str", max=64), FieldSpec(name="lang", type="str", max=16), FieldSpec(name="sample_rate", type="int", min=8000, max=48000), FieldSpec(name="fps", type="int", enum=(25, 50)), FieldSpec(name="delay", type="int", min=0, optional=True), FieldSpec(name="sample", type="int", min=0, optional=True), FieldSpec(name="marks", type="list", of="mark", max=16, optional=True),)),
    "packet": (Packet, "server", (FieldSpec(name="turn", type="int", min=1, max=2147483647), FieldSpec(name="sample", type="int", min=0), FieldSpec(name="pcm", type="i16", max=8192, optional=True), FieldSpec(name="samples", type="int", min=0, max=8192, optional=True), FieldSpec(name="key", type="bool", optional=True), FieldSpec(name="mask", type="u8", max=144, optional=True), FieldSpec(name="faps", type="i16", max=1024, optional=True), FieldSpec(name="wide", type="i32", max=1024, optional=True), FieldSpec(name="marks", type="list", of="mark", max=512, optional=True), FieldSpec(name="hold", type="bool", optional=True),)),
    "discard": (Discard, "server", (FieldSpec(name="turn", type="int", min=1, max=2147483647), FieldSpec(name="sample", type="int", min=0), FieldSpec(name="char", type="int", min=0),)),
    "done": (Done, "server", (FieldSpec(name="turn", type="int", min=1, max=2147483647), FieldSpec(name="reason", type="str", enum=("end", "interrupted", "failed")), FieldSpec(name="samples", type="int", min=0), FieldSpec(name="heard", type="int", min=0, optional=True), FieldSpec(name="char", type="int", min=0, optional=True),)),
    "pong": (Pong, "server", (FieldSpec(name="id", type="int", min=0, max=4294967295), FieldSpec(name="received", type="int", min=0, optional=True),)),
    "error": (Error, "server", (FieldSpec(name="code", type="str", max=64), FieldSpec(name="message", type="str", max=1000), FieldSpec(name="fatal", type="bool"), FieldSpec(name="turn", type="int", min=1, max=2147483647, optional=True), FieldSpec(name="retry_ms", type="int", min=0, max=3600000, optional=True),)),
}

EPHEMERAL = frozenset(["hello", "listen", "ack", "ping", "ready", "pong"])
"""Messages that are not counted and not sent again after a lost connection."""

SESSION_CLIENT: dict[str, dict[str, str]] = {
    "opening": {
        "hello": "open",
        "listen": "listening",
        "bye": "closed"
    },
    "open": {
        "speak": "open",
        "hear": "open",
        "end": "open",
        "interrupt": "open",
        "splice": "open",
        "seek": "open",
        "pause": "open",
        "continue": "open",
        "ack": "open",
        "ping": "open",
        "bye": "closed"
    },
    "listening": {
        "ack": "listening",
        "ping": "listening",
        "bye": "closed"
    },
    "closed": {}
}

SESSION_SERVER: dict[str, dict[str, str]] = {
    "opening": {
        "error": "opening",
        "bye": "closed"
    },
    "open": {
        "ready": "open",
        "begin": "open",
        "packet": "open",
        "discard": "open",
        "done": "open",
        "pong": "open",
        "error": "open",
        "bye": "closed"
    },
    "listening": {
        "ready": "listening",
        "live": "listening",
        "skip": "listening",
        "begin": "listening",
        "packet": "listening",
        "discard": "listening",
        "pause": "listening",
        "continue": "listening",
        "done": "listening",
        "pong": "listening",
        "error": "listening",
        "bye": "closed"
    },
    "closed": {
        "error": "closed"
    }
}

TURN_CLIENT: dict[str, dict[str, str]] = {
    "new": {
        "speak": "feeding",
        "hear": "hearing"
    },
    "feeding": {
        "speak": "feeding",
        "end": "ended",
        "interrupt": "stopping",
        "splice": "feeding",
        "seek": "feeding",
        "pause": "feeding",
        "continue": "feeding",
        "ack": "feeding"
    },
    "hearing": {
        "hear": "hearing",
        "end": "heard",
        "interrupt": "stopping",
        "pause": "hearing",
        "continue": "hearing",
        "ack": "hearing"
    },
    "heard": {
        "interrupt": "stopping",
        "pause": "heard",
        "continue": "heard",
        "ack": "heard"
    },
    "ended": {
        "interrupt": "stopping",
        "splice": "feeding",
        "seek": "ended",
        "pause": "ended",
        "continue": "ended",
        "ack": "ended"
    },
    "stopping": {
        "speak": "stopping",
        "hear": "stopping",
        "end": "stopping",
        "interrupt": "stopping",
        "splice": "stopping",
        "seek": "stopping",
        "pause": "stopping",
        "continue": "stopping",
        "ack": "stopping"
    },
    "watched": {
        "ack": "watched"
    },
    "over": {
        "speak": "over",
        "hear": "over",
        "end": "over",
        "interrupt": "over",
        "splice": "over",
        "seek": "over",
        "pause": "over",
        "continue": "over",
        "ack": "over"
    }
}

TURN_SERVER: dict[str, dict[str, str]] = {
    "new": {
        "begin": "watched"
    },
    "feeding": {
        "begin": "feeding",
        "packet": "feeding",
        "discard": "feeding",
        "done": "over",
        "error": "feeding"
    },
    "hearing": {
        "begin": "hearing",
        "packet": "hearing",
        "done": "over",
        "error": "hearing"
    },
    "heard": {
        "begin": "heard",
        "packet": "heard",
        "done": "over",
        "error": "heard"
    },
    "ended": {
        "begin": "ended",
        "packet": "ended",
        "discard": "ended",
        "done": "over",
        "error": "ended"
    },
    "stopping": {
        "begin": "stopping",
        "packet": "stopping",
        "discard": "stopping",
        "done": "over",
        "error": "stopping"
    },
    "watched": {
        "begin": "watched",
        "packet": "watched",
        "discard": "watched",
        "pause": "watched",
        "continue": "watched",
        "done": "over"
    },
    "over": {
        "error": "over"
    }
}

ERRORS: dict[str, bool] = {
    "protocol": True,
    "bad_message": False,
    "unknown_turn": False,
    "too_many_turns": False,
    "text_too_long": False,
    "sound_too_long": False,
    "unknown_voice": False,
    "unknown_language": False,
    "voice_unavailable": False,
    "synthesis_failed": False,
    "busy": True,
    "unauthorised": True,
    "unknown_channel": True,
    "channel_taken": True,
    "too_slow": True,
    "timeout": True,
    "internal": True,
}
"""Error code -> whether the session ends."""
