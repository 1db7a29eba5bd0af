"""`fapstream COMMAND`: the one place that builds the rooms and joins them."""

from __future__ import annotations

import argparse
import sys
import textwrap
from collections.abc import Sequence

from fapstream import __version__
from fapstream.cli import adapt, convert, head, phonemes, say, serve, token, view, voices
from fapstream.errors import FapstreamError

COMMANDS = (say, serve, phonemes, view, voices, convert, head, adapt, token)


def main(argv: Sequence[str] | None = None) -> int:
    """Run a command; the exit status is 0, 1 for what could not be done, 2 for a wrong call."""
    parser = argparse.ArgumentParser(
        prog="fapstream", description="A talking head: text in, voice and face out."
    )
    parser.add_argument("--version", action="version", version=f"fapstream {__version__}")
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    for module in COMMANDS:
        name = module.__name__.rpartition(".")[2]
        sub = commands.add_parser(
            name, help=module.HELP, description=_filled(module.__doc__ or ""),
            formatter_class=argparse.RawDescriptionHelpFormatter,
        )  # fmt: skip
        module.add_arguments(sub)
        sub.set_defaults(run=module.run)
    args = parser.parse_args(argv)
    try:
        status: int = args.run(args)
    except FapstreamError as e:
        print(f"fapstream: {e}", file=sys.stderr)
        return 1
    except OSError as e:
        print(f"fapstream: {f'{e.filename}: ' if e.filename else ''}{e.strerror or e}", file=sys.stderr)
        return 1
    except (KeyboardInterrupt, BrokenPipeError):
        return 130
    return status


def _filled(text: str) -> str:
    """Paragraphs as they fit on a terminal."""
    return "\n\n".join(textwrap.fill(paragraph, 79) for paragraph in text.strip().split("\n\n"))
