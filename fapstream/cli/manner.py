"""The options that say how a text is read, for every command that reads one."""

from __future__ import annotations

import argparse
from dataclasses import replace
from pathlib import Path

from fapstream.cli.arguments import between, rate
from fapstream.errors import InputError
from fapstream.tts import DEFAULT_LOOK_AHEAD, PHRASE, Manner, read_lexicon, read_profile

MAX_BYTES = 16_000_000
"""A lexicon or profile that is larger is not read."""


def add_manner(parser: argparse.ArgumentParser) -> None:
    """--rate, --pitch, --volume, --look-ahead, --lexicon, --profile."""
    group = parser.add_argument_group("how it is read")
    group.add_argument("--rate", type=rate, metavar="X", help="speaking rate, 1 is normal")
    group.add_argument("--pitch", type=between(0.25, 4.0), metavar="X", help="pitch, 1 is the voice's own")
    group.add_argument("--volume", type=between(0.0, 4.0), metavar="X", help="loudness, 1 is the voice's own")
    group.add_argument(
        "--look-ahead",
        type=look_ahead,
        metavar="N",
        help="words that are waited for before a word is spoken: 0, 1, 2, ... or `phrase` (default: "
        f"{DEFAULT_LOOK_AHEAD} for a text that is still being written, else phrase)",
    )
    group.add_argument(
        "--lexicon",
        type=Path,
        metavar="F.tsv",
        help="own pronunciations: a word, a tab, and its phones as `fapstream phonemes` shows them, or in "
        "quotation marks the words it is read as",
    )
    group.add_argument(
        "--profile",
        type=Path,
        metavar="F.toml",
        help="own rhythm and melody: rate, pitch, volume, [phones.en] with mean durations in ms, and any "
        "entry of the package's prosody.toml",
    )


def look_ahead(text: str) -> int:
    """A number of words, or `phrase`. Raises ArgumentTypeError."""
    if text == "phrase":
        return PHRASE
    if not (text.isdecimal() and int(text) < PHRASE):
        raise argparse.ArgumentTypeError(f"{text!r} is neither a number of words nor `phrase`")
    return int(text)


def manner(args: argparse.Namespace, lang: str, complete: bool = True) -> Manner:
    """What the options ask for. `complete`: the text is all there. Raises DataError, InputError, OSError."""
    found = Manner(look_ahead=PHRASE if complete else DEFAULT_LOOK_AHEAD)
    if args.profile:
        found = read_profile(_text(args.profile), str(args.profile), found)
    if args.lexicon:
        found = replace(found, lexicon=read_lexicon(_text(args.lexicon), str(args.lexicon), lang))
    given = {name: getattr(args, name) for name in ("rate", "pitch", "volume", "look_ahead")}
    return replace(found, **{name: value for name, value in given.items() if value is not None})


def _text(path: Path) -> str:
    if path.stat().st_size > MAX_BYTES:
        raise InputError(f"{path} has more than {MAX_BYTES} bytes")
    try:
        return path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(f"{path} is not UTF-8 text: {error.reason} at byte {error.start}") from error
