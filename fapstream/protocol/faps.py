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
        masks, values = [], []
        for row in rows:
            changed = row != self._shown
            masks.append(np.packbits(changed, bitorder="little").tobytes())
            values.append(row[changed])
            self._shown = row
        mask = b"".join(masks) if masks else None
        wide = values[0] if len(values) == 1 else np.concatenate(values or [self._shown[:0]])
        narrow = wide.astype(np.int16)
        if not len(wide):
            return Changes(mask, key=key or None)
        if narrow.astype(np.int32).tobytes() == wide.tobytes():
            return Changes(mask, faps=narrow, key=key or None)
        return Changes(mask, wide=wide, key=key or None)


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
