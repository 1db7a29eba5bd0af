"""Progress changes one line of a terminal, and adds a line to a log now and then."""

from __future__ import annotations

import io
import itertools

import pytest

from fapstream.cli.progress import Progress


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


@pytest.mark.parametrize(
    ("stream", "step", "written"),
    [
        (Terminal(), 0.15, "\r2 of 5 things\x1b[K\r4 of 5 things\x1b[K\r\x1b[K"),
        (Terminal(), 0.01, "\r\x1b[K"),
        (io.StringIO(), 3.0, "4 of 5 things\n"),
        (io.StringIO(), 0.1, ""),
    ],
)
def test_what_is_written(stream: io.StringIO, step: float, written: str) -> None:
    clock = itertools.count(100.0, step)
    progress = Progress("things", stream, lambda: next(clock))
    for done in range(1, 6):
        progress(done, 5)
    assert stream.getvalue() == written
