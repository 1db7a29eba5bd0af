"""Tokens and room, joined."""

from __future__ import annotations

import random
import time

import pytest

from fapstream.errors import Busy, NotAuthorised
from fapstream.protocol import generated as g
from fapstream.server.admission import Admission, Limits
from fapstream.server.gate import Gate
from fapstream.server.tokens import Grant, mint

SECRET = b"s" * 32


class Now:
    def now(self) -> float:
        return 5.0

    async def sleep_until(self, when: float) -> None:
        raise NotImplementedError


def gate(limits: Limits | None = None, *secrets: bytes) -> Gate:
    return Gate(Admission(limits or Limits(), random.Random(1)), Now(), secrets)


def token(*scopes: str, channel: str | None = None, ttl_s: float = 60) -> str:
    return mint(SECRET, Grant(frozenset(scopes), channel), ttl_s, time.time())


def test_without_secrets_everybody_may_do_everything() -> None:
    g_ = gate()
    g_.speak(g.Hello(channel="news"), "a")
    g_.listen(g.Listen(channel="news"), "a")
    g_.adapt(None, "a")
    g_.grant(None).require("metrics")
    assert g_.listen_token("news") is None


@pytest.mark.parametrize("shown", [None, "", "garbage", token("listen"), token("adapt", "metrics")])
def test_speaking_needs_its_scope(shown: str | None) -> None:
    with pytest.raises(NotAuthorised):
        gate(None, SECRET).speak(g.Hello(token=shown), "a")


def test_a_token_for_a_channel_is_for_that_channel() -> None:
    g_ = gate(None, SECRET)
    shown = token("speak", "listen", channel="news")
    g_.speak(g.Hello(token=shown, channel="news"), "a")
    g_.listen(g.Listen(token=shown, channel="news"), "a")
    for wish in (g.Hello(token=shown), g.Hello(token=shown, channel="olds")):
        with pytest.raises(NotAuthorised):
            g_.speak(wish, "a")
    with pytest.raises(NotAuthorised):
        g_.listen(g.Listen(token=shown, channel="olds"), "a")


def test_the_token_of_a_shared_session_allows_to_listen_to_it_and_nothing_else() -> None:
    g_ = gate(None, SECRET)
    shown = g_.listen_token("talk-1")
    assert shown
    g_.listen(g.Listen(token=shown, channel="talk-1"), "a")
    with pytest.raises(NotAuthorised):
        g_.listen(g.Listen(token=shown, channel="talk-2"), "a")
    with pytest.raises(NotAuthorised):
        g_.speak(g.Hello(token=shown, channel="talk-1"), "a")


def test_who_leaves_makes_room() -> None:
    g_ = gate(Limits(sessions=1))
    leave = g_.speak(g.Hello(), "a")
    with pytest.raises(Busy) as caught:
        g_.speak(g.Hello(), "b")
    assert caught.value.retry_ms > 0
    leave()
    g_.speak(g.Hello(), "b")


def test_who_sends_too_much_is_read_later() -> None:
    limits = Limits()
    pace = gate(limits).pace()
    assert all(pace(100) == 0 for _ in range(limits.messages_burst))
    assert pace(100) > 0
    pace = gate(limits).pace()
    assert pace(limits.bytes_burst) == 0
    assert pace(65_536) > 1
