"""The few doors to the outside world, as typing protocols. Adapters stand behind them."""

from __future__ import annotations

from collections.abc import AsyncGenerator, AsyncIterator
from typing import TYPE_CHECKING, Literal, Protocol

from fapstream.records import Speech, Utterance

if TYPE_CHECKING:  # numpy's types and those of points, which speaking does without
    import numpy as np
    from numpy.typing import NDArray

    from fapstream.adapt.points import Facing, Marks


class Synthesizer(Protocol):
    """One voice speaking one turn: phones in, sound and the phones' true times out.

    The turn's clock is the index of the samples that `speech()` yields. Write and read may run
    at the same time; what is written first is heard first.
    """

    sample_rate: int
    """Samples per second of everything this turn yields."""

    async def write(self, utterance: Utterance) -> None:
        """Hand over the next phones. Returns once they are accepted, not once they are heard.

        Raises SynthesisError when the voice is beyond help.
        """

    async def flush(self) -> None:
        """Make everything written so far audible now, closing with a short silence if need be."""

    async def finish(self) -> None:
        """Flush, and end `speech()` after the last sample."""

    def speech(self) -> AsyncIterator[Speech]:
        """Sound as it is made, gapless, from sample 0. Raises SynthesisError."""

    async def aclose(self) -> None:
        """Give the voice back, whatever state it is in. Safe to call twice."""


class SynthesizerPool(Protocol):
    """Where warm voices come from."""

    async def acquire(self, voice: str) -> Synthesizer:
        """A voice ready for one turn. Raises UnknownVoice, VoiceUnavailable."""

    async def aclose(self) -> None:
        """End every process."""


class Clock(Protocol):
    """Monotonic time, handed in so that pacing can be tested without waiting."""

    def now(self) -> float:
        """Seconds from an arbitrary origin."""

    async def sleep_until(self, when: float) -> None:
        """Return at `when` or later."""


class Bus(Protocol):
    """Carries entries of channels between processes. Entries of a channel arrive in order."""

    def publish(self, channel: str, entry: bytes) -> None:
        """Returns at once."""

    def subscribe(self, channel: str) -> AsyncGenerator[bytes | None, None]:
        """The newest entries, and those that come; None: something may be missing here."""

    async def aclose(self) -> None:
        """Leave it."""


class Landmarker(Protocol):
    """Finds feature points in photos. `picture`: uint8 (height, width, 3), sRGB, upright."""

    def front(self, picture: NDArray[np.uint8]) -> Marks:
        """The points of a face that looks at the camera, with confidences.

        Raises PhotoError: no face, more than one, one that is turned away.
        """

    def profile(self, picture: NDArray[np.uint8]) -> tuple[Marks, Facing]:
        """The points of a face from the side, and where its nose points.

        Those behind the outline have little confidence.

        Raises PhotoError: more than one face, one that looks at the camera, no outline to be found.
        """


Counted = Literal[
    "turns", "resumes", "errors", "late_packets", "dropped", "underruns", "voice_restarts", "voice_hangs",
    "sent_bytes",
]  # fmt: skip
Gauged = Literal["sessions", "listeners", "adapting", "voice_processes", "outbox_packets", "text_waiting"]
Timed = Literal["first_audio", "packet_lateness", "skew", "loop_lag"]


class Meter(Protocol):
    """Where figures about a running server go. Calls are cheap enough for every packet and raise nothing."""

    def count(self, name: Counted, amount: float = 1, label: str = "") -> None:
        """So many more of them. `label`: which, for those that come in kinds."""

    def level(self, name: Gauged, value: float) -> None:
        """How many there are now."""

    def time(self, name: Timed, seconds: float) -> None:
        """How long one of them took."""


class NoMeter:
    """A meter that forgets."""

    def count(self, name: Counted, amount: float = 1, label: str = "") -> None:
        """See the port."""

    def level(self, name: Gauged, value: float) -> None:
        """See the port."""

    def time(self, name: Timed, seconds: float) -> None:
        """See the port."""
