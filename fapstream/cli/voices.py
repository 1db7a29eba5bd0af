"""List the voices and say which can speak on this machine."""

from __future__ import annotations

import argparse

from fapstream.adapters.pool import installed
from fapstream.tts.voices import voices

HELP = "list the voices"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """None."""


def run(args: argparse.Namespace) -> int:
    """One line a voice."""
    for v in voices():
        state = "installed" if installed(v) else "not installed"
        print(f"{v.name:<12} {v.lang:<4} {v.engine:<7} {v.sample_rate:>6} Hz  {state:<14} {v.description}")
    return 0
