"""Print words, syllables, phones, durations and pitch of a text, without speaking it."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Iterator

from fapstream.cli.arguments import unicode_text
from fapstream.cli.describe import described, lines
from fapstream.cli.manner import add_manner, manner
from fapstream.tts import LANGUAGES, FrontEnd
from fapstream.tts.voices import default_voice, voice

HELP = "show how a text would be pronounced"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """TEXT, --lang, --voice, --json, and how it is read."""
    parser.add_argument(
        "text",
        type=unicode_text,
        help="the text; `-` reads one utterance a line from stdin and writes JSON lines",
    )
    parser.add_argument("--lang", choices=LANGUAGES, help="language (default: the voice's, or en)")
    parser.add_argument("--voice", help="take the pitch of this voice")
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    add_manner(parser)


def run(args: argparse.Namespace) -> int:
    """Print to stdout."""
    lang = args.lang or (voice(args.voice).lang if args.voice else LANGUAGES[0])
    wished = manner(args, lang).of(voice(args.voice) if args.voice else default_voice(lang))
    for text in _lines_of_stdin() if args.text == "-" else iter([args.text]):
        frontend = FrontEnd(lang, wished)
        words = described(frontend, frontend.feed(text) + frontend.end())
        if args.json or args.text == "-":
            print(json.dumps({"text": text, "words": words}, ensure_ascii=False), flush=args.text == "-")
        else:
            print("\n".join(lines(words)))
    return 0


def _lines_of_stdin() -> Iterator[str]:
    for line in sys.stdin.buffer:
        yield line.decode("utf-8", "replace").rstrip("\r\n")
