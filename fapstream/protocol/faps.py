"""FAP frames as packets carry them: what has changed since the frame before, and a whole face now and then.

A value on the wire is absolute, so a frame that was left out does no harm beyond its own time, and a key
frame, which starts from the neutral face, makes good what was missed (protocol/SPEC.md, section 3.2).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fapstream.errors import RemoteProtocolError

Row = NDArray[np.int32]

NARROW = np.iinfo(np.int16)


@dataclass(frozen=True, slots=True)
class Changes:
    """The fields of a packet that carry its frames; see there."""

    mask: bytes | None = None
    faps: NDArray[np.int16] | None = None
    wide: NDArray[np.int32] | None = None
    key: bool | None = None


class FapEncoder:
    """Frames of one turn in, changes out. Rows are int32 (n,), the channels in the session's order."""

    def __init__(self, channels: int) -> None:
        self._shown: Row = np.zeros(channels, np.int32)

    def encode(self, rows: Sequence[Row], key: bool) -> Changes:
        """The next frames; `key`: as if nothing had been sent before."""
        if key:
            self._shown = np.zeros_like(self._shown)
        if not rows:
            return Changes(key=key or None)
        frames = np.stack([self._shown, *rows])
        changed = frames[1:] != frames[:-1]
        values = frames[1:][changed]
        self._shown = frames[-1]
        mask = np.packbits(changed, axis=1, bitorder="little").tobytes()
        if not len(values):
            return Changes(mask, key=key or None)
        if values.min() >= NARROW.min and values.max() <= NARROW.max:
            return Changes(mask, faps=values.astype(np.int16), key=key or None)
        return Changes(mask, wide=values, key=key or None)


class FapDecoder:
    """Changes in, frames out."""

    def __init__(self, channels: int) -> None:
        self._shown: Row = np.zeros(channels, np.int32)

    def decode(self, changes: Changes) -> list[Row]:
        """The frames, int32 (n,) each. Raises RemoteProtocolError, and changes nothing, if mask and values
        do not agree.
        """
        n = len(self._shown)
        changed = _changed(changes.mask or b"", n)
        if changes.faps is not None and changes.wide is not None:
            raise RemoteProtocolError("a packet has either `faps` or `wide`")
        values = changes.wide if changes.faps is None else changes.faps
        given = 0 if values is None else len(values)
        if changed.sum() != given:
            raise RemoteProtocolError(f"the mask wants {changed.sum()} FAP values, there are {given}")
        shown = np.zeros_like(self._shown) if changes.key else self._shown
        rows, at = [], 0
        for row in changed:
            shown, count = shown.copy(), int(row.sum())
            if values is not None:
                shown[row] = values[at : at + count]
            at += count
            rows.append(shown)
        self._shown = shown
        return rows


def _changed(mask: bytes, n: int) -> NDArray[np.bool_]:
    """Which channels change, (frames, n). Raises RemoteProtocolError."""
    width = -(-n // 8)
    if len(mask) % width:
        raise RemoteProtocolError(f"a mask of {len(mask)} bytes is no frames of {n} channels")
    bits = np.unpackbits(np.frombuffer(mask, np.uint8).reshape(-1, width), axis=1, bitorder="little")
    if bits[:, n:].any():
        raise RemoteProtocolError(f"the mask names channels beyond {n}")
    return bits[:, :n].astype(np.bool_)
