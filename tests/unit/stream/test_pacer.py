"""protocol/SPEC.md section 3: at most 1.5 s ahead of what is heard. Time is an argument."""

from __future__ import annotations

from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fapstream.stream.pacer import FIRST_S, LEAD_S, Pacer

RATE = 16000
PACKET = 640


def send(pacer: Pacer, packets: int, now: float, first: int = 0) -> None:
    for k in range(first, first + packets):
        pacer.sent(k * PACKET, (k + 1) * PACKET, now)


def test_before_anything_is_sent_nothing_waits_and_nothing_is_heard() -> None:
    pacer = Pacer(RATE)
    assert pacer.due(0, 12.5) == 12.5
    assert pacer.heard(12.5) == 0
    pacer.acknowledge(100, 12.5)
    assert pacer.due(0, 13.0) == 13.0


def test_packets_leave_the_lead_before_they_are_heard() -> None:
    pacer = Pacer(RATE)
    send(pacer, 1, now=100.0)
    assert pacer.due(5 * RATE, 100.0) == pytest.approx(100.0 + 5.0 - LEAD_S)
    assert pacer.due(10 * RATE, 100.0) == pytest.approx(100.0 + 10.0 - LEAD_S)


def test_a_late_packet_shifts_everything_behind_it() -> None:
    pacer = Pacer(RATE)
    send(pacer, 1, now=0.0)
    pacer.sent(PACKET, 2 * PACKET, 3.04)
    assert pacer.due(5 * RATE, 3.04) == pytest.approx(3.0 + 5.0 - LEAD_S)
    assert pacer.heard(3.04) == PACKET


def test_an_early_packet_shifts_nothing() -> None:
    pacer = Pacer(RATE)
    send(pacer, 30, now=0.0)
    assert pacer.due(5 * RATE, 0.0) == pytest.approx(5.0 - LEAD_S)


def test_acknowledgements_hold_back_and_let_go() -> None:
    pacer = Pacer(RATE)
    send(pacer, 30, now=0.0)
    pacer.acknowledge(0, 1.0)
    assert pacer.due(5 * RATE, 1.0) == pytest.approx(1.0 + 5.0 - LEAD_S)
    pacer.acknowledge(RATE, 1.5)
    assert pacer.due(5 * RATE, 1.5) == pytest.approx(0.5 + 5.0 - LEAD_S)


def test_nobody_can_have_heard_what_was_not_sent() -> None:
    pacer = Pacer(RATE)
    send(pacer, 3, now=0.0)
    pacer.acknowledge(10**9, 0.05)
    assert pacer.heard(0.05) == 3 * PACKET
    assert pacer.due(4 * PACKET, 0.05) >= 0.05 + PACKET / RATE - LEAD_S - 1e-9


@given(
    st.lists(st.tuples(st.floats(0, 0.3), st.none() | st.integers(0, 10**6)), min_size=1, max_size=60),
    st.sampled_from([16000, 22050]),
)
def test_a_server_that_waits_until_due_is_never_further_ahead(
    steps: list[tuple[float, int | None]], rate: int
) -> None:
    pacer, now, size = Pacer(rate), 50.0, rate // 25
    for k, (pause, ack) in enumerate(steps):
        now = max(now + pause, pacer.due(k * size, now + pause))
        pacer.sent(k * size, (k + 1) * size, now)
        if ack is not None:
            pacer.acknowledge(ack, now)
        heard = pacer.heard(now)
        assert 0 <= heard <= (k + 1) * size
        if ack is None:
            assert k * size - heard <= LEAD_S * rate + 1


def test_a_turn_begins_with_a_little_and_builds_its_lead_up() -> None:
    pacer = Pacer(RATE)
    send(pacer, 1, now=0.0)
    leads = []
    for k in range(1, 100):
        due = max(0.0, pacer.due(k * PACKET, 0.0))
        pacer.sent(k * PACKET, (k + 1) * PACKET, due)
        leads.append(k * PACKET / RATE - due)
    assert max(leads) == pytest.approx(LEAD_S)
    assert sum(pacer.due(k * PACKET, 0.0) <= 0.0 for k in range(100)) == pytest.approx(FIRST_S / 0.04, abs=1)
    assert all(b >= a - 1e-9 for a, b in pairwise(leads))


def test_a_pause_holds_what_is_heard_and_shifts_what_follows() -> None:
    pacer = Pacer(RATE)
    send(pacer, 50, now=0.0)
    pacer.pause(1.0)
    assert pacer.heard(9.0) == RATE
    pacer.go_on(9.0)
    assert pacer.heard(9.5) == RATE + RATE // 2
    assert pacer.due(5 * RATE, 9.0) == pytest.approx(9.0 + 4.0 - LEAD_S)


def test_an_acknowledgement_during_a_pause_moves_where_it_stands() -> None:
    pacer = Pacer(RATE)
    send(pacer, 50, now=0.0)
    pacer.pause(1.0)
    pacer.acknowledge(100, 2.0)
    assert pacer.heard(3.0) == 100
    pacer.go_on(4.0)
    assert pacer.heard(4.0) == 100


def test_what_is_void_cannot_have_been_heard() -> None:
    pacer = Pacer(RATE)
    send(pacer, 50, now=0.0)
    pacer.discard(2 * PACKET)
    assert pacer.heard(60.0) == 2 * PACKET


def test_a_turn_that_follows_another_waits_until_that_is_nearly_heard() -> None:
    first = Pacer(RATE)
    send(first, 100, now=10.0)
    assert first.ends(10.0) == pytest.approx(14.0)
    second = Pacer(RATE, follows=first.ends(10.0))
    assert second.due(0, 10.0) == pytest.approx(14.0 - LEAD_S)
    second.sent(0, PACKET, 12.5)
    assert second.heard(13.9) == 0
    assert second.heard(14.02) == pytest.approx(0.02 * RATE, abs=1)
    assert second.due(RATE, 12.5) == pytest.approx(15.0 - LEAD_S)
