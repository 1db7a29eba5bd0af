#!/usr/bin/env python3
"""Compares our Greek pronunciations with a list of words and broad IPA (WikiPron's format: word, tab, IPA).

usage: tools/score_greek.py list.tsv [--wrong N]

Two figures. `strict`: every phone as in one of the list's pronunciations, after mapping its symbols to ours.
`merged`: apart from free variation, that is a glide or palatal for an unstressed i before a vowel
(synizesis), and a nasal before a voiced stop.
"""

from __future__ import annotations

import argparse
from collections import defaultdict
from pathlib import Path

from fapstream.tts.greek import greek
from fapstream.tts.normalise import fold_greek
from fapstream.tts.tables import phone_set

IPA = dict(
    pair.split("=", 1) for pair in ["ɲ=J", "ʎ=L", "ɟ=gj", "ɡ=g", "ŋ=N", "ɣ=G", "ʝ=j", "ð=D", "θ=T", "ç=C"]
) | {"ɾ": "r", "ɱ": "m", "i̯": "i"}
VOWELS = frozenset("aeiou")
CONSONANTS = frozenset(phone_set("el")) - VOWELS
PALATALS = {"L": "l", "J": "n"}

Phones = tuple[str, ...]


def from_ipa(text: str) -> Phones:
    """The list's symbols as ours; affricates are written apart in it."""
    out: list[str] = []
    for symbol in (IPA.get(s, s) for s in text.split()):
        if out and (out[-1], symbol) in (("t", "s"), ("d", "z")):
            out[-1] += symbol
        else:
            out.append(symbol)
    return tuple(out)


def merged(phones: Phones) -> Phones:
    """The pronunciation without what may be said either way."""
    out: list[str] = []
    for i, phone in enumerate(phones):
        following = phones[i + 1] if i + 1 < len(phones) else ""
        glide = phone in ("j", "C") and following in VOWELS
        if phone in PALATALS:
            nasal_glide = phone == "J" and out and out[-1] == "m"
            out += ([] if nasal_glide else [PALATALS[phone]]) + (["i"] if following != "i" else [])
        elif glide and out and out[-1] in CONSONANTS:
            out.append("i")
        elif phone in ("c", "gj", "C", "j") and following in ("a", "o", "u"):
            out += [phone, "i"]
        elif phone != "N" and not (phone in ("m", "n") and following in ("b", "d", "dz")):
            out.append(phone)
    return tuple(out)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("list", type=Path)
    parser.add_argument("--wrong", type=int, default=0, help="print so many words that are wrong either way")
    args = parser.parse_args()
    known: dict[str, list[Phones]] = defaultdict(list)
    for line in args.list.read_text(encoding="utf-8").splitlines():
        word, ipa = line.split("\t")
        known[word].append(from_ipa(ipa))
    strict, wrong = 0, []
    for word, wanted in known.items():
        ours = tuple(token.rstrip("01") for token in greek().word(fold_greek(word)))
        strict += ours in wanted
        if merged(ours) not in [merged(w) for w in wanted]:
            wrong.append(f"{word}\t{' '.join(ours)}\t{' / '.join(map(' '.join, wanted))}")
    n = len(known)
    print(f"{n} words: strict {100 * strict / n:.2f} %, merged {100 * (1 - len(wrong) / n):.2f} %")
    print("\n".join(wrong[: args.wrong]))


if __name__ == "__main__":
    main()
