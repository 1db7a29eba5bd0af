"""The few doors to the outside world, as typing protocols. Adapters stand behind them."""

from __future__ import annotations

from collections.abc import AsyncIterator, Callable
from typing import TYPE_CHECKING, Literal, Protocol

from fapstream.records import Heard, Pcm, Speech, Utterance

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


class Clock(Protocol):
    """Monotonic time, handed in so that pacing can be tested without waiting."""

    def now(self) -> float:
        """Seconds from an arbitrary origin."""

    async def sleep_until(self, when: float) -> None:
        """Return at `when` or later."""


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


class Aligner(Protocol):
    """Finds the words and phones of recorded English. `pcm`: mono int16 (n,), 16,000 samples a second."""

    def align(self, pcm: Pcm, transcript: str) -> Heard:
        """When each word of the transcript is said. Which of a word's pronunciations it is, is heard.

        Raises ClipError: no words in the transcript, no speech, too short, words that do not fit the sound.
        """

    def recognise(self, pcm: Pcm) -> Heard:
        """What is said, as far as can be heard, and when.

        Raises ClipError: no speech, too short, nothing that can be understood.
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


class Subscription(Protocol):
    """What one subscriber gets of a channel, in order: entries, and None where some may be missing.

    It ends when it is closed, or its bus is.
    """

    def __aiter__(self) -> AsyncIterator[bytes | None]:
        """Itself. One task at a time may wait for the next entry."""

    async def __anext__(self) -> bytes | None:
        """The next entry, or None for a gap; never two gaps in a row."""

    async def aclose(self) -> None:
        """Want no more. Safe to call twice."""


class Bus(Protocol):
    """Carries entries from the process that publishes them to every process that subscribes.

    A bus belongs to one event loop, whose thread alone may use it.
    """

    @property
    def connected(self) -> bool:
        """Whether entries travel now; what is published while they do not waits some seconds."""

    def on_state(self, tell: Callable[[bool], None]) -> None:
        """Have `tell` called, from the loop, with every change of `connected`."""

    def publish(self, channel: str, entry: bytes) -> None:
        """Send an entry. Returns at once; entries that one bus publishes to a channel arrive in order.

        Where a bus cannot keep up or is away, the oldest that wait are dropped, and subscribers are told.
        What a process that died had not sent yet is lost untold. After `aclose` nothing is sent.

        Raises InputError: a channel's name or an entry that is too long.
        """

    def subscribe(self, channel: str) -> Subscription:
        """What the channel carried last (100 entries or 256 kB, if it has not been silent for minutes), and
        then what it carries, without gap or repeat between. Raises InputError as `publish` does.
        """

    async def aclose(self) -> None:
        """Send what waits, if that takes no longer than a second, and end every subscription."""
