"""Programs kept for the next turn, with programs that are only numbers."""

from __future__ import annotations

import asyncio
import sys

import pytest

from fapstream.adapters.spares import Spares, end_program
from fapstream.errors import VoiceUnavailable


class Program:
    def __init__(self) -> None:
        self.alive = True
        self.closes = 0

    async def aclose(self) -> None:
        self.alive = False
        self.closes += 1


class Maker:
    """Starts programs, unless it is broken."""

    def __init__(self) -> None:
        self.made: list[Program] = []
        self.broken = False

    async def __call__(self) -> Program:
        if self.broken:
            raise VoiceUnavailable("gone")
        self.made.append(Program())
        return self.made[-1]


async def test_a_program_given_back_is_taken_again() -> None:
    start = Maker()
    spares = Spares(start)
    program = await spares.take()
    await spares.give_back(program, reusable=True)
    assert await spares.take() is program
    assert len(start.made) == 1


async def test_warm_starts_one_and_only_one() -> None:
    start = Maker()
    spares = Spares(start)
    await spares.warm()
    await spares.warm()
    assert len(start.made) == 1
    assert await spares.take() is start.made[0]


async def test_a_dead_spare_is_not_handed_out() -> None:
    start = Maker()
    spares = Spares(start)
    await spares.warm()
    start.made[0].alive = False
    assert await spares.take() is start.made[1]
    assert start.made[0].closes == 1


async def test_no_more_than_a_few_are_kept() -> None:
    spares = Spares(Maker(), keep=2)
    programs = [await spares.take() for _ in range(4)]
    for program in programs:
        await spares.give_back(program, reusable=True)
    assert [p.alive for p in programs] == [True, True, False, False]


async def test_a_lost_one_is_replaced_before_anybody_asks() -> None:
    start = Maker()
    spares = Spares(start)
    program = await spares.take()
    await spares.give_back(program, reusable=False)
    await asyncio.sleep(0)
    assert not program.alive
    assert len(start.made) == 2
    assert await spares.take() is start.made[1]


async def test_a_replacement_that_cannot_start_is_told_to_the_next_who_asks() -> None:
    start = Maker()
    spares = Spares(start)
    program = await spares.take()
    start.broken = True
    await spares.give_back(program, reusable=False)
    await asyncio.sleep(0)
    with pytest.raises(VoiceUnavailable):
        await spares.take()


async def test_closing_ends_them_all() -> None:
    start = Maker()
    spares = Spares(start)
    taken = [await spares.take(), await spares.take()]
    await spares.give_back(taken[0], reusable=False)
    await spares.give_back(taken[1], reusable=True)
    await spares.aclose()
    assert not any(p.alive for p in start.made)


@pytest.mark.parametrize("chatter", ["", "print('x' * 1_000_000, flush=True); "])
async def test_a_program_is_ended_whatever_it_still_has_to_say(chatter: str) -> None:
    code = f"{chatter}import time; time.sleep(60)"
    process = await asyncio.create_subprocess_exec(sys.executable, "-c", code, stdout=asyncio.subprocess.PIPE)
    await asyncio.wait_for(end_program(process), 10)
    assert process.returncode is not None
    await end_program(process)
