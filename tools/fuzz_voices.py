#!/usr/bin/env python3
"""Has MBROLA say random words of both scripts, and stops at the first complaint.

usage: tools/fuzz_voices.py [--words 1000000] [--voice us1 ...] [--seed 1]

Words of the lexicon and invented ones, in any order and mixture of languages, with punctuation, numbers and
mark-up between them, go through the front-end and the writer of .pho as they do in a talk, in fragments of
any length. MBROLA runs without -e: a diphone that its database lacks would end it. It must say nothing on its
standard error, end with status 0, and make the samples that it was asked for, less than a pitch period fewer.
"""

from __future__ import annotations

import argparse
import random
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path

from fapstream.tts import FrontEnd, Manner
from fapstream.tts.english import english
from fapstream.tts.pho import Realiser
from fapstream.tts.voices import Voice, voice, voices

LATIN = "abcdefghijklmnopqrstuvwxyz'"
GREEK = "αβγδεζηθικλμνξοπρστυφχψωάέήίόύώϊϋΐΰς"
BETWEEN = [
    ". ",
    ", ",
    "? ",
    "! ",
    "; ",
    ": ",
    " - ",
    "\n",
    " <break time='20ms'/> ",
    " 1821 ",
    " 3,5% ",
    " $2.50 ",
]
TURN_WORDS = 5000
"""A turn is so long; then a new one begins, in the same MBROLA."""


def text(rng: random.Random, lang: str, n: int) -> str:
    """Random words, most of them of the voice's language."""
    own = LATIN if lang == "en" else GREEK
    other = GREEK if lang == "en" else LATIN
    real = english().lexicon_words()
    out = []
    for _ in range(n):
        kind = rng.random()
        if kind < (0.5 if lang == "en" else 0.1):
            word = rng.choice(real)
        else:
            word = "".join(rng.choices(own if kind < 0.93 else other, k=rng.randint(1, 10)))
        out.append(word.upper() if rng.random() < 0.03 else word)
        out.append(rng.choice(BETWEEN) if rng.random() < 0.06 else " ")
    return "".join(out)


def fragments(rng: random.Random, whole: str) -> Iterator[str]:
    """The text in pieces."""
    at = 0
    while at < len(whole):
        size = rng.choice((1, 7, 40, 400, 4000))
        yield whole[at : at + size]
        at += size


class Mbrola:
    """A running program, its sound counted and its complaints kept."""

    def __init__(self, v: Voice, database: Path) -> None:
        command = ["mbrola", "-v", str(v.drive), str(database), "-", "-.raw"]
        pipe = subprocess.PIPE
        self.process = subprocess.Popen(command, stdin=pipe, stdout=pipe, stderr=pipe)
        self.samples, self.complaint = 0, b""
        self._threads = [threading.Thread(target=self._count), threading.Thread(target=self._listen)]
        for thread in self._threads:
            thread.start()

    def _count(self) -> None:
        assert self.process.stdout
        while data := self.process.stdout.read(1 << 20):
            self.samples += len(data) // 2

    def _listen(self) -> None:
        assert self.process.stderr
        self.complaint = self.process.stderr.read()

    def write(self, lines: str) -> None:
        """Hand lines over."""
        assert self.process.stdin
        self.process.stdin.write(lines.encode("ascii"))

    def end(self) -> int:
        """Its exit status."""
        assert self.process.stdin
        self.process.stdin.close()
        for thread in self._threads:
            thread.join()
        return self.process.wait()


def run(v: Voice, words: int, seed: int) -> str:
    """ "" if all went well, or what was wrong."""
    rng, asked = random.Random(seed), 0
    mbrola = Mbrola(v, Path("/usr/share/mbrola") / v.name / v.name)
    try:
        for _ in range(0, words, TURN_WORDS):
            front = FrontEnd(v.lang, Manner(look_ahead=rng.choice((0, 1, 2, 1000))).of(v))
            realiser = Realiser(v)
            pieces = [*fragments(rng, text(rng, v.lang, TURN_WORDS)), None]
            for piece in pieces:
                utterances = front.end() if piece is None else front.feed(piece)
                if rng.random() < 0.05:
                    utterances += front.hold()
                for utterance in utterances:
                    written = realiser.write(utterance)
                    asked += written.ends[-1] if written.ends else 0
                    mbrola.write(written.lines + ("#\n" if utterance.closed else ""))
    except BrokenPipeError:
        pass
    status = mbrola.end()
    complaint = mbrola.complaint.decode("utf-8", "replace").strip()
    if status or complaint:
        return f"status {status}: {complaint[-300:]}"
    owed = asked - mbrola.samples
    return "" if 0 <= owed < v.period else f"{owed} samples are missing"


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--words", type=int, default=1_000_000)
    parser.add_argument("--voice", action="append")
    parser.add_argument("--seed", type=int, default=1)
    args = parser.parse_args()
    chosen = [voice(n) for n in args.voice] if args.voice else [v for v in voices() if v.engine == "mbrola"]
    failed = False
    for v in chosen:
        begin = time.perf_counter()
        wrong = run(v, args.words, args.seed)
        failed |= bool(wrong)
        print(
            f"{v.name}: {args.words} words, {time.perf_counter() - begin:.0f} s: {wrong or 'no complaint'}",
            flush=True,
        )
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
