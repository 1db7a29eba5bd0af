"""What the server's editor page works with: each page has a process of its own, made when it comes.

Making a head is work for whole seconds; in the server's process it would hold up those who speak. It also
reads photos from strangers: whatever that does to the process, it harms nobody else.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
import time
from collections.abc import Callable
from multiprocessing.connection import Connection
from typing import TYPE_CHECKING, Any

from fapstream.cli.heads import packaged
from fapstream.errors import FapstreamError, InputError
from fapstream.head.gltf import read_head
from fapstream.protocol.adapting import decode, encode

if TYPE_CHECKING:
    from fapstream.adapt.session import Session
    from fapstream.ports import Landmarker

NEEDED = "adapting a head needs Pillow and SciPy on the server: pip install 'fapstream[adapt]'"

DEADLINE_S = 60.0
"""A process that has not answered for so long is ended; the longest fit takes seconds."""
NICE = 10
"""Whoever speaks goes first."""

Message = dict[str, Any]
Make = Callable[[Callable[[], float]], "Session"]


def editor(clock: Callable[[], float]) -> Session:
    """A session for one page. Raises InputError where the adapt extra is not installed."""
    try:
        from fapstream.adapt.session import Session
    except ModuleNotFoundError as e:
        if (e.name or "").partition(".")[0] in ("PIL", "scipy"):
            raise InputError(NEEDED) from None
        raise
    return Session(read_head(packaged("generic").read_bytes(), "generic"), _finder(), clock)


class EditorProcess:
    """A session in a process of its own. Messages cross as bytes of the protocol, which can do no harm."""

    def __init__(self, make: Make = editor, deadline_s: float = DEADLINE_S) -> None:
        """Raises InputError where `make` does. Takes a second or two."""
        self._deadline_s = deadline_s
        spawning = multiprocessing.get_context("spawn")
        self._channel, theirs = spawning.Pipe()
        self._process = spawning.Process(target=_work, args=(theirs, make), name="editor", daemon=True)
        self._process.start()
        theirs.close()
        self._ready = self._received()
        if self._ready["type"] == "error":
            self.close()
            raise InputError(self._ready["message"])

    def ready(self) -> Message:
        """The first message."""
        return self._ready

    def answer(self, message: Message) -> Message:
        """What to send for a message; a fatal error if the process came to its end over it."""
        try:
            self._channel.send_bytes(encode(message))
        except OSError:
            return _ended("the process that makes heads ended")
        return self._received()

    def close(self) -> None:
        """End the process, whatever it does."""
        self._process.kill()
        self._process.join()

    def _received(self) -> Message:
        try:
            if not self._channel.poll(self._deadline_s):
                return _ended(f"making the head took more than {self._deadline_s:g} s")
            return decode(self._channel.recv_bytes())
        except (OSError, EOFError):
            return _ended("the process that makes heads ended")


def _ended(why: str) -> Message:
    return {"type": "error", "code": "internal", "message": f"{why}; load the page again", "fatal": True}


def _work(channel: Connection, make: Make) -> None:
    """The other process: until the page is gone, or the server."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    os.nice(NICE)
    try:
        session = make(time.perf_counter)
    except FapstreamError as e:
        channel.send_bytes(encode({"type": "error", "code": e.code, "message": str(e)}))
        return
    answer = session.ready()
    while True:
        try:
            channel.send_bytes(encode(answer))
            message = decode(channel.recv_bytes())
        except (OSError, EOFError):
            return
        answer = session.answer(message)


def _finder() -> Landmarker | None:
    """None where the landmarks extra is not installed: points are then placed by hand."""
    from fapstream.adapters import landmarks

    try:
        return landmarks.Landmarker()
    except FapstreamError:
        return None
