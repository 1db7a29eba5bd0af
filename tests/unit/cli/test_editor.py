"""What the editor page works with."""

from __future__ import annotations

import os
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import pytest

from fapstream.cli.editor import EditorProcess, Make, editor
from fapstream.errors import InputError


def test_a_session_is_ready() -> None:
    message = editor(lambda: 0.0).ready()
    assert message["type"] == "ready"
    assert isinstance(message["automatic"], bool)


def test_without_the_extra_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in [name for name in sys.modules if name.startswith("fapstream.adapt.")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.delitem(sys.modules, "fapstream.adapt", raising=False)
    monkeypatch.setitem(sys.modules, "PIL", None)
    with pytest.raises(InputError, match="adapt"):
        editor(lambda: 0.0)


class Double:
    """Does to its process what a message says."""

    def __init__(self, clock: Callable[[], float]) -> None:
        pass

    def ready(self) -> dict[str, Any]:
        return {"type": "ready", "pid": os.getpid(), "nice": os.nice(0)}

    def answer(self, message: dict[str, Any]) -> dict[str, Any]:
        if message["type"] == "crash":
            os._exit(139)
        time.sleep(message.get("seconds", 0))
        return {"type": "fit", "size": len(message.get("data", b""))}


def refused(clock: Callable[[], float]) -> Double:
    raise InputError("pip install something")


@contextmanager
def process(make: Any = Double, deadline_s: float = 30.0) -> Iterator[EditorProcess]:
    made = EditorProcess(make, deadline_s)
    try:
        yield made
    finally:
        made.close()
    assert not alive(made.ready()["pid"])


def alive(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    return True


def test_it_answers_from_a_process_that_lets_others_go_first() -> None:
    with process() as made:
        ready = made.ready()
        assert ready["pid"] != os.getpid()
        assert ready["nice"] > os.nice(0)
        assert made.answer({"type": "photo", "data": bytes(8 << 20)}) == {"type": "fit", "size": 8 << 20}


@pytest.mark.parametrize("again", [False, True])
def test_a_process_that_dies_is_said(again: bool) -> None:
    with process() as made:
        for _ in range(1 + again):
            answer = made.answer({"type": "crash"})
            assert (answer["code"], answer["fatal"]) == ("internal", True)


def test_an_answer_that_takes_too_long_is_not_waited_for() -> None:
    with process() as made:
        made._deadline_s = 0.1
        assert "more than 0.1 s" in made.answer({"type": "points", "seconds": 20})["message"]


def test_it_can_be_stopped_in_the_middle() -> None:
    with process() as made:
        answers: list[dict[str, Any]] = []
        thread = threading.Thread(target=lambda: answers.append(made.answer({"type": "head", "seconds": 20})))
        thread.start()
        time.sleep(0.1)
        made.close()
        thread.join(5)
        assert answers[0]["fatal"]


def test_what_it_cannot_do_is_said_here() -> None:
    make: Make = refused  # type: ignore[assignment]
    with pytest.raises(InputError, match="pip install something"):
        EditorProcess(make)
