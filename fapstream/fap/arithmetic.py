"""The adaptive arithmetic coder of FBA (ISO/IEC 14496-2, FAP and BAP decoding, predictive mode).

16-bit integer arithmetic after Witten, Neal and Cleary (1987), as in Annex E of H.263. Symbols are numbered
from the least value; cumulative frequencies run downwards, so the least value has the top of the interval.
After 22 zero bits of one run a 1 is stuffed, against false start codes.

A run ends with the two bits of the usual flush (one bit, then its opposite, with pending ones), so that the
decoder, which looks 16 bits ahead, gives 14 back: what follows a run begins at a known bit. The text of the
standard leaves this to the reader; a decoder that does otherwise would lose its place at viseme_def.
"""

from __future__ import annotations

from collections import deque
from functools import lru_cache

from fapstream.fap.bits import BitReader, BitWriter

WIDTH = 16
TOP = (1 << WIDTH) - 1
Q1, Q2, Q3 = 1 << WIDTH - 2, 1 << WIDTH - 1, 3 << WIDTH - 2
MAX_TOTAL = 16383
STUFF_AFTER = 22
LOOK_AHEAD = WIDTH - 2


class Model:
    """Frequencies of the whole numbers `low` to `high`; uniform at first, learning by 1 a symbol.

    Before the total would pass MAX_TOTAL all are halved, rounding up. Sums are kept in a Fenwick tree.
    """

    __slots__ = ("_counts", "_tree", "high", "low", "total")

    def __init__(self, low: int, high: int) -> None:
        if not 1 <= high - low + 1 <= MAX_TOTAL // 2:
            raise ValueError(f"a model cannot have the symbols {low} to {high}")
        self.low, self.high = low, high
        self._counts = [1] * (high - low + 1)
        self._tree = _uniform_tree(high - low + 1).copy()
        self.total = high - low + 1

    def span(self, symbol: int) -> tuple[int, int]:
        """Cumulative frequencies [below, above) of a symbol. Raises ValueError if it has none."""
        if not self.low <= symbol <= self.high:
            raise ValueError(f"{symbol} is not within {self.low} to {self.high}")
        at, before = symbol - self.low, 0
        while at:
            before += self._tree[at]
            at &= at - 1
        above = self.total - before
        return above - self._counts[symbol - self.low], above

    def find(self, cumulative: int) -> int:
        """The symbol whose span holds `cumulative`, which is 0 to total - 1."""
        wanted, at = self.total - cumulative, 0
        step = 1 << len(self._counts).bit_length()
        while step := step >> 1:
            if at + step < len(self._tree) and self._tree[at + step] < wanted:
                at += step
                wanted -= self._tree[at]
        return self.low + at

    def learn(self, symbol: int) -> None:
        """Count a symbol that was coded."""
        if self.total >= MAX_TOTAL:
            self._counts = [(c + 1) // 2 for c in self._counts]
            self._tree = _tree(self._counts)
            self.total = sum(self._counts)
        at = symbol - self.low
        self._counts[at] += 1
        self.total += 1
        at += 1
        while at < len(self._tree):
            self._tree[at] += 1
            at += at & -at


def _tree(counts: list[int]) -> list[int]:
    tree = [0, *counts]
    for k in range(1, len(tree)):
        above = k + (k & -k)
        if above < len(tree):
            tree[above] += tree[k]
    return tree


@lru_cache(64)
def _uniform_tree(size: int) -> list[int]:
    return _tree([1] * size)


def _narrowed(low: int, high: int, model: Model, symbol: int) -> tuple[int, int]:
    """The part of an interval that means the symbol, which the model then learns."""
    below, above = model.span(symbol)
    length, total = high - low + 1, model.total
    model.learn(symbol)
    return low + length * below // total, low + length * above // total - 1


class Encoder:
    """One run into `writer`; `finish` ends it."""

    def __init__(self, writer: BitWriter) -> None:
        self._writer = writer
        self._low, self._high = 0, TOP
        self._pending = 0
        self._zeros = 0

    def encode(self, model: Model, symbol: int) -> None:
        """One symbol, which the model then learns. Raises ValueError if it has no such symbol."""
        self._low, self._high = _narrowed(self._low, self._high, model, symbol)
        while True:
            if self._high < Q2:
                self._decided(0)
                shift = 0
            elif self._low >= Q2:
                self._decided(1)
                shift = Q2
            elif self._low >= Q1 and self._high < Q3:
                self._pending += 1
                shift = Q1
            else:
                return
            self._low = 2 * (self._low - shift)
            self._high = 2 * (self._high - shift) + 1

    def finish(self) -> None:
        """Flush, so that whatever follows the run does not matter to its decoder."""
        self._pending += 1
        self._decided(0 if self._low < Q1 else 1)

    def _decided(self, bit: int) -> None:
        self._emit(bit)
        for _ in range(self._pending):
            self._emit(1 - bit)
        self._pending = 0

    def _emit(self, bit: int) -> None:
        self._writer.write(bit, 1)
        self._zeros = 0 if bit else self._zeros + 1
        if self._zeros == STUFF_AFTER:
            self._writer.write(1, 1)
            self._zeros = 0


class Decoder:
    """One run from `reader`; `finish` leaves the reader right behind it."""

    def __init__(self, reader: BitReader) -> None:
        self._reader = reader
        self._low, self._high, self._code = 0, TOP, 0
        self._zeros = 0
        self._at = reader.position
        self._ends: deque[int] = deque(maxlen=LOOK_AHEAD + 1)
        self._unstuffed: int | None = None
        for _ in range(WIDTH):
            self._code = 2 * self._code + self._next()

    def decode(self, model: Model) -> int:
        """The next symbol, which the model then learns."""
        length = self._high - self._low + 1
        symbol = model.find(((self._code - self._low + 1) * model.total - 1) // length)
        self._low, self._high = _narrowed(self._low, self._high, model, symbol)
        while True:
            if self._high < Q2:
                shift = 0
            elif self._low >= Q2:
                shift = Q2
            elif self._low >= Q1 and self._high < Q3:
                shift = Q1
            else:
                return symbol
            self._low = 2 * (self._low - shift)
            self._high = 2 * (self._high - shift) + 1
            self._code = 2 * (self._code - shift) + self._next()

    def finish(self) -> None:
        """Raises BitstreamError if the data ended within the run, or a stuffed bit was not 1."""
        end = self._ends[0]
        if end > self._reader.size:
            raise self._reader.fail("ends within arithmetic code", self._reader.size)
        if self._unstuffed is not None and self._unstuffed < end:
            raise self._reader.fail(f"{STUFF_AFTER} zeros of arithmetic code without a 1", self._unstuffed)
        self._reader.position = end

    def _next(self) -> int:
        """A bit of the run or, at its end, of what follows; that may look like anything."""
        bit = self._reader.peek(self._at)
        self._at += 1
        self._zeros = 0 if bit else self._zeros + 1
        if self._zeros == STUFF_AFTER:
            if self._unstuffed is None and not self._reader.peek(self._at):
                self._unstuffed = self._at
            self._at += 1
            self._zeros = 0
        self._ends.append(self._at)
        return bit
