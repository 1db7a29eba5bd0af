"""Letter-to-sound trees: a few decision trees per letter that vote, in both directions of reading.

Going from the word's last letter to its first lets every letter see how the ending (-ity, -tion, -ical),
which decides English stress, has been pronounced: one forest proposes a few readings of the whole word that
way (a beam), and a second one, which goes from the first letter to the last, judges them. After Black, Lenzo
and Pagel, "Issues in building general letter to sound rules" (1998), whose single trees go forwards and
decide letter by letter; the leaves hold probabilities, as in Breiman's random forests (2001).

File: the magic `FLT2`, then zlib-compressed: a line of labels separated by blanks (tokens of one label are
joined by `+`, the empty label is `-`), and the two packed forests (see forest.py), backwards first. A tree
asks about the bytes of `letter_features` and, after them, of a state of `Labels`.
"""

from __future__ import annotations

import zlib
from collections.abc import Sequence
from math import log
from typing import Final

from fapstream.errors import DataError
from fapstream.tts.forest import Forest

MAGIC = b"FLT2"
WINDOW: Final = 5
NEAR: Final = 3
"""Letters on either side that a tree may ask about, and those of them whose classes it may ask about."""

MAX_LETTERS: Final = 48
"""Longer words are pronounced in pieces of this many letters."""

BEAM: Final = 3
UNLIKELY: Final = log(0.1)
"""Readings that are kept, if they are not so much less likely than the best one."""

TRUST: Final = 0.6
NEVER: Final = 0.01
"""How much the second forest's logarithms count, and the least probability that it may give."""

Reading = tuple[float, bytes, tuple[int, ...]]
"""Logarithm of its probability, state of `Labels`, labels of the letters, last one first."""

_VOWELS: Final = frozenset("aeiouy")
_PAD: Final = 26


def _partition(groups: str, names: Sequence[str]) -> bytes:
    """Class number (1.. in the order of the groups, 0 in none) of every number that has a name."""
    numbers = {name: i for i, group in enumerate(groups.split("|"), 1) for name in group.split()}
    return bytes(numbers.get(name, 0) for name in names).ljust(256, b"\0")


_LETTERS = "abcdefghijklmnopqrstuvwxyz"
LETTER_CLASSES = [
    _partition(groups, _LETTERS)
    for groups in (
        "a e i o u y|l r m n w|b c d f g h j k p q s t v x z",
        "e i y|a o u|p t k q c|b d g|f v h|s x z j|m n|l r w",
    )
]


def token_classes(tokens: Sequence[str]) -> list[bytes]:
    """Three partitions of tokens (0: none, then in this order): manner, voice or stress, place."""
    names = ["", *(t.rstrip("012") for t in tokens)]
    stress = ["", *(t[-1] if t[-1].isdigit() else t for t in tokens)]
    return [
        _partition(
            "A { V O aU @ AI E r= EI I i @U OI U u|p t k b d g|tS dZ|f v T D s S z Z h|m n N|l r|w j", names
        ),
        _partition("0|1|2|p t k tS f T s S h|b d g dZ v D z Z|m n N l r w j", stress),
        _partition(
            "i I EI|E {|A O|u U @U|@ V r=|AI aU OI|p b f v m w|t d s z T D n l r|S Z tS dZ j|k g N h", names
        ),
    ]


def vowel_groups(word: str) -> list[int]:
    """For each letter, how many groups of vowel letters begin before or at it; shape (len(word),)."""
    groups, count, inside = [], 0, False
    for letter in word:
        vowel = letter in _VOWELS
        count += vowel and not inside
        inside = vowel
        groups.append(count)
    return groups


def letter_features(word: str) -> list[bytes]:
    """What a tree may ask about each letter whatever has been said of the later ones."""
    letters = bytes([_PAD] * WINDOW + [ord(c) - 97 for c in word] + [_PAD] * WINDOW)
    classes = [letters.translate(table) for table in LETTER_CLASSES]
    groups = vowel_groups(word)
    n, out = len(word), []
    ending = letters[n + WINDOW - 2 : n + WINDOW]
    for i in range(n):
        at = i + WINDOW
        here = letters[i:at] + letters[at + 1 : at + WINDOW + 1]
        for c in classes:
            here += c[at - NEAR : at] + c[at + 1 : at + NEAR + 1]
        before = groups[i]
        counts = bytes((min(before, 7), min(groups[-1] - before, 7), min(i, 9), min(n - i, 9)))
        out.append(here + counts + ending)
    return out


class Labels:
    """The labels of a file, and what a tree may ask about those already given to the letters before."""

    def __init__(self, labels: Sequence[tuple[str, ...]], backward: bool = True) -> None:
        """`backward`: "before" is further to the right."""
        tokens = sorted({t for label in labels for t in label})
        number = {t: i for i, t in enumerate(tokens, 1)}
        nearest_first = labels if backward else [label[::-1] for label in labels]
        self._tokens = [bytes(number[t] for t in label) for label in nearest_first]
        self._vowels = [bytes(number[t] for t in label if t[-1].isdigit()) for label in nearest_first]
        self._primary = [sum(t.endswith("1") for t in label) for label in labels]
        self._classes = token_classes(tokens)
        self.start = self._state(bytes(10))

    def follow(self, state: bytes, label: int) -> bytes:
        """The state after `label` was added to what `state` describes.

        Two labels (+ 1), three phones, two vowels, nearest first; how many primary stresses, syllables, and
        syllables since the last primary stress; then the classes of two of the phones and of the vowels.
        """
        vowels = self._vowels[label]
        primary = self._primary[label]
        since = 1 if primary else state[9] + (len(vowels) if state[7] else 0)
        return self._state(
            bytes((label + 1, state[0]))
            + (self._tokens[label] + state[2:5])[:3]
            + (vowels + state[5:7])[:2]
            + bytes((min(primary + state[7], 2), min(state[8] + len(vowels), 7), min(since, 7)))
        )

    def _state(self, core: bytes) -> bytes:
        near = core[2:4] + core[5:7]
        return core + b"".join([near.translate(table) for table in self._classes])


def primaries(state: bytes) -> int:
    """How many primary stresses a state has seen, 2 for more."""
    return state[7]


class LetterToSound:
    """Guesses the tokens (phones with stress digits) of words that no lexicon has."""

    def __init__(self, data: bytes) -> None:
        """`data`: the file as described above. Raises DataError."""
        if data[:4] != MAGIC:
            raise DataError("letter-to-sound trees", None, "not a tree file")
        try:
            self._read(zlib.decompress(data[4:], bufsize=2 * len(data)))
        except (zlib.error, ValueError) as error:
            raise DataError("letter-to-sound trees", None, str(error)) from error

    def _read(self, blob: bytes) -> None:
        head = blob[: blob.index(b"\n")]
        self.labels = [() if t == "-" else tuple(t.split("+")) for t in head.decode().split(" ")]
        self._backward, self._forward = Labels(self.labels), Labels(self.labels, backward=False)
        self._proposing = Forest(blob, len(head) + 1)
        self._judging = Forest(blob, self._proposing.end)

    def __call__(self, word: str) -> tuple[str, ...]:
        """The tokens of a word of letters a-z; at most one primary stress, and one if there is a vowel."""
        tokens: list[str] = []
        for at in range(0, len(word), MAX_LETTERS):
            tokens += self._piece(word[at : at + MAX_LETTERS])
        return one_primary(tokens)

    def _piece(self, word: str) -> list[str]:
        letters, features = [ord(c) - 97 for c in word], letter_features(word)
        beam = self._propose(letters, features)
        labels = self._best(letters, features, beam) if len(beam) > 1 else beam[0][2]
        return [token for label in reversed(labels) for token in self.labels[label]]

    def _propose(self, letters: list[int], features: list[bytes]) -> list[Reading]:
        """The likeliest readings of a word, from its last letter to its first."""
        beam: list[Reading] = [(0.0, self._backward.start, ())]
        for i in range(len(letters) - 1, -1, -1):
            found = [
                (score + log(p), state, label, labels)
                for score, state, labels in beam
                for label, p in self._proposing.vote(letters[i], features[i] + state)
            ]
            if len(found) > 1:
                found.sort(key=_score, reverse=True)
            limit = found[0][0] + UNLIKELY
            beam, seen = [], set()
            for score, state, label, labels in found:
                if score < limit or len(beam) == BEAM:
                    break
                state = self._backward.follow(state, label)
                if state not in seen:
                    seen.add(state)
                    beam.append((score, state, (*labels, label)))
        return beam

    def _best(self, letters: list[int], features: list[bytes], beam: list[Reading]) -> tuple[int, ...]:
        """The labels of the reading that both forests like best, last letter first."""
        follow = self._forward.follow
        scores = [score - abs(primaries(state) - 1) for score, state, _ in beam]
        states = [self._forward.start] * len(beam)
        for i, labels in enumerate(zip(*(reading[::-1] for _, _, reading in beam), strict=True)):
            asked = set(zip(states, labels, strict=True))
            if len(asked) == 1:  # all readings would get the same
                states = [follow(states[0], labels[0])] * len(beam)
                continue
            votes = {
                state: dict(self._judging.vote(letters[i], features[i] + state)) for state in set(states)
            }
            for k, label in enumerate(labels):
                scores[k] += TRUST * log(max(votes[states[k]].get(label, 0.0), NEVER))
            states = [follow(state, label) for state, label in zip(states, labels, strict=True)]
        return beam[scores.index(max(scores))][2]


def _score(found: tuple[float, bytes, int, tuple[int, ...]]) -> float:
    return found[0]


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
