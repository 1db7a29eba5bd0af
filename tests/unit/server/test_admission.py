"""Who may come in: counts that never drift, refusals that spread, rates that hold, no false addresses."""

from __future__ import annotations

import random
from collections import Counter
from contextlib import suppress
from dataclasses import replace
from typing import get_args

import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, rule

from fapstream.errors import Busy, InputError
from fapstream.server.admission import Admission, Bucket, Kind, Limits, Load, address_of, networks

KINDS: tuple[Kind, ...] = get_args(Kind)
SMALL = replace(
    Limits(), sessions=5, sessions_per_address=2, listeners=7, listeners_per_address=3,
    adapting=2, adapting_per_address=1, opening=9, opening_per_address=4,
)  # fmt: skip


def admission(limits: Limits = SMALL) -> Admission:
    return Admission(limits, random.Random(1))


class Door(RuleBasedStateMachine):
    """Against a plain list of who is in."""

    def __init__(self) -> None:
        super().__init__()
        self.door = admission()
        self.inside: list[tuple[Kind, str]] = []

    @rule(kind=st.sampled_from(KINDS), address=st.sampled_from("abc"))
    def comes(self, kind: Kind, address: str) -> None:
        most, most_of_one = SMALL.of(kind)
        room = sum(k == kind for k, _ in self.inside) < most
        room = room and self.inside.count((kind, address)) < most_of_one
        try:
            self.door.enter(kind, address, 0.0)
        except Busy:
            assert not room
        else:
            assert room
            self.inside.append((kind, address))

    @rule(data=st.data())
    def goes(self, data: st.DataObject) -> None:
        if self.inside:
            self.door.leave(*self.inside.pop(data.draw(st.integers(0, len(self.inside) - 1))))

    @invariant()
    def counts(self) -> None:
        for kind in KINDS:
            assert self.door.inside(kind) == sum(k == kind for k, _ in self.inside)
        assert len(self.door._from) == len(set(self.inside)), "nobody is remembered who left"


TestDoor = Door.TestCase


def test_a_refusal_says_why_and_when_to_come_back() -> None:
    door = admission()
    for _ in range(2):
        door.enter("session", "a", 0.0)
    with pytest.raises(
        Busy, match=r"too many sessions are open from your address; try again in \d s"
    ) as caught:
        door.enter("session", "a", 0.0)
    assert caught.value.code == "busy"
    assert 1000 <= caught.value.retry_ms <= 6000
    door.leave("session", "a")
    door.enter("session", "a", 0.0)


@pytest.mark.parametrize("crowd", [100, 1000, 20_000])
def test_those_who_were_refused_come_back_one_after_the_other(crowd: int) -> None:
    door = admission(replace(SMALL, sessions=0))
    back: Counter[int] = Counter()
    for _ in range(crowd):
        with pytest.raises(Busy) as caught:
            door.enter("session", "a", 100.0)
        back[caught.value.retry_ms // 1000] += 1
    assert min(back) >= 1
    assert max(back) <= 65
    even = max(20, crowd / 60)
    assert max(back.values()) < 2 * even + 15


def test_the_queue_is_forgotten() -> None:
    door = admission(replace(SMALL, sessions=0))

    def delay_ms(now: float) -> int:
        with pytest.raises(Busy) as caught:
            door.enter("session", "a", now)
        return caught.value.retry_ms

    assert max(delay_ms(0.0) for _ in range(1000)) > 40_000
    assert delay_ms(300.0) < 6000


def load(late_of_100: int, packets: int = 1000, until: float = 10.0) -> Load:
    """What a server was like whose packets were late so often."""
    made = Load(0.02)
    for i in range(packets):
        made.sent(0.05 if i % 100 < late_of_100 else 0.001, until * (i + 1) / packets)
    return made


def test_a_server_that_is_behind_takes_nobody_new() -> None:
    door = admission()
    door.enter("session", "a", 0.0)
    for i in range(200):
        door.load.sent(0.021, i / 100)
    for kind in ("session", "listener", "adapting"):
        with pytest.raises(Busy, match="behind"):
            door.enter(kind, "b", 2.0)
    assert door.inside("session") == 1
    door.enter("opening", "b", 2.0)


@pytest.mark.parametrize(("late_of_100", "strained"), [(0, False), (1, False), (3, True), (100, True)])
def test_the_99th_percentile_decides(late_of_100: int, strained: bool) -> None:
    assert load(late_of_100).strained(10.0) is strained


def test_a_few_late_packets_of_a_quiet_server_are_no_strain() -> None:
    made = Load(0.02)
    for i in range(4):
        made.sent(1.0, i / 10)
    assert not made.strained(0.4)


def test_strain_passes_with_packets_in_time_and_without_any() -> None:
    assert load(100).strained(10.0)
    assert not load(100).strained(12.1), "everybody has left"
    sustained = load(100)
    for i in range(10_000):
        sustained.sent(1.0 if i % 50 == 0 else 0.0, 10.0 + i / 400)
    assert sustained.strained(35.0), "one in fifty, on and on"
    healing = load(100)
    for i in range(10_000):
        healing.sent(0.0, 10.0 + i / 400)
    assert not healing.strained(35.0)


def test_late_is_what_is_later_than_the_limit() -> None:
    exact = Load(0.02)
    for _ in range(100):
        exact.sent(0.02, 1.0)
    assert not exact.strained(1.0)


# rates


@given(
    amounts=st.lists(st.tuples(st.floats(0, 5), st.integers(0, 500)), min_size=1, max_size=60),
    per_s=st.floats(0.5, 1000), burst=st.integers(1, 1000),
)  # fmt: skip
def test_over_any_time_no_more_than_the_rate_and_the_burst_passes(
    amounts: list[tuple[float, int]], per_s: float, burst: int
) -> None:
    """Who waits as told has had at most burst + rate x time, one thing aside."""
    bucket, now, passed = Bucket(per_s, burst), 0.0, 0.0
    for pause, amount in amounts:
        now += pause + bucket.take(amount, now + pause)
        passed += amount
        assert passed <= burst + per_s * now + 1e-6 * (1 + passed)


def test_a_bucket_waits_no_longer_than_it_must() -> None:
    bucket = Bucket(10.0, 20.0)
    assert [bucket.take(10, 0.0) for _ in range(4)] == [0.0, 0.0, 1.0, 2.0]
    assert bucket.take(0, 2.0) == 0.0
    assert bucket.take(5, 2.5) == 0.0
    assert bucket.take(20, 1e9) == 0.0, "full again"
    assert bucket.take(1, 1e9) == pytest.approx(0.1)


def test_an_article_passes_in_one_piece_and_a_flood_does_not() -> None:
    limits = Limits()
    bucket = Bucket(limits.bytes_per_s, limits.bytes_burst)
    waits = [bucket.take(65_536, 0.0) for _ in range(32)]
    assert waits[:16] == [0.0] * 16
    assert waits[31] > 60


# addresses

PROXIES = networks(["127.0.0.1", "10.0.0.0/8", "fd00::/8"])


@pytest.mark.parametrize(
    ("peer", "forwarded", "found"),
    [
        ("1.2.3.4", None, "1.2.3.4"),
        ("1.2.3.4", "9.9.9.9", "1.2.3.4"),  # a stranger's word
        ("127.0.0.1", None, "127.0.0.1"),
        ("127.0.0.1", "", "127.0.0.1"),
        ("127.0.0.1", "5.6.7.8", "5.6.7.8"),
        ("127.0.0.1", "9.9.9.9, 5.6.7.8", "5.6.7.8"),  # what the client itself wrote stands left
        ("127.0.0.1", "9.9.9.9, 5.6.7.8, 10.1.1.1", "5.6.7.8"),
        ("127.0.0.1", "10.9.9.9, 10.1.1.1", "10.9.9.9"),
        ("127.0.0.1", "5.6.7.8, unknown", "127.0.0.1"),
        ("127.0.0.1", "5.6.7.8, , 10.1.1.1,", "5.6.7.8"),
        ("127.0.0.1", "5.6.7.8:4711", "5.6.7.8"),
        ("127.0.0.1", "[2001:db8:1:2:3::9]:4711", "2001:db8:1:2::/64"),
        ("127.0.0.1", '"[2001:db8:1:2::9]"', "2001:db8:1:2::/64"),
        ("2001:db8:1:2:3:4:5:6", None, "2001:db8:1:2::/64"),
        ("2001:db8:1:2:ffff::", None, "2001:db8:1:2::/64"),
        ("2001:db8:1:3::1", None, "2001:db8:1:3::/64"),
        ("fe80::1%eth0", None, "fe80::/64"),
        ("::ffff:1.2.3.4", None, "1.2.3.4"),
        ("::ffff:127.0.0.1", "5.6.7.8", "5.6.7.8"),
        ("fd00::5", "5.6.7.8", "5.6.7.8"),
        ("", "5.6.7.8", ""),
        ("/run/socket", "5.6.7.8", "/run/socket"),
    ],
)
def test_the_rightmost_stranger_counts(peer: str, forwarded: str | None, found: str) -> None:
    assert address_of(peer, forwarded, PROXIES) == found


@given(peer=st.ip_addresses(), forwarded=st.text(max_size=60))
def test_nobody_untrusted_can_be_somebody_else(peer: object, forwarded: str) -> None:
    assert address_of(str(peer), forwarded, ()) == address_of(str(peer), None, ())


@given(st.lists(st.ip_addresses().map(str) | st.text(max_size=9).filter(lambda t: "," not in t), max_size=5))
def test_what_a_client_writes_does_not_hide_what_a_proxy_wrote(lies: list[str]) -> None:
    assert address_of("10.0.0.1", ",".join([*lies, "5.6.7.8"]), PROXIES) == "5.6.7.8"


@pytest.mark.parametrize("text", ["", "x", "10.0.0.0/33", "proxy.local"])
def test_networks_that_are_none(text: str) -> None:
    with pytest.raises(InputError, match="no address and no network"):
        networks([text])


def test_leaving_makes_room_under_refusals() -> None:
    door = admission()
    for n in range(50):
        with suppress(Busy):
            door.enter("listener", str(n), 0.0)
    assert door.inside("listener") == SMALL.listeners
