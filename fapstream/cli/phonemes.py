"""Print words, phones, durations and pitch of a text, without speaking it."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Iterator
from typing import Any

from fapstream.cli.arguments import rate, unicode_text
from fapstream.records import Utterance
from fapstream.tts import LANGUAGES, FrontEnd, Manner, default_voice, voice

HELP = "show how a text would be pronounced"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """TEXT, --lang, --voice, --rate, --json."""
    parser.add_argument(
        "text",
        type=unicode_text,
        help="the text; `-` reads one utterance a line from stdin and writes JSON lines",
    )
    parser.add_argument("--lang", choices=LANGUAGES, default=LANGUAGES[0])
    parser.add_argument("--voice", help="take the pitch of this voice")
    parser.add_argument("--rate", type=rate, default=1.0, help="speaking rate, 1 is normal")
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def run(args: argparse.Namespace) -> int:
    """Print to stdout."""
    chosen = voice(args.voice) if args.voice else default_voice(args.lang)
    texts = _lines_of_stdin() if args.text == "-" else iter([args.text])
    for text in texts:
        frontend = FrontEnd(args.lang, Manner(rate=args.rate).of(chosen))
        described = describe(text, frontend.feed(text) + frontend.end())
        if args.json or args.text == "-":
            print(json.dumps(described, ensure_ascii=False), flush=args.text == "-")
        else:
            print("\n".join(_lines(described)))
    return 0


def _lines_of_stdin() -> Iterator[str]:
    for line in sys.stdin.buffer:
        yield line.decode("utf-8", "replace").rstrip("\r\n")


def describe(text: str, utterances: list[Utterance]) -> dict[str, Any]:
    """The text's words with their phones, in order; pauses are left out."""
    words: list[dict[str, Any]] = []
    for utterance in utterances:
        phones: list[list[dict[str, Any]]] = [[] for _ in utterance.words]
        for phone in utterance.phones:
            if phone.word >= 0:
                f0 = round(sum(hz for _, hz in phone.pitch) / len(phone.pitch), 1) if phone.pitch else None
                row = {"phone": phone.name, "duration_ms": round(phone.duration_ms, 1), "f0_hz": f0}
                phones[phone.word].append(row)
        words += [{"word": w.text, "phones": p} for w, p in zip(utterance.words, phones, strict=True)]
    return {"text": text, "words": words}


def _lines(described: dict[str, Any]) -> Iterator[str]:
    for word in described["words"]:
        phones = " ".join(f"{p['phone']}:{p['duration_ms']:.0f}" for p in word["phones"])
        total = sum(p["duration_ms"] for p in word["phones"])
        yield f"{word['word']:<20} {total:5.0f} ms  {phones}"
