"""Connected or not."""

from __future__ import annotations

import asyncio
import logging
from itertools import islice

import pytest

from fapstream.adapters.bus.state import FIRST_WAIT_S, LONGEST_WAIT_S, State, waits


def test_waits_grow_up_to_a_limit() -> None:
    for number, wait in enumerate(islice(waits(), 20)):
        most = min(FIRST_WAIT_S * 2**number, LONGEST_WAIT_S)
        assert most / 2 <= wait <= most


async def test_changes_are_told_and_nothing_else() -> None:
    state = State("here")
    told: list[bool] = []
    state.watch(told.append)
    for change in (state.up, state.up, lambda: state.down("x"), lambda: state.down("y"), state.up):
        change()
    assert state.connected
    await asyncio.sleep(0)
    assert told == [True, False, True]


async def test_who_fails_to_listen_harms_nobody() -> None:
    said: list[str] = []
    asyncio.get_running_loop().set_exception_handler(lambda _, context: said.append(context["message"]))
    state = State("here")
    told: list[bool] = []
    state.watch(lambda connected: told.append(bool(1 // 0)))
    state.watch(told.append)
    state.up()
    await asyncio.sleep(0)
    assert told == [True]
    assert len(said) == 1


async def test_the_log_tells_of_an_outage_once(caplog: pytest.LogCaptureFixture) -> None:
    state = State("here")
    with caplog.at_level(logging.WARNING):
        for _ in range(3):
            state.down("refused")
        state.up()
        state.down("lost")
    assert [record.getMessage().split(": ")[1] for record in caplog.records] == ["refused", "lost"]
