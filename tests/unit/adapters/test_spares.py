"""Programs kept for the next turn, with programs that are only numbers."""

from __future__ import annotations

import asyncio
import errno
import os
import random
import sys
import threading

import pytest

from fapstream.adapters.spares import Budget, Limits, Spares, end_program, watch_by_descriptor
from fapstream.errors import VoiceOverloaded, VoiceUnavailable
from tests.unit.fakes import in_virtual_time


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
    await asyncio.sleep(0)
    assert start.made[0].closes == 1


async def test_no_more_than_a_few_are_kept() -> None:
    spares = Spares(Maker(), Limits(keep=2))
    programs = [await spares.take() for _ in range(4)]
    for program in programs:
        await spares.give_back(program, reusable=True)
    await asyncio.sleep(0)
    assert [p.alive for p in programs] == [False, False, True, True], "the ones used last"
    await spares.aclose()


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


async def some_steps(n: int = 5) -> None:
    for _ in range(n):
        await asyncio.sleep(0)


async def test_who_waits_is_served_in_order_of_asking() -> None:
    """Of all kinds: an idle program of another kind makes room for whoever is first."""
    events: list[str] = []
    budget = Budget(most=2, on_event=events.append)
    first, second = Maker(), Maker()
    one, two = Spares(first, budget=budget), Spares(second, budget=budget)
    held = [await one.take(), await one.take()]
    served: list[int] = []

    async def ask(k: int, spares: Spares[Program]) -> None:
        held.append(await spares.take())
        served.append(k)

    asking = [asyncio.create_task(ask(k, (one, two)[k % 2])) for k in range(4)]
    await some_steps()
    assert served == []
    assert events == ["start", "start"] + ["wait"] * 4
    for k in range(4):
        await (one if held[0] in first.made else two).give_back(held.pop(0), reusable=True)
        await some_steps(20)
        assert served == list(range(k + 1))
    await asyncio.gather(*asking)
    assert budget.running == 2
    assert sum(p.alive for p in first.made + second.made) == 2
    for program in held:
        await (one if program in first.made else two).give_back(program, reusable=False)
    await one.aclose()
    await two.aclose()
    assert not any(p.alive for p in first.made + second.made)


async def test_a_kind_at_its_own_limit_holds_nobody_else_up() -> None:
    budget = Budget(most=10)
    one, two = Spares(Maker(), Limits(most=1), budget), Spares(Maker(), budget=budget)
    held = await one.take()
    waiting = asyncio.create_task(one.take())
    await some_steps()
    assert (await asyncio.wait_for(two.take(), 1)).alive
    assert not waiting.done()
    await one.give_back(held, reusable=True)
    assert await waiting is held


@pytest.mark.parametrize("seed", range(30))
async def test_whoever_is_cancelled_loses_no_program(seed: int) -> None:
    """At any moment, also just when a program was granted."""
    rng = random.Random(seed)
    budget = Budget(most=3, at_once=2)

    class Slow(Maker):
        async def __call__(self) -> Program:
            await some_steps(rng.randrange(3))
            return await super().__call__()

    kinds = [Spares(Slow(), Limits(most=2), budget), Spares(Slow(), budget=budget)]

    async def use(spares: Spares[Program]) -> None:
        program = await spares.take()
        try:
            await some_steps(rng.randrange(4))
        finally:
            await spares.give_back(program, reusable=rng.random() < 0.7)

    tasks = [asyncio.create_task(use(rng.choice(kinds))) for _ in range(40)]
    while not all(task.done() for task in tasks):
        rng.choice(tasks).cancel()
        await some_steps(rng.randrange(3))
    await asyncio.gather(*tasks, return_exceptions=True)
    taken = [await asyncio.wait_for(kinds[1].take(), 1) for _ in range(3)]
    assert budget.running == 3, "none is lost: all can be had again"
    for program in taken:
        await kinds[1].give_back(program, reusable=False)
    for spares in kinds:
        await spares.aclose()
    assert (budget.running, budget.starting) == (0, 0)


async def test_few_are_started_at_once() -> None:
    starting: list[asyncio.Future[Program]] = []

    async def start() -> Program:
        starting.append(asyncio.get_running_loop().create_future())
        return await starting[-1]

    spares = Spares(start, budget=Budget(at_once=2))
    tasks = [asyncio.create_task(spares.take()) for _ in range(5)]
    for k in range(5):
        await some_steps()
        assert len(starting) == min(5, k + 2)
        starting[k].set_result(Program())
    assert len({id(p) for p in await asyncio.gather(*tasks)}) == 5


@pytest.mark.parametrize("error", [OSError(errno.ENOMEM, "no memory"), OSError(errno.EMFILE, "no files")])
async def test_a_start_that_is_refused_is_typed_and_leaves_no_trace(error: OSError) -> None:
    broken, events = True, list[str]()

    async def start() -> Program:
        if broken:
            raise error
        return Program()

    budget = Budget(most=1, on_event=events.append)
    spares = Spares(start, budget=budget)
    for _ in range(5):
        with pytest.raises(VoiceOverloaded, match=error.strerror):
            await asyncio.wait_for(spares.take(), 1)
    broken = False
    assert (await asyncio.wait_for(spares.take(), 1)).alive
    assert events == ["refused"] * 5 + ["start"]
    assert (budget.running, budget.starting) == (1, 0)


async def test_a_refused_start_is_told_to_him_alone() -> None:
    """Who waits behind is given the next chance."""
    left = [OSError(errno.EAGAIN, "busy")]

    async def start() -> Program:
        await asyncio.sleep(0)
        if left:
            raise left.pop()
        return Program()

    spares = Spares(start, budget=Budget(most=1))
    first, second = asyncio.create_task(spares.take()), asyncio.create_task(spares.take())
    got = await asyncio.wait_for(asyncio.gather(first, second, return_exceptions=True), 1)
    assert isinstance(got[0], VoiceOverloaded)
    assert isinstance(got[1], Program)


async def test_one_that_died_is_replaced_in_its_place() -> None:
    start, budget = Maker(), Budget(most=1)
    spares = Spares(start, budget=budget)
    program = await spares.take()
    program.alive = False
    fresh = await asyncio.wait_for(spares.replaced(program), 1)
    assert fresh is start.made[1]
    assert program.closes == 1
    assert budget.running == 1
    fresh.alive = False
    start.broken = True
    with pytest.raises(VoiceUnavailable):
        await spares.replaced(fresh)
    assert (budget.running, budget.starting) == (0, 0)


@in_virtual_time
async def test_what_nobody_wants_for_a_minute_is_ended_but_for_one() -> None:
    start = Maker()
    spares = Spares(start, Limits(idle_s=60))
    programs = [await spares.take() for _ in range(6)]
    for program in programs:
        await spares.give_back(program, reusable=True)
    await asyncio.sleep(50)
    used = await spares.take()
    await asyncio.sleep(5)
    await spares.give_back(used, reusable=True)
    assert sum(p.alive for p in programs) == 6
    await asyncio.sleep(6)
    assert [p for p in programs if p.alive] == [used]
    await asyncio.sleep(1000)
    assert used.alive
    await spares.aclose()
    assert not used.alive


async def test_after_closing_nothing_is_kept() -> None:
    start = Maker()
    spares = Spares(start)
    program = await spares.take()
    await spares.aclose()
    await spares.give_back(program, reusable=True)
    assert not program.alive
    assert len(start.made) == 1


async def test_no_descriptor_thread_or_child_is_left() -> None:
    """Programs that are ended, die, or cannot be started."""

    async def start() -> Real:
        pipe = asyncio.subprocess.PIPE
        return Real(await asyncio.create_subprocess_exec("cat", stdin=pipe, stdout=pipe))

    class Real:
        def __init__(self, process: asyncio.subprocess.Process) -> None:
            self.process = process

        @property
        def alive(self) -> bool:
            return self.process.returncode is None

        async def aclose(self) -> None:
            await end_program(self.process)

    before = None
    for round_ in range(3):
        spares = Spares(start)
        programs = await asyncio.gather(*(spares.take() for _ in range(8)))
        for k, program in enumerate(programs):
            if k % 3 == 0:
                program.process.kill()
            await spares.give_back(program, reusable=k % 2 == 0)
        await spares.aclose()
        assert not any(p.alive for p in programs)
        with pytest.raises(ChildProcessError):
            os.waitpid(-1, os.WNOHANG)
        await asyncio.sleep(0.01)
        open_now = len(os.listdir("/proc/self/fd")) if os.path.isdir("/proc/self/fd") else 0
        before = open_now if round_ == 0 else before
        assert open_now == before


async def test_the_loop_itself_can_watch_for_ends() -> None:
    """No thread for each program."""
    policy = asyncio.get_event_loop_policy()
    usual = policy.get_child_watcher() if sys.version_info < (3, 12) else None
    try:
        watch_by_descriptor()
        threads = threading.active_count()
        process = await asyncio.create_subprocess_exec("cat", stdin=-1, stdout=-1)
        if hasattr(os, "pidfd_open"):
            assert threading.active_count() == threads
        await asyncio.wait_for(end_program(process), 5)
        assert process.returncode == -9
    finally:
        if usual is not None:
            policy.set_child_watcher(usual)
