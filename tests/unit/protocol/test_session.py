"""protocol/SPEC.md section 4: the scripts of protocol/vectors/sessions.json, and what they leave open."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fapstream import records
from fapstream.errors import LocalProtocolError, RemoteProtocolError
from fapstream.protocol import generated as g
from fapstream.protocol.codec import encode
from fapstream.protocol.session import ClientSession, EndOfText, ServerSession, Text
from tests.unit.protocol.test_codec import to_record

SCRIPTS = json.loads(
    (Path(__file__).parents[3] / "protocol" / "vectors" / "sessions.json").read_text(encoding="utf-8")
)


def check_receive(session: ServerSession | ClientSession, step: dict[str, Any]) -> None:
    data = encode(to_record(step["receive"]))
    if "error" in step:
        with pytest.raises(RemoteProtocolError) as caught:
            session.receive(data)
        assert caught.value.code == step["error"]
        return
    events = session.receive(data)
    if "events" not in step:
        return
    assert len(events) == len(step["events"])
    for event, wanted in zip(events, step["events"], strict=True):
        expected = Text if "text" in wanted else EndOfText
        assert isinstance(event, expected)
        assert (event.turn, event.text) == (wanted["turn"], wanted.get("text", wanted.get("end")))


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda s: s["name"])
def test_script(script: dict[str, Any]) -> None:
    session = ServerSession() if script["side"] == "server" else ClientSession()
    for step in script["steps"]:
        if "receive" in step:
            check_receive(session, step)
        elif "reconnect" in step:
            assert isinstance(session, ClientSession)
            session.reconnect()
        elif step.get("refused"):
            with pytest.raises(LocalProtocolError):
                session.send(to_record(step["send"]))
        else:
            session.send(to_record(step["send"]))
        if "state" in step:
            assert session.state == step["state"]
        if "received" in step:
            assert session.received == step["received"]
        if "again" in step:
            assert isinstance(session, ClientSession)
            assert session.again == [encode(to_record(message)) for message in step["again"]]


def open_pair() -> tuple[ClientSession, ServerSession]:
    client, server = ClientSession(), ServerSession()
    server.receive(client.send(g.Hello()))
    ready = g.Ready(server="s", session="1", fps=25, faps=bytes(range(3, 69)), voices=(), heads=())
    client.receive(server.send(ready))
    return client, server


@given(st.text(max_size=40), st.lists(st.integers(1, 5), min_size=1, max_size=200))
def test_text_survives_any_cut(text: str, cuts: list[int]) -> None:
    client, server = open_pair()
    data, heard, at = text.encode("utf-8"), "", 0
    for size in [*cuts, len(data) + 1]:
        for event in server.receive(client.send(g.Speak(turn=1, text=data[at : at + size]))):
            assert isinstance(event, Text)
            heard += event.text
        at += size
    [end] = server.receive(client.send(g.End(turn=1)))
    assert isinstance(end, EndOfText)
    assert heard + end.text == text


def test_a_packet_keeps_its_frames_and_marks() -> None:
    client, server = open_pair()
    server.receive(client.send(g.Speak(turn=1, text=b"a")))
    client.receive(server.send(g.Begin(turn=1, voice="gr2", lang="el", sample_rate=22050, fps=50)))
    frames = tuple(records.FapFrame(441 * k, np.arange(68, dtype=np.int32) * (k + 1)) for k in range(2))
    for frame in frames:
        frame.values[:2] = 0
    mark = records.Mark("word", 5, 100, "a", 0, 1)
    packet = records.Packet(1, 0, np.arange(882, dtype=np.int16), frames, (mark,), True)
    [back] = client.receive(server.send_packet(packet)[0])
    assert isinstance(back, records.Packet)
    assert back.marks == (mark,)
    assert back.hold
    assert [f.sample for f in back.frames] == [0, 441]
    assert all(np.array_equal(a.values, b.values) for a, b in zip(back.frames, frames, strict=True))


def test_ready_with_impossible_faps_is_refused() -> None:
    client, server = ClientSession(), ServerSession()
    server.receive(client.send(g.Hello()))
    with pytest.raises(RemoteProtocolError):
        client.receive(server.send(g.Ready(server="s", session="1", fps=25, faps=b"\0", voices=(), heads=())))
