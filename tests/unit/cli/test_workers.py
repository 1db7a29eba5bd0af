"""The supervisor with real processes: started, started again, told to stop, and none left behind."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress

import pytest

PROGRAM = """
import json, os, select, signal, sys, time
from fapstream.cli import workers
from fapstream.cli.workers import Supervisor
workers.SHORT_LIFE_S = 0.0 if "old" in sys.argv else 5.0
workers.EXTRA_S = 1.0

def say(what):
    os.write(1, (json.dumps(what) + "\\n").encode())

def work(index, line):
    if "cannot" in sys.argv and index == 1:
        raise RuntimeError("cannot start")
    if "deaf" in sys.argv:
        signal.signal(signal.SIGTERM, signal.SIG_IGN)
    say({"index": index, "pid": os.getpid()})
    line.ready()
    while not select.select([line.parent], [], [], 0.05)[0]:
        pass
    say({"orphan": index})

def helper(index, line):
    say({"helper": index, "pid": os.getpid()})
    line.ready()
    time.sleep(60)

def told(what, index=None):
    say({what: index})

status = Supervisor([work, work], [helper], lambda: told("all"), lambda index: told("died", index), 0.5).run()
told("end", status)
sys.exit(status)
"""


@contextmanager
def supervised(*how: str) -> Iterator[subprocess.Popen[str]]:
    process = subprocess.Popen(
        [sys.executable, "-c", PROGRAM, *how], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    try:
        yield process
    finally:
        process.kill()
        process.wait()


def until(process: subprocess.Popen[str], key: str) -> list[dict[str, int]]:
    """Everything told, up to the first line with the key."""
    assert process.stdout
    out: list[dict[str, int]] = []
    for line in process.stdout:
        out.append(json.loads(line))
        if key in out[-1]:
            return out
    raise AssertionError(f"no {key} in {out}")


def gone(pid: int) -> bool:
    """Whether it ends within two seconds."""
    for _ in range(200):
        with suppress(ProcessLookupError):
            os.kill(pid, 0)
            time.sleep(0.01)
            continue
        return True
    return False


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_all_are_started_and_stopped(number: signal.Signals) -> None:
    with supervised() as process:
        told = until(process, "all")
        pids = [t["pid"] for t in told if "pid" in t]
        assert len(pids) == 3
        process.send_signal(number)
        assert until(process, "end")[-1]["end"] == 0
        assert process.wait(5) == 0
        assert all(gone(pid) for pid in pids)


def test_one_that_dies_is_started_again() -> None:
    with supervised("old") as process:
        victim = next(t for t in until(process, "all") if t.get("index") == 1)
        os.kill(victim["pid"], signal.SIGKILL)
        told = until(process, "index")
        assert told[0] == {"died": 1}
        assert told[-1]["index"] == 1
        assert told[-1]["pid"] != victim["pid"]


def test_one_that_dies_young_is_started_again_after_a_while() -> None:
    with supervised() as process:
        victim = next(t for t in until(process, "all") if t.get("index") == 0)
        start = time.monotonic()
        os.kill(victim["pid"], signal.SIGKILL)
        until(process, "index")
        assert time.monotonic() - start > 0.5


def test_one_that_cannot_start_ends_everything() -> None:
    with supervised("cannot") as process:
        assert process.wait(10) == 1
        assert process.stdout
        assert process.stderr
        pids = [json.loads(line).get("pid") for line in process.stdout if "pid" in line]
        assert all(gone(pid) for pid in pids)
        assert "cannot start" in process.stderr.read()


def test_one_that_does_not_end_is_killed() -> None:
    with supervised("deaf") as process:
        pids = [t["pid"] for t in until(process, "all") if "pid" in t]
        process.terminate()
        assert process.wait(15) == 0
        assert all(gone(pid) for pid in pids)


def test_workers_whose_parent_was_killed_notice() -> None:
    with supervised() as process:
        pids = [t["pid"] for t in until(process, "all") if "index" in t]
        process.kill()
        assert until(process, "orphan")
        assert all(gone(pid) for pid in pids)
