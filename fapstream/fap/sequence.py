"""A whole animation of FAPs, as read from a file or to be written to one."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise, zip_longest

import numpy as np
from numpy.typing import NDArray

from fapstream.fap.expand import Expander
from fapstream.fap.rows import MAX_FRAMES, FapRow, Mask, Note
from fapstream.records import N_FAPS, FapFrame


@dataclass(frozen=True, slots=True)
class FapSequence:
    """Rows in order of time at `fps` frames a second; row numbers begin at 0 and may have gaps.

    `name` and `version` are the header's (`2.1` where there is none); `declared` is the number of frames
    that it promises. `notes` says what was odd in the file.
    """

    name: str
    version: str
    fps: float
    frames: tuple[FapRow, ...]
    declared: int | None = None
    notes: tuple[Note, ...] = ()

    @classmethod
    def of(cls, frames: Sequence[FapFrame], name: str, fps: float) -> FapSequence:
        """From consecutive low-level frames, of which every FAP that ever moves is sent."""
        values = np.array([f.values for f in frames], np.int32).reshape(-1, N_FAPS)
        return cls.of_values(values, name, fps)

    @classmethod
    def of_values(cls, values: NDArray[np.int32], name: str, fps: float) -> FapSequence:
        """From low-level values of shape (n, 68); FAPs 1 and 2 are left out."""
        values = values.copy()
        values[:, :2] = 0
        mask = (values != 0).any(axis=0)
        return cls(name, "2.1", fps, tuple(FapRow(k, mask, row) for k, row in enumerate(values)))

    @property
    def length(self) -> int:
        """Frames from the first row to the last, gaps included."""
        return self.frames[-1].number + 1 if self.frames else 0

    def filled(self) -> Iterator[FapRow]:
        """The rows without gaps: `length` of them, those in gaps sending again what the one before sends."""
        for row, after in zip_longest(self.frames, self.frames[1:]):
            yield row
            for number in range(row.number + 1, after.number if after else 0):
                yield row.lasting(number)

    def only(self, kept: Mask) -> FapSequence:
        """With the other FAPs masked off in every row; `kept` is bool of shape (68,)."""
        frames = tuple(
            FapRow(
                row.number,
                row.mask & kept,
                np.where(kept, row.values, 0).astype(np.int32),
                row.viseme if kept[0] else None,
                row.expression if kept[1] else None,
            )
            for row in self.frames
        )
        return replace(self, frames=frames)

    def low_level(self) -> NDArray[np.int32]:
        """The face of every frame: int32 of shape (length, 68), FAP n at n-1; FAP 1 and 2 expanded (see
        fap.expand) and 0 themselves. A frame in a gap shows what the one before it shows.

        Raises ValueError for rows whose numbers do not rise from 0, or pass MAX_FRAMES; readers give none.
        """
        numbers = [row.number for row in self.frames]
        rising = all(a < b for a, b in pairwise(numbers))
        if numbers and (numbers[0] != 0 or not rising or self.length > MAX_FRAMES):
            raise ValueError(f"row numbers must rise from 0 and stay below {MAX_FRAMES}")
        expander = Expander()
        faces = np.array([expander.step(row) for row in self.frames], np.int32).reshape(-1, N_FAPS)
        lasting = np.diff([*numbers, self.length])
        return np.repeat(faces, lasting, axis=0)
