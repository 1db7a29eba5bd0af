"""protocol/SPEC.md section 3: at most 1.5 s ahead of what is heard. Time is an argument."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fapstream.stream.pacer import LEAD_S, Pacer

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
    assert pacer.due(RATE, 100.0) == pytest.approx(100.0 + 1.0 - LEAD_S)
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
    assert pacer.due(2 * RATE, 1.0) == pytest.approx(1.0 + 2.0 - LEAD_S)
    pacer.acknowledge(RATE, 1.5)
    assert pacer.due(2 * RATE, 1.5) == pytest.approx(0.5 + 2.0 - LEAD_S)


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
