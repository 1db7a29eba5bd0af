"""One row of a FAP file or stream: which FAPs are sent, and their values."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from fapstream.records import ExpressionFap, VisemeFap

Mask = NDArray[np.bool_]

MAX_FRAMES = 360_000
"""Of one file or stream: four hours at 25 frames a second. What claims more is refused."""

MAX_VALUE = 2**31 - 1
"""The largest magnitude of a FAP."""


@dataclass(frozen=True, slots=True)
class FapRow:
    """What is sent for one frame. `mask` bool, `values` int32, both (68,), FAP n at n-1.

    `number` counts frames from the first row's 0; a gap means that nothing changed meanwhile.
    Values of FAPs that are not sent are 0 and mean nothing: such a FAP keeps its last value.
    FAP 1 and FAP 2 are sent if `viseme` and `expression` are there; their `mask` says the same.
    """

    number: int
    mask: Mask
    values: NDArray[np.int32]
    viseme: VisemeFap | None = None
    expression: ExpressionFap | None = None

    def lasting(self, number: int) -> FapRow:
        """The same face sent once more, as frame `number`; it defines nothing anew."""
        v, e = self.viseme, self.expression
        if (v and v.define) or (e and (e.define or e.init_face)):
            return FapRow(number, np.zeros_like(self.mask), np.zeros_like(self.values))
        return FapRow(number, self.mask, self.values, v, e)


@dataclass(frozen=True, slots=True)
class Note:
    """Something odd in a file that was read all the same; seen first at `line`, `count` times in all."""

    line: int
    text: str
    count: int = 1

    def __str__(self) -> str:
        times = f" ({self.count} times)" if self.count > 1 else ""
        return f"line {self.line}: {self.text}{times}" if self.line else f"{self.text}{times}"


@dataclass(slots=True)
class Notes:
    """Collects notes; a kind is kept once, with where it was first seen and how often."""

    _found: dict[str, Note] = field(default_factory=dict)

    def add(self, line: int, text: str) -> None:
        """`text` is the kind too: it says nothing that differs from line to line."""
        seen = self._found.get(text)
        self._found[text] = Note(seen.line, text, seen.count + 1) if seen else Note(line, text)

    def all(self) -> tuple[Note, ...]:
        """In the order in which the kinds were met."""
        return tuple(self._found.values())
