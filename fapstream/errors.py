"""Every error fapstream raises on purpose, in one tree that says whose fault it is.

The facts are attributes, so that a caller can act on them without reading the message.
"""

from __future__ import annotations


class FapstreamError(Exception):
    """Root of the tree."""

    code = "internal"
    """Short stable name; the one that travels in the protocol's `error` message."""


class InputError(FapstreamError):
    """What the user or the other side handed in cannot be used."""

    code = "bad_input"


class TextTooLong(InputError):
    """More unspoken text than the limit; nothing accepted before is lost."""

    code = "text_too_long"

    def __init__(self, pending: int, limit: int) -> None:
        super().__init__(
            f"{pending} characters would be waiting to be spoken; the limit is {limit}. "
            "Wait until some has been spoken and send the fragment again."
        )
        self.pending = pending
        self.limit = limit


class SoundTooLong(InputError):
    """More sound than the limit waits to be shown; nothing accepted before is lost."""

    code = "sound_too_long"

    def __init__(self, pending_s: float, limit_s: float) -> None:
        super().__init__(
            f"{pending_s:.0f} s of sound would be waiting to be shown; the limit is {limit_s:.0f} s. "
            "Wait until some has been shown and send the fragment again."
        )
        self.pending_s = pending_s
        self.limit_s = limit_s


class PhotoError(InputError):
    """A photo cannot be used: no picture, too large, no face in it."""

    code = "bad_photo"


class PointsError(InputError):
    """Feature points cannot be used: missing, outside the photo, on one line, no face."""

    code = "bad_points"


class ClipError(InputError):
    """A clip of a face or of speech cannot be used: no face, no speech, too short, too long, not as said."""

    code = "bad_clip"


class NotAuthorised(InputError):
    """What was asked for takes a token, or another one than was shown. The message never holds the token."""

    code = "unauthorised"

    def __init__(self, reason: str, expired: bool = False) -> None:
        super().__init__(reason)
        self.expired = expired
        """Whether a newer token from the same place would do."""


class UnknownName(InputError):
    """There is no such thing; the message says what there is."""

    kind = "thing"

    def __init__(self, name: str, known: tuple[str, ...]) -> None:
        super().__init__(f"no {self.kind} called {name[:40]!r}; there are: {', '.join(known)}")
        self.name = name
        self.known = known


class UnknownVoice(UnknownName):
    """`known`: the voices that there are."""

    code = "unknown_voice"
    kind = "voice"


class UnknownLanguage(UnknownName):
    """`known`: the languages that there are."""

    code = "unknown_language"
    kind = "language"


class Busy(FapstreamError):
    """There is no room just now; nobody's fault."""

    code = "busy"

    def __init__(self, reason: str, retry_ms: int) -> None:
        super().__init__(f"{reason}; try again in {max(1, round(retry_ms / 1000))} s")
        self.retry_ms = retry_ms
        """When to come back. Differs from one to the next, lest all come back at once."""


class DataError(FapstreamError):
    """A table or asset cannot be read; says which file and line."""

    code = "bad_data"

    def __init__(self, path: str, line: int | None, reason: str) -> None:
        where = path if line is None else f"{path}:{line}"
        super().__init__(f"{where}: {reason}")
        self.path = path
        self.line = line
        self.reason = reason


class BitstreamError(DataError):
    """A binary stream breaks its syntax; says at which bit."""

    def __init__(self, path: str, bit: int, reason: str) -> None:
        super().__init__(f"{path}, byte {bit // 8} bit {bit % 8}", None, reason)
        self.path = path
        self.bit = bit


class ProtocolError(FapstreamError):
    """The conversation broke the contract in protocol/SPEC.md."""

    code = "protocol"


class LocalProtocolError(ProtocolError):
    """We tried to send something the contract does not allow; nothing was changed."""


class RemoteProtocolError(ProtocolError):
    """The other side sent something the contract does not allow."""

    def __init__(
        self, message: str, code: str = "protocol", fatal: bool = True, turn: int | None = None
    ) -> None:
        super().__init__(message)
        self.code = code
        self.fatal = fatal
        self.turn = turn
        """The turn concerned."""


class SynthesisError(FapstreamError):
    """The voice failed and could not be brought back."""

    code = "synthesis_failed"


class VoiceUnavailable(SynthesisError):
    """The voice is known, but its program or database is not on this machine."""

    code = "voice_unavailable"


class VoiceOverloaded(SynthesisError):
    """The machine has no room for another program of the voice now: memory, descriptors, processes."""
