"""A pronunciation lexicon: every word with its phones as a string of one-character codes.

File: the magic `FLX2`, then zlib-compressed ASCII of three parts, each ended by NUL: token names separated by
blanks, the words in alphabetical order separated by newlines, and in the same order their codes. A code is
the character CODE_BASE + the index of the token's name; a token is a phone with its stress digit.
"""

from __future__ import annotations

import zlib
from collections.abc import Mapping, Sequence

from fapstream.errors import DataError

MAGIC = b"FLX2"
CODE_BASE, CODE_END = 0x21, 0x7F


def pack(entries: Mapping[str, Sequence[str]]) -> bytes:
    """The file contents for word -> tokens. Raises DataError when there are more tokens than codes."""
    tokens = sorted({token for phones in entries.values() for token in phones})
    if len(tokens) > CODE_END - CODE_BASE:
        raise DataError("lexicon", None, f"{len(tokens)} different tokens")
    code = {token: chr(CODE_BASE + i) for i, token in enumerate(tokens)}
    words = sorted(entries)
    codes = ["".join(code[t] for t in entries[word]) for word in words]
    parts = (" ".join(tokens), "\n".join(words), "\n".join(codes))
    return MAGIC + zlib.compress("".join(part + "\0" for part in parts).encode("ascii"), 9)


class Lexicon:
    """Word -> tokens."""

    def __init__(self, data: bytes) -> None:
        """`data`: what `pack` made. Raises DataError."""
        try:
            if data[:4] != MAGIC:
                raise ValueError("not a lexicon file")
            names, words, codes, _ = zlib.decompress(data[4:]).decode("ascii").split("\0")
            self._codes = dict(zip(words.split("\n"), codes.split("\n"), strict=True))
        except (ValueError, zlib.error) as error:
            raise DataError("lexicon", None, str(error)) from error
        self.tokens = names.split(" ")
        self._token = {chr(CODE_BASE + i): token for i, token in enumerate(self.tokens)}.__getitem__

    def words(self) -> list[str]:
        """Every word, in order."""
        return list(self._codes)

    def __contains__(self, word: str) -> bool:
        return word in self._codes

    def get(self, word: str) -> tuple[str, ...] | None:
        """The tokens of a lower-case word, or None."""
        codes = self._codes.get(word)
        return tuple(map(self._token, codes)) if codes else None
