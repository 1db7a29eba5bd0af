"""Bits in and out of bytes, most significant first, and the byte alignment of MPEG-4 start codes."""

from __future__ import annotations

import numpy as np

from fapstream.errors import BitstreamError


class BitWriter:
    """Grows a string of bits."""

    def __init__(self) -> None:
        self._bits = bytearray()  # one byte a bit, so that runs can be looked at

    def __len__(self) -> int:
        return len(self._bits)

    def write(self, value: int, width: int) -> None:
        """The lowest `width` bits of `value`. Raises ValueError if it does not fit."""
        if not 0 <= value < 1 << width:
            raise ValueError(f"{value} is no unsigned integer of {width} bits")
        self._bits += bytes(value >> k & 1 for k in reversed(range(width)))

    def extend(self, other: BitWriter) -> None:
        """All bits of another writer."""
        self._bits += other._bits

    def truncate(self, size: int) -> None:
        """Forget all bits after the first `size`."""
        del self._bits[size:]

    def start_code(self, code: int) -> None:
        """next_start_code(): stuffing 0 1* up to a byte boundary; then 32 bits. Nothing to stuff at first."""
        if self._bits:
            self.write(0, 1)
            while len(self._bits) % 8:
                self.write(1, 1)
        self.write(code, 32)

    def emulates_start_code(self, since: int) -> bool:
        """Whether 23 zeros as in a start code follow a byte boundary and reach beyond bit `since`."""
        first = -(-max(0, since - 22) // 8) * 8
        return any(not any(self._bits[k : k + 23]) for k in range(first, len(self._bits) - 22, 8))

    def to_bytes(self) -> bytes:
        """Zero bits fill the last byte."""
        return np.packbits(np.frombuffer(bytes(self._bits), np.uint8)).tobytes()

    def __str__(self) -> str:
        return "".join(map(str, self._bits))


class BitReader:
    """Reads `data` from `position`, a count of bits; `where` names it in errors."""

    def __init__(self, data: bytes, where: str) -> None:
        self._data = data
        self._where = where
        self.position = 0
        self.size = 8 * len(data)

    def fail(self, reason: str, bit: int | None = None) -> BitstreamError:
        """The error to raise for what was read last, or stands at `bit`."""
        return BitstreamError(self._where, self.position if bit is None else bit, reason)

    def peek(self, bit: int) -> int:
        """The bit at an absolute position; 0 after the end."""
        return self._data[bit >> 3] >> (7 - (bit & 7)) & 1 if bit < self.size else 0

    def read(self, width: int) -> int:
        """An unsigned integer. Raises BitstreamError at the end of the data."""
        if self.position + width > self.size:
            raise self.fail(f"ends where {width} more bits are due", self.size)
        value = 0
        for bit in range(self.position, self.position + width):
            value = value << 1 | self.peek(bit)
        self.position += width
        return value

    def flag(self) -> bool:
        """One bit."""
        return bool(self.read(1))

    def marker(self) -> None:
        """A bit that must be 1. Raises BitstreamError."""
        if not self.flag():
            raise self.fail("a marker bit is 0", self.position - 1)

    def start_code(self) -> int | None:
        """The start code that comes next, after stuffing if there is any; None if there is none.

        Does not move; `skip_start_code` does.
        """
        for at in self._boundaries():
            word = self._data[at : at + 4]
            if len(word) == 4 and word[:3] == b"\0\0\1":
                return int.from_bytes(word, "big")
        return None

    def skip_start_code(self) -> None:
        """Move behind the start code that `start_code` sees."""
        for at in self._boundaries():
            if self._data[at : at + 3] == b"\0\0\1":
                self.position = 8 * (at + 4)
                return

    def only_stuffing_left(self) -> bool:
        """Whether nothing follows but the stuffing of next_start_code(), or nothing at all."""
        left = [self.peek(bit) for bit in range(self.position, min(self.size, self.position + 9))]
        return not left or (len(left) <= 8 and left[0] == 0 and all(left[1:]))

    def _boundaries(self) -> list[int]:
        """Bytes at which a start code may begin: here, or after stuffing 0 1*."""
        here, off = divmod(self.position, 8)
        ahead = [self.peek(bit) for bit in range(self.position, 8 * (here + 1))]
        stuffed = ahead[0] == 0 and all(ahead[1:])
        return ([] if off else [here]) + ([here + 1] if stuffed else [])
