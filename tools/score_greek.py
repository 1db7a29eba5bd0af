#!/usr/bin/env python3
"""Compares Greek pronunciations with a list of words and broad IPA (WikiPron's format: word, tab, IPA).

usage: PYTHONPATH=. tools/score_greek.py list.tsv [--wrong N] [--json] [--espeak]

The measures are those of tests/benchmarks/greek_list.py. With --espeak, eSpeak NG reads the same words in the
same run. --wrong: up to N words of each class of differences, with what is said and what is listed.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator, Mapping
from pathlib import Path

from tests.benchmarks.greek_list import Listed, Phones, Score, espeak, ours, read_list, score

MEASURES = {"strict": "strict", "merged": "after mapping", "nasal": "free nasals merged too"}


def report(
    name: str, result: Score, pronounced: Mapping[str, Phones], listed: Listed, n: int
) -> Iterator[str]:
    """The lines to print for one side; at most `n` words of each class."""
    figures = ", ".join(f"{label} {result.percent(m):.2f} %" for m, label in MEASURES.items())
    yield f"{name}: {result.words} words: {figures}"
    for kind, words in result.differences.items():
        yield f"  {len(words):5} {kind}"
        for word in words[:n]:
            yield f"        {word}\t{' '.join(pronounced[word])}\t{' / '.join(map(' '.join, listed[word]))}"


def summary(result: Score, n: int) -> dict[str, object]:
    """The same as JSON."""
    return {
        "words": result.words,
        **{measure: round(result.percent(measure), 2) for measure in MEASURES},
        "differences": {kind: len(words) for kind, words in result.differences.items()},
        "wrong": {kind: words[:n] for kind, words in result.differences.items()},
    }


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("list", type=Path)
    parser.add_argument("--wrong", type=int, default=0, help="name up to so many words of each class")
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--espeak", action="store_true", help="score eSpeak NG too")
    args = parser.parse_args()
    listed = read_list(args.list)
    sides = {"ours": ours(listed)} | ({"eSpeak NG": espeak(listed)} if args.espeak else {})
    results = {name: score(pronounced, listed) for name, pronounced in sides.items()}
    if args.json:
        print(json.dumps({k: summary(r, args.wrong) for k, r in results.items()}, ensure_ascii=False))
        return
    for name, result in results.items():
        print("\n".join(report(name, result, sides[name], listed, args.wrong)))


if __name__ == "__main__":
    main()
