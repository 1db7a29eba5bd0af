"""A pronunciation lexicon: every word with its phones as a string of one-character codes.

File: the magic `FLX4`, then ASCII, not compressed because that would be half of the time in which it is read:
parts, each ended by NUL: token names separated by blanks; then for each character that words begin with, in
order, two parts: the words in alphabetical order separated by newlines, and in the same order their codes. A
code is the character CODE_BASE + the index of the token's name; a token is a phone with its stress digit.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import groupby
from typing import Final

from fapstream.errors import DataError

MAGIC = b"FLX4"
CODE_BASE: Final = 0x21
CODE_END: Final = 0x7F


def pack(entries: Mapping[str, Sequence[str]]) -> bytes:
    """The file contents for word -> tokens. Raises DataError when there are more tokens than codes."""
    tokens = sorted({token for phones in entries.values() for token in phones})
    if len(tokens) > CODE_END - CODE_BASE:
        raise DataError("lexicon", None, f"{len(tokens)} different tokens")
    code = {token: chr(CODE_BASE + i) for i, token in enumerate(tokens)}
    parts = [" ".join(tokens)]
    for _, group in groupby(sorted(entries), lambda word: word[0]):
        words = list(group)
        parts += ["\n".join(words), "\n".join("".join(code[t] for t in entries[w]) for w in words)]
    return MAGIC + "".join(part + "\0" for part in parts).encode("ascii")


class _Letters(dict[str, dict[str, str]]):
    """First character -> word -> codes; a letter's words are sorted out when the first is asked for."""

    def __init__(self, parts: Sequence[str]) -> None:
        pairs = zip(parts[::2], parts[1::2], strict=True)
        self._packed = {words[:1]: (words, codes) for words, codes in pairs}

    def __missing__(self, letter: str) -> dict[str, str]:
        words, codes = self._packed.pop(letter, ("", ""))
        found = dict(zip(words.split("\n"), codes.split("\n"), strict=True)) if words else {}
        if words:
            self[letter] = found
        return found

    def unpack(self) -> None:
        """Every letter."""
        for letter in list(self._packed):
            self[letter]


class Lexicon:
    """Word -> tokens."""

    def __init__(self, data: bytes) -> None:
        """`data`: what `pack` made. Raises DataError."""
        try:
            if data[:4] != MAGIC:
                raise ValueError("not a lexicon file")
            names, *parts, _ = data[4:].decode("ascii").split("\0")
            self._letters = _Letters(parts)
        except ValueError as error:
            raise DataError("lexicon", None, str(error)) from error
        self.tokens = names.split(" ")
        self._token = {chr(CODE_BASE + i): token for i, token in enumerate(self.tokens)}.__getitem__

    def warm(self) -> None:
        """Makes every word ready; else each letter is when it is first met."""
        self._letters.unpack()

    def words(self) -> list[str]:
        """Every word, in order."""
        self.warm()
        return sorted(word for words in self._letters.values() for word in words)

    def __contains__(self, word: str) -> bool:
        return word in self._letters[word[:1]]

    def get(self, word: str) -> tuple[str, ...] | None:
        """The tokens of a lower-case word, or None."""
        codes = self._letters[word[:1]].get(word)
        return tuple(map(self._token, codes)) if codes else None
