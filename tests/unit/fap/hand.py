"""Two FBA streams written out bit by bit from the syntax of ISO/IEC 14496-2, and what they say.

The words of the arithmetic coder are worked out in test_arithmetic (one symbol). Beside their place stand
the shares of the interval that the symbols take, one after the other: `n-i-1..n-i` of n for the i-th value.
"""

from __future__ import annotations

import numpy as np

from fapstream.fap.rows import FapRow
from fapstream.records import N_FAPS, VisemeFap

OBJECT = "00000000 00000000 00000001 10111010"
PLANE = "00000000 00000000 00000001 10111011"
END = "00000000 00000000 00000001 10110001"

# Markers of the groups from 3 on in new ranges, one before every fourth FAP of 12, 8, 4, 5, 3, 10, 4, 4.
REST = "111 11 1 11 1 111 1 1"

ONE_FAP_I = f"""
 1                      # is_intra
 01                     # fba_object_mask: a face
 1 00011001 0000 0      # is_frame_rate: 25, no sixteenths, no NTSC offset
 0                      # is_time_code
 0                      # skip_frames
 00011                  # fap_quant 3
 1 00                   # group 1: nothing
 1 01 0000000000000001  # group 2: the first of 16, FAP 3; others keep their values
 1 00  1 00  1 00  1 00 # groups 3 to 10: nothing
 1 00  1 00  1 00  1 00
 0                      # fba_suggested_gender
 0                      # fba_object_coding_type: predictive
 1 1 1 1                # is_i_new_max, is_i_new_min, is_p_new_max, is_p_new_min
 1 00001 1 1 1 {REST}   # largest in I: 60
 1 00000 1 1 1 {REST}   # least in I: 0
 1 00001 1 1 1 {REST}   # largest in P: 60
 1 00001 1 1 1 {REST}   # least in P: -60
 1101001                # 10 of 0..60; steps of 4 * 3: FAP 3 = 120
"""

ONE_FAP_P = """
 0                      # is_intra
 01                     # a face
 0                      # skip_frames
 01111101               # +1 of -60..60: FAP 3 = 132
"""

ONE_FAP_BACK = """
 0                      # is_intra
 01                     # a face
 0                      # skip_frames
 10000011               # -1 of -60..60, in which +1 counts twice now: 62/122..63/122: FAP 3 = 120
"""
# [65536*62/122, 65536*63/122 - 1] = [33305, 33841] = 10000 01000011001 to 10000 10000110001: five bits;
# [17184, 34367] lies in the middle half: one bit pending; [1600, 35967]; flush 0, and 1 1 for the pending.

VISEME_I = f"""
 1 01                   # intra, a face
 1 00001100 1000 0      # is_frame_rate: 12 and 8 sixteenths
 0 0                    # no time code, no skipped frames
 00001                  # fap_quant 1
 1 01 01                # group 1: FAP 1, the least significant bit, without FAP 2
 1 10 0000000000001000  # group 2: the fourth, FAP 6; others are interpolated: FAP 7 mirrors it
 1 00  1 00  1 00  1 00 # groups 3 to 10: nothing
 1 00  1 00  1 00  1 00
 0 0                    # gender, predictive
 1 1 1 1                # new ranges
 1 00000 1 1 1 {REST}   # largest in I: 0
 1 00001 1 1 1 {REST}   # least in I: -60
 1 00001 1 1 1 {REST}   # largest in P: 60
 1 00000 1 1 1 {REST}   # least in P: 0
 111011011100110        # FAP 1: 1 of 0..14 (13..14 of 15), 0 (14..15 of 15), 63 of 0..63 (0..1 of 64)
 0                      # viseme_def
 0011110                # -14 of -60..0 (14..15 of 61); steps of 2: FAP 6 = -28
"""

VISEME_P = """
 0 01                   # not intra, a face
 1 1111 0001            # skip_frames: 15 and 1
 01101110011011000      # FAP 1: +2 of +-14 (12..13 of 29), 0 (14..15 of 29), -33 of +-63 (96..97 of 127)
 0                      # viseme_def
 1111010                # 2 of 0..60 (58..59 of 61): FAP 6 = -24
"""


def bits(*texts: str) -> str:
    """The zeros and ones; `#` begins a comment."""
    lines = "\n".join(texts).splitlines()
    found = "".join("".join(line.partition("#")[0].split()) for line in lines)
    assert set(found) <= {"0", "1"}
    return found


def stream(*texts: str, last: str = END) -> bytes:
    """A whole stream: the object's start code, the bits, stuffing 0 1*, and the end code."""
    body = bits(*texts)
    stuffing = "0" + "1" * (-(len(body) + 1) % 8) if last else ""
    whole = bits(OBJECT) + body + stuffing + bits(last)
    whole += "0" * (-len(whole) % 8)
    return int(whole, 2).to_bytes(len(whole) // 8, "big")


def row(number: int, values: dict[int, int], viseme: VisemeFap | None = None) -> FapRow:
    """`values` are FAP: value."""
    mask, filled = np.zeros(N_FAPS, np.bool_), np.zeros(N_FAPS, np.int32)
    for fap, value in values.items():
        mask[fap - 1], filled[fap - 1] = True, value
    mask[0] = viseme is not None
    return FapRow(number, mask, filled, viseme)


ONE_FAP = (row(0, {3: 120}), row(1, {3: 132}), row(2, {3: 120}))
VISEME = (
    row(0, {6: -28, 7: -28}, VisemeFap(1, 0, 63)),
    row(17, {6: -24, 7: -24}, VisemeFap(3, 0, 30)),
)


def same(one: tuple[FapRow, ...], two: tuple[FapRow, ...]) -> bool:
    """Equality of rows, arrays included."""
    return len(one) == len(two) and all(
        (a.number, a.viseme, a.expression) == (b.number, b.viseme, b.expression)
        and np.array_equal(a.mask, b.mask)
        and np.array_equal(a.values, b.values)
        for a, b in zip(one, two, strict=True)
    )
