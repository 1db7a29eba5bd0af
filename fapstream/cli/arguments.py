"""Types of arguments that more than one command takes."""

from __future__ import annotations

import argparse

SLOWEST, FASTEST = 0.25, 4.0


def rate(text: str) -> float:
    """A speaking rate; 1 is normal. Raises ArgumentTypeError."""
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not SLOWEST <= value <= FASTEST:
        raise argparse.ArgumentTypeError(f"{text!r} is not from {SLOWEST} to {FASTEST:g}")
    return value


def unicode_text(text: str) -> str:
    """The text; bytes of the command line that are no UTF-8 become U+FFFD."""
    return text.encode("utf-16", "surrogatepass").decode("utf-16", "replace")
