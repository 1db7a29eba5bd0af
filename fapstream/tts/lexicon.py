"""A pronunciation lexicon in one blob of bytes, looked up by hash without unpacking it into objects.

File: the magic `FLX1`, then zlib-compressed: token names (UTF-8, separated by blanks, ended by a newline),
2**BITS + 1 little-endian uint32 offsets into the rest, and the rest: for each bucket of words
(bucket = the top BITS bits of the word's CRC-32) lines of `\\n word \\t codes`, and a last newline.
A code is one byte, CODE_BASE + the index of the token's name; a token is a phone with its stress digit.
"""

from __future__ import annotations

import zlib
from array import array
from collections.abc import Mapping, Sequence

import numpy as np

from fapstream.errors import DataError

MAGIC = b"FLX1"
BITS = 14
CODE_BASE = 0x21


def bucket_of(word: bytes) -> int:
    """The bucket in which a word is filed."""
    return zlib.crc32(word) >> (32 - BITS)


def pack(entries: Mapping[str, Sequence[str]]) -> bytes:
    """The file contents for word -> tokens. Raises DataError when there are more tokens than codes."""
    tokens = sorted({token for phones in entries.values() for token in phones})
    if len(tokens) > 0x100 - CODE_BASE:
        raise DataError("lexicon", None, f"{len(tokens)} different tokens")
    code = {token: CODE_BASE + i for i, token in enumerate(tokens)}
    buckets = [bytearray() for _ in range(1 << BITS)]
    for word in sorted(entries):
        raw = word.encode("ascii")
        buckets[bucket_of(raw)] += b"\n" + raw + b"\t" + bytes(code[t] for t in entries[word])
    offsets = np.cumsum([0] + [len(b) for b in buckets]).astype("<u4").tobytes()
    blob = " ".join(tokens).encode() + b"\n" + offsets + b"".join(buckets) + b"\n"
    return MAGIC + zlib.compress(blob, 9)


class Lexicon:
    """Word -> tokens. Loading costs one decompression; a look-up one CRC and one byte search."""

    def __init__(self, data: bytes) -> None:
        """`data`: what `pack` made. Raises DataError."""
        if data[:4] != MAGIC:
            raise DataError("lexicon", None, "not a lexicon file")
        try:
            blob = zlib.decompress(data[4:])
        except zlib.error as error:
            raise DataError("lexicon", None, str(error)) from error
        head, _, body = blob.partition(b"\n")
        self.tokens = head.decode().split(" ")
        size = 4 * ((1 << BITS) + 1)
        self._offsets = array("I", np.frombuffer(body[:size], "<u4").astype(np.uint32).tobytes())
        self._body = body[size:]

    def words(self) -> list[str]:
        """Every word; for tools and tests, it takes a while."""
        lines = self._body.decode("latin-1").split("\n")
        return [line.split("\t")[0] for line in lines if line]

    def get(self, word: str) -> tuple[str, ...] | None:
        """The tokens of a lower-case word, or None."""
        if not word.isascii():
            return None
        raw = word.encode()
        bucket = bucket_of(raw)
        end = self._offsets[bucket + 1] + 1
        at = self._body.find(b"\n" + raw + b"\t", self._offsets[bucket], end)
        if at < 0:
            return None
        at += len(raw) + 2
        codes = self._body[at : self._body.index(b"\n", at)]
        return tuple(self.tokens[c - CODE_BASE] for c in codes)
