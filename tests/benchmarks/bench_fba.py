"""Bit rate of spoken faces as FBA streams, and how much faster than real time coding is.

A text is spoken with `fapstream say`; its FAPs, all of them and those of speech alone (lips, jaw, tongue and
lids), are coded at several fap_quant. The aim is 3 kbit/s at fap_quant 3 and 25 frames a second.
"""

from __future__ import annotations

import argparse
import json
import tempfile
import time
from pathlib import Path

import numpy as np

from fapstream.cli import main as fapstream
from fapstream.fap import FapSequence, FbaOptions, decode_fba, encode_fba, read_fap
from fapstream.records import N_FAPS

SENTENCES = (
    "The quick brown fox jumps over the lazy dog, and then it sleeps for a while.",
    "Tomorrow will be sunny, with a light wind from the north in the afternoon.",
    "Please remember to bring the papers that we talked about on Friday; we will need all of them.",
    "Could you tell me where the station is? It is five minutes from here, behind the old market.",
    "In the evening we walked along the river, and nobody said a word.",
    "What a lovely day it was! The children were playing in the garden until it got dark.",
)
SPEECH = (*range(3, 23), *range(44, 47), *range(51, 61))
QUANTS = (1, 3, 8)


def spoken(sentences: int, folder: Path, voice: str) -> FapSequence:
    """The face of so many sentences, over and over."""
    text = " ".join(SENTENCES[k % len(SENTENCES)] for k in range(sentences))
    path = folder / f"{sentences}.fap"
    fapstream(["say", text, "--voice", voice, "--fap", str(path), "--wav", str(folder / "a.wav")])
    return read_fap(path.read_text(encoding="ascii"), path.name)


def measured(sequence: FapSequence, quant: int) -> dict[str, float]:
    """kbit/s, and seconds of the face coded and decoded in a second."""
    seconds = sequence.length / sequence.fps
    began = time.perf_counter()
    data, _ = encode_fba(sequence, FbaOptions(quant))
    coded = time.perf_counter()
    decode_fba(data, "bench")
    decoded = time.perf_counter()
    return {
        "kbit_s": round(8 * len(data) / seconds / 1000, 2),
        "encode_x": round(seconds / (coded - began)),
        "decode_x": round(seconds / (decoded - coded)),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--voice", default="us1")
    args = parser.parse_args()
    only = np.isin(np.arange(N_FAPS) + 1, SPEECH)
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for sentences in (1, 5, 15):
            face = spoken(sentences, Path(folder), args.voice)
            for faps, sequence in (("all", face), ("speech", face.only(only))):
                for quant in QUANTS:
                    length = round(face.length / face.fps, 1)
                    rows.append(
                        {"faps": faps, "seconds": length, "fap_quant": quant, **measured(sequence, quant)}
                    )
    if args.json:
        print(json.dumps(rows, indent=1))
        return
    for row in rows:
        print("{faps:<7}{seconds:6.1f} s  fap_quant {fap_quant}  {kbit_s:5.2f} kbit/s  "
              "coded {encode_x:4} and decoded {decode_x:4} times real time".format(**row))  # fmt: skip


if __name__ == "__main__":
    main()
