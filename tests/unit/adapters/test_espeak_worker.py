"""The worker's side of the pipe: frames out for lines in, whatever the lines are."""

from __future__ import annotations

import io
import json

import numpy as np
import pytest

from fapstream.adapters import espeak, espeak_worker
from fapstream.adapters.espeak_worker import FRAME, Worker

pytestmark = pytest.mark.skipif(not espeak.installed(), reason="the extra `espeak` is not installed")

HELLO = {"voice": "en-us", "text": "[[h|@|l|'oU]]", "rate": 175, "pitch": 50}

Frames = list[tuple[str, bytes]]


def frames(data: bytes) -> Frames:
    out, at = [], 0
    while at < len(data):
        kind, size = FRAME.unpack_from(data, at)
        at += FRAME.size
        out.append((chr(kind), data[at : at + size]))
        at += size
    assert at == len(data)
    return out


@pytest.fixture(scope="module")
def worker() -> Worker:
    """The library can be set up once in a process."""
    return Worker(io.BytesIO())


def said(worker: Worker, request: dict[str, object]) -> Frames:
    worker._out = out = io.BytesIO()
    worker.speak(request)
    return frames(out.getvalue())


def test_sound_and_events_and_an_end(worker: Worker) -> None:
    found = said(worker, HELLO)
    assert [kind for kind, _ in found].count("E") == 1
    assert found[-1] == ("E", b"")
    sound = np.frombuffer(b"".join(body for kind, body in found if kind == "S"), "<i2")
    assert len(sound) > 0.2 * worker.sample_rate
    assert np.abs(sound).max() > 2000
    events = [event for kind, body in found if kind == "P" for event in json.loads(body)]
    assert [name for name, _ in events if not name.startswith("_")] == ["h", "@", "l", "'oU"]
    times = [at for _, at in events]
    assert times == sorted(times)
    assert times[-1] <= len(sound)


def test_one_request_leaves_nothing_for_the_next(worker: Worker) -> None:
    """The sound differs a little (its noise goes on from where it was), the phonemes do not."""

    def names() -> list[str]:
        return [e[0] for kind, body in said(worker, HELLO) if kind == "P" for e in json.loads(body)]

    before = names()
    said(worker, {**HELLO, "voice": "el", "text": "[[k|a|l|o]]"})
    assert names() == before


def test_rate_and_voice_are_taken_from_the_request(worker: Worker) -> None:
    def length(**more: object) -> int:
        return sum(len(body) for kind, body in said(worker, {**HELLO, **more}) if kind == "S")

    assert length(rate=350) < 0.8 * length()
    assert length(voice="el") > 0


@pytest.mark.parametrize("text", ["", "[[]]", "[[", "\x00", "🙂", "]]", "[[~~|'|%%]]"])
def test_any_text_ends(worker: Worker, text: str) -> None:
    assert said(worker, {**HELLO, "text": text})[-1] == ("E", b"")


def test_main_reports_what_it_cannot_do_and_goes_on(monkeypatch: pytest.MonkeyPatch, worker: Worker) -> None:
    lines = [
        b"no json\n",
        b"{}\n",
        json.dumps({**HELLO, "voice": "nobody"}).encode() + b"\n",
        b"[]\n",
        json.dumps({**HELLO, "rate": "fast"}).encode() + b"\n",
        json.dumps(HELLO).encode() + b"\n",
    ]
    out = io.BytesIO()
    worker._out = out
    monkeypatch.setattr(espeak_worker, "Worker", lambda _: worker)
    stdin = type("Stdin", (), {"buffer": lines})
    monkeypatch.setattr("sys.stdin", stdin)
    espeak_worker.main()
    found = frames(out.getvalue())
    assert [kind for kind, _ in found][:5] == ["X"] * 5
    assert b"nobody" in found[2][1]
    assert found[-1] == ("E", b"")
