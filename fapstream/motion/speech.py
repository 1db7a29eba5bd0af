"""What every mouth is asked, and what it has to know of the turn in which it speaks."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from fapstream.motion.mixer import Mouth
from fapstream.records import TimedPhone


@dataclass(frozen=True, slots=True)
class Speaking:
    """The mouth speaks `lang`, `rate` samples a second, from sample `start` on, before which it is at rest.
    `gain`: how much jaw and lips move, 1 for as much as the model has it."""

    lang: str
    rate: int
    start: int = 0
    gain: float = 1.0


class MouthTrack(Protocol):
    """The speech stream of one turn; phones come in order of time."""

    def add(self, timed: TimedPhone) -> None:
        """The next phone."""

    def ready_until(self) -> int:
        """The mouth before this sample can be told now."""

    def settled_until(self) -> int:
        """The mouth before this sample will not change, whatever comes."""

    def at(self, samples: NDArray[np.int64]) -> Mouth:
        """The mouth at samples that are ready, ascending, shape (n,). They may not go back."""

    def rest_until(self, sample: int) -> None:
        """The mouth was shown at rest up to here: it leaves rest no earlier."""
