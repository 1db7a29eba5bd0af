"""Types of arguments that more than one command takes."""

from __future__ import annotations

import argparse
from collections.abc import Callable


def between(low: float, high: float) -> Callable[[str], float]:
    """A type for numbers within the limits; what is none raises ArgumentTypeError."""

    def number(text: str) -> float:
        try:
            value = float(text)
        except ValueError:
            value = float("nan")
        if not low <= value <= high:
            raise argparse.ArgumentTypeError(f"{text!r} is not from {low:g} to {high:g}")
        return value

    return number


def port(text: str) -> int:
    """A port to listen on, 0 for any that is free. Raises ArgumentTypeError."""
    if not (text.isdecimal() and int(text) < 1 << 16):
        raise argparse.ArgumentTypeError(f"{text!r} is no whole number from 0 to 65535")
    return int(text)


rate = between(0.25, 4.0)
"""A speaking rate; 1 is normal."""


def unicode_text(text: str) -> str:
    """The text; bytes of the command line that are no UTF-8 become U+FFFD."""
    return text.encode("utf-16", "surrogatepass").decode("utf-16", "replace")
