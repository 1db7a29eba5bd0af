"""Reads CMUdict's `cmudict.dict` as word -> tokens in fapstream's phones, for the tools beside it."""

from __future__ import annotations

import zlib
from collections.abc import Sequence
from pathlib import Path

PAIRS = """
    AA=A AE={ AH=V AO=O AW=aU AY=AI EH=E ER=r= EY=EI IH=I IY=i OW=@U OY=OI UH=U UW=u
    B=b CH=tS D=d DH=D F=f G=g HH=h JH=dZ K=k L=l M=m N=n NG=N P=p R=r S=s SH=S T=t TH=T
    V=v W=w Y=j Z=z ZH=Z
"""
SAMPA = dict(pair.split("=", 1) for pair in PAIRS.split())


def token(phone: str) -> str:
    """`AH0` -> `@0`, `IY1` -> `i1`, `HH` -> `h`."""
    stress = phone[-1] if phone[-1].isdigit() else ""
    base = phone.rstrip("012")
    return ("@" if phone == "AH0" else SAMPA[base]) + stress


def read(path: Path) -> dict[str, tuple[str, ...]]:
    """The first pronunciation of every word; comments and variants `word(2)` are left out."""
    entries: dict[str, tuple[str, ...]] = {}
    for line in path.read_text(encoding="latin-1").splitlines():
        word, *phones = line.split("#")[0].split()
        if "(" not in word and word.isascii():
            entries.setdefault(word, tuple(token(p) for p in phones))
    return entries


def tenth(word: str) -> int:
    """Words are dealt into ten parts by hash; part 0 is never trained on, part 1 chose between variants."""
    return zlib.crc32(word.encode()) % 10


def held_out(word: str) -> bool:
    """Whether the word is in the tenth that is never trained on."""
    return tenth(word) == 0


def distance(a: Sequence[str], b: Sequence[str]) -> int:
    """How many phones have to be put in, left out or changed to make `b` of `a`."""
    row = list(range(len(b) + 1))
    for i, x in enumerate(a, 1):
        row, last = [i], row
        for j, y in enumerate(b, 1):
            row.append(min(last[j] + 1, row[-1] + 1, last[j - 1] + (x != y)))
    return row[-1]
