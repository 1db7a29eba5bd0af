"""Letter-to-sound trees: a few decision trees per letter that vote, from the word's last letter to its first.

Going backwards lets every letter see how the ending (-ity, -tion, -ical), which decides English stress,
has been pronounced. After Black, Lenzo and Pagel, "Issues in building general letter to sound rules"
(1998), whose trees go forwards.

File: the magic `FLT1`, then zlib-compressed: a line of labels separated by blanks (tokens of one label are
joined by `+`, the empty label is `-`), little-endian uint32 trees per letter k, uint32 roots[26 * k] letter
by letter, uint32 node count n, and the node arrays feature uint8[n], value uint8[n], otherwise uint32[n].
A node asks whether `features[feature] == value`: yes goes on at the next node, no at `otherwise`. feature
LEAF marks a leaf whose label is `value`.
"""

from __future__ import annotations

import sys
import zlib
from array import array
from collections.abc import Sequence

from fapstream.errors import DataError

MAGIC = b"FLT1"
LEAF = 255
WINDOW = 4
MAX_LETTERS = 48
"""Longer words are pronounced in pieces of this many letters."""

_VOWELS = frozenset("aeiouy")
_PAD = 26


def vowel_groups(word: str) -> list[int]:
    """For each letter, how many groups of vowel letters begin before or at it; shape (len(word),)."""
    groups, count, inside = [], 0, False
    for letter in word:
        vowel = letter in _VOWELS
        count += vowel and not inside
        inside = vowel
        groups.append(count)
    return groups


def padded(word: str) -> bytes:
    """Letter numbers a=0..z=25 with WINDOW pads on either side."""
    return bytes([_PAD] * WINDOW + [ord(c) - 97 for c in word] + [_PAD] * WINDOW)


def features(letters: bytes, groups: Sequence[int], i: int, later: tuple[int, int, int]) -> bytes:
    """What a tree may ask about letter i: 8 neighbours, 3 labels after it, groups before and from it on.

    `letters` from `padded`, `groups` from `vowel_groups`; `later`: labels given to letters i+1, i+2 and,
    third, the number of primary stresses given so far.
    """
    here = letters[i : i + WINDOW] + letters[i + WINDOW + 1 : i + 2 * WINDOW + 1]
    before = groups[i]
    return here + bytes((*later, min(before, 7), min(groups[-1] - before, 7)))


class LetterToSound:
    """Guesses the tokens (phones with stress digits) of words that no lexicon has."""

    def __init__(self, data: bytes) -> None:
        """`data`: the file as described above. Raises DataError."""
        if data[:4] != MAGIC:
            raise DataError("letter-to-sound trees", None, "not a tree file")
        head, _, body = zlib.decompress(data[4:]).partition(b"\n")
        self.labels = [() if t == "-" else tuple(t.split("+")) for t in head.decode().split(" ")]
        (k,) = _uint32(body, 0, 1)
        *roots, count = _uint32(body, 4, 26 * k + 1)
        self._roots = [roots[letter * k : (letter + 1) * k] for letter in range(26)]
        at = 4 * (26 * k + 2)
        self._feature = body[at : at + count]
        self._value = body[at + count : at + 2 * count]
        self._otherwise = _uint32(body, at + 2 * count, count)
        self._primary = [any(token.endswith("1") for token in label) for label in self.labels]

    def __call__(self, word: str) -> tuple[str, ...]:
        """The tokens of a word of letters a-z; at most one primary stress, and one if there is a vowel."""
        tokens: list[str] = []
        for at in range(0, len(word), MAX_LETTERS):
            tokens += self._piece(word[at : at + MAX_LETTERS])
        return one_primary(tokens)

    def _piece(self, word: str) -> list[str]:
        letters, groups = padded(word), vowel_groups(word)
        labels: list[int] = []
        later = (0, 0, 0)
        for i in range(len(word) - 1, -1, -1):
            asked = features(letters, groups, i, later)
            votes = [self._leaf(root, asked) for root in self._roots[letters[i + WINDOW]]]
            label = max(votes, key=votes.count)
            labels.append(label)
            later = (label, later[0], later[2] + self._primary[label])
        return [token for label in reversed(labels) for token in self.labels[label]]

    def _leaf(self, node: int, asked: bytes) -> int:
        feature, value = self._feature, self._value
        while feature[node] != LEAF:
            node = node + 1 if asked[feature[node]] == value[node] else self._otherwise[node]
        return value[node]


def _uint32(data: bytes, at: int, count: int) -> array[int]:
    """Little-endian numbers."""
    numbers = array("I", data[at : at + 4 * count])
    if sys.byteorder == "big":
        numbers.byteswap()
    return numbers


def one_primary(tokens: Sequence[str]) -> tuple[str, ...]:
    """Keeps the last primary stress only; with none, the first secondary or else the first vowel gets it."""
    primaries = [i for i, t in enumerate(tokens) if t.endswith("1")]
    fixed = list(tokens)
    for i in primaries[:-1]:
        fixed[i] = fixed[i][:-1] + "2"
    if not primaries:
        vowels = [i for i, t in enumerate(tokens) if t[-1].isdigit()]
        chosen = next((i for i in vowels if tokens[i].endswith("2")), vowels[0] if vowels else None)
        if chosen is not None:
            fixed[chosen] = fixed[chosen][:-1] + "1"
    return tuple(fixed)
