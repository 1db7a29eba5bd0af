"""The adaptive arithmetic coder against exact rational arithmetic, and codes worked out by hand.

The oracle: a sequence of symbols is the interval that is left of [0, 1) when each symbol takes its share,
the least value the topmost. Every number that begins with the code must lie in it, but for the rounding.
"""

from __future__ import annotations

from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fapstream.errors import BitstreamError
from fapstream.fap import arithmetic
from fapstream.fap.arithmetic import MAX_TOTAL, Decoder, Encoder, Model
from fapstream.fap.bits import BitReader, BitWriter

Coded = list[tuple[tuple[int, int], int]]
"""(range of the model, symbol), one after the other; equal ranges share a model."""


def encode(symbols: Coded) -> str:
    models: dict[tuple[int, int], Model] = {}
    writer = BitWriter()
    run = Encoder(writer)
    for limits, symbol in symbols:
        run.encode(models.setdefault(limits, Model(*limits)), symbol)
    run.finish()
    return str(writer)


def reader_of(bits: str) -> BitReader:
    writer = BitWriter()
    for bit in bits:
        writer.write(int(bit), 1)
    return BitReader(writer.to_bytes(), "s")


def decode(bits: str, wanted: Coded) -> tuple[list[int], int]:
    """The symbols and the bit after the run."""
    models: dict[tuple[int, int], Model] = {}
    reader = reader_of(bits)
    run = Decoder(reader)
    found = [run.decode(models.setdefault(limits, Model(*limits))) for limits, _ in wanted]
    run.finish()
    return found, reader.position


def exact(symbols: Coded) -> tuple[Fraction, Fraction]:
    """The interval of a sequence, by counting."""
    counts: dict[tuple[int, int], list[int]] = {}
    low, width = Fraction(0), Fraction(1)
    for (least, most), symbol in symbols:
        table = counts.setdefault((least, most), [1] * (most - least + 1))
        above = sum(table[symbol - least + 1 :])
        low += width * Fraction(above, sum(table))
        width *= Fraction(table[symbol - least], sum(table))
        table[symbol - least] += 1
    return low, low + width


def unstuffed(bits: str) -> str:
    """Without the 1 after each 22 zeros."""
    out, zeros, at = "", 0, 0
    while at < len(bits):
        out += bits[at]
        zeros = 0 if bits[at] == "1" else zeros + 1
        at += 1
        if zeros == 22:
            assert bits[at] == "1"
            at, zeros = at + 1, 0
    return out


@pytest.mark.parametrize(
    ("symbols", "code"),
    [
        # Nothing: the flush of [0, 65535] is 0 and its opposite.
        ([], "01"),
        # One value only: no choice, no bits.
        ([((7, 7), 7)], "01"),
        # Two values: the lower is the upper half, 1; what is left is the whole interval again.
        ([((0, 1), 0)], "1" "01"),
        ([((0, 1), 1)], "0" "01"),
        # 0 then 0 of two: 1, then the model has counts 2 and 1, the upper two thirds:
        # [65536/3, 65535] = [21845, 65535], which decides nothing; 21845 >= 16384: flush 1 0.
        ([((0, 1), 0), ((0, 1), 0)], "1" "10"),
        # The middle of three: [65536/3, 65536*2/3 - 1] = [21845, 43689] straddles the middle within the
        # middle half: one bit pending, twice the distance from it: [10922, 54611]. Flush: low < 16384,
        # a 0 and two opposites for the pending and its own.
        ([((0, 2), 1)], "0" "11"),
        # Value 10 of 0..60: shares 50/61 to 51/61: [53718, 54791] =
        # 11010 00111010110 to 11010 11000000111: five bits; [15040, 49407] decides no more; flush 01.
        ([((0, 60), 10)], "11010" "01"),
        # Difference +1 of -60..60, the 62nd of 121: shares 59/121 to 60/121: [31955, 32494] =
        # 011111 0011010011 to 011111 1011101110: six bits; [13504, 48063]; flush 01.
        ([((-60, 60), 1)], "011111" "01"),
    ],
)  # fmt: skip
def test_codes_by_hand(symbols: Coded, code: str) -> None:
    assert encode(symbols) == code
    assert decode(code + "1" * 20, symbols) == ([s for _, s in symbols], len(code))
    assert decode(code + "0" * 20, symbols) == ([s for _, s in symbols], len(code))


LIMITS = st.sampled_from([(0, 1), (0, 2), (-60, 60), (0, 14), (0, 63), (-1860, 1860), (5, 5), (-120, 60)])
SYMBOLS = st.lists(LIMITS.flatmap(lambda r: st.tuples(st.just(r), st.integers(*r))), max_size=60)


SMALL = [(0, 1), (0, 2), (0, 14), (0, 63), (-60, 60), (5, 5)]
FEW = st.lists(st.sampled_from(SMALL).flatmap(lambda r: st.tuples(st.just(r), st.integers(*r))), max_size=20)


@settings(deadline=None)
@given(FEW)
def test_codes_lie_in_the_exact_interval(symbols: Coded) -> None:
    """Bounds are whole numbers of which an interval has 2^14 at least: each symbol moves them by less than
    a thousandth of the interval before it."""
    bits = unstuffed(encode(symbols))
    start, end = Fraction(int(bits, 2), 2 ** len(bits)), Fraction(int(bits, 2) + 1, 2 ** len(bits))
    low, high = exact(symbols)
    widths = [high - low for low, high in (exact(symbols[:k]) for k in range(len(symbols)))]
    slack = sum(widths, Fraction(0)) / 1000
    assert low - slack <= start < end <= high + slack
    assert end - start >= (high - low) / 8 * Fraction(98, 100) ** len(symbols), "no bit is wasted"


@settings(deadline=None)
@given(SYMBOLS, st.text("01", max_size=40))
def test_a_run_ends_where_it_ends(symbols: Coded, after: str) -> None:
    bits = encode(symbols)
    assert decode(bits + after, symbols) == ([s for _, s in symbols], len(bits))


@settings(deadline=None)
@given(st.integers(1, 400))
def test_no_more_than_22_zeros(n: int) -> None:
    symbols: Coded = [((0, 40), 40)] * n
    bits = encode(symbols)
    assert "0" * 23 not in bits
    assert decode(bits + "0" * 30, symbols) == ([40] * n, len(bits))


def test_the_stuffed_bit_by_hand() -> None:
    """The larger of two values takes the lower end: zeros. Counts 1:1, 2:1, 3:1 ... leave 1/2, 2/3, 3/4 ...
    of the interval, 1/(n+1) after n symbols; in thirty ranges of their own 2^-30."""
    symbols: Coded = [((k, k + 1), k + 1) for k in range(30)]
    assert encode(symbols) == "0" * 22 + "1" + "0" * 8 + "01"


def test_a_stuffed_bit_that_is_0_is_refused() -> None:
    symbols: Coded = [((k, k + 1), k + 1) for k in range(30)]
    with pytest.raises(BitstreamError, match="byte 2 bit 6: 22 zeros of arithmetic code without a 1"):
        decode("0" * 23 + "0" * 8 + "01" + "1" * 20, symbols)


def test_an_early_end_is_refused() -> None:
    symbols: Coded = [((-1860, 1860), k) for k in range(-900, 900, 100)]
    bits = encode(symbols)
    bits = bits[: len(bits) // 8 * 8 - 8]
    with pytest.raises(BitstreamError, match=f"byte {len(bits) // 8} bit 0: ends within"):
        decode(bits, symbols)


@settings(deadline=None)
@given(st.lists(st.integers(0, 9), max_size=300))
def test_models_count(symbols: list[int]) -> None:
    """The tree against plain sums."""
    model, counts = Model(0, 9), [1] * 10
    for symbol in symbols:
        model.learn(symbol)
        counts[symbol] += 1
    assert model.total == sum(counts)
    for k in range(10):
        assert model.span(k) == (sum(counts[k + 1 :]), sum(counts[k:]))
    for cumulative in range(model.total):
        below, above = model.span(model.find(cumulative))
        assert below <= cumulative < above


def test_counts_are_halved(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(arithmetic, "MAX_TOTAL", 10)
    model = Model(0, 2)
    for _ in range(7):
        model.learn(1)
    assert model.total == 10
    model.learn(0)  # 1 8 1 are halved, rounding up, to 1 4 1; then 0 counts
    assert [model.span(k) for k in range(3)] == [(5, 7), (1, 5), (0, 1)]


def test_totals_stay_below_a_quarter_of_the_interval() -> None:
    model = Model(0, 1)
    for k in range(MAX_TOTAL + 10):
        model.learn(k % 2)
        assert model.total <= MAX_TOTAL


def test_what_a_model_cannot_say() -> None:
    with pytest.raises(ValueError, match="not within 0 to 3"):
        Model(0, 3).span(4)
    with pytest.raises(ValueError, match="cannot have the symbols"):
        Model(1, 0)
    with pytest.raises(ValueError, match="cannot have the symbols"):
        Model(0, MAX_TOTAL)
