"""Print a token that lets its holder speak, listen or make heads on a server; or a fresh secret to sign with.

The secret is read from --secret-file or from FAPSTREAM_SECRET, as `fapstream serve` does. Of several the
first signs.
"""

from __future__ import annotations

import argparse
import os
import time
from pathlib import Path

from fapstream.cli.arguments import between
from fapstream.errors import InputError
from fapstream.server.tokens import SCOPES, SECRET_VARIABLE, Grant, mint, new_secret, read_secrets

HELP = "print a token for a server that asks for one"
HOURS = 12.0
LONGEST_HOURS = 10 * 366 * 24


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """--scope, --channel, --subject, --hours or --minutes, --secret-file; or --new-secret."""
    parser.add_argument(
        "--scope", action="append", choices=SCOPES, default=[], help="what it allows; can be given again"
    )
    parser.add_argument("--channel", metavar="NAME", help="the only channel to speak into or listen to")
    parser.add_argument("--subject", metavar="NAME", default="", help="who it is for; stands in the log")
    lasts = parser.add_mutually_exclusive_group()
    lasts.add_argument(
        "--hours", type=between(1 / 3600, LONGEST_HOURS), default=HOURS,
        help=f"hours it is good for (default {HOURS:g})",
    )  # fmt: skip
    lasts.add_argument("--minutes", type=between(1 / 60, 60 * LONGEST_HOURS), help="the same in minutes")
    parser.add_argument(
        "--secret-file", type=Path, metavar="F", help=f"secrets, one a line (default: ${SECRET_VARIABLE})"
    )
    parser.add_argument("--new-secret", action="store_true", help="print a fresh secret instead")


def run(args: argparse.Namespace) -> int:
    """One line."""
    if args.new_secret:
        print(new_secret())
        return 0
    if not args.scope:
        raise InputError(f"what shall the token allow? --scope {', --scope '.join(SCOPES)}")
    secrets = read_secrets(args.secret_file, os.environ)
    if not secrets:
        raise InputError(f"no secret to sign with: give --secret-file F or set {SECRET_VARIABLE}")
    minutes = 60 * args.hours if args.minutes is None else args.minutes
    grant = Grant(frozenset(args.scope), args.channel, args.subject)
    print(mint(secrets[0], grant, 60 * minutes, time.time()))
    return 0
