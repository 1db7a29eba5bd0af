"""One process of a server: what `fapstream serve` asked for, put together and run."""

from __future__ import annotations

import asyncio
import gc
import logging
import os
import random
import signal
import ssl
import sys
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from functools import partial
from importlib.resources.abc import Traversable
from pathlib import Path

from websockets.datastructures import Headers

from fapstream.adapters.bus import Hub, HubBus, open_bus
from fapstream.adapters.clock import MonotonicClock
from fapstream.adapters.metrics import Metrics
from fapstream.adapters.pool import VoicePool
from fapstream.adapters.spares import watch_by_descriptor
from fapstream.cli.editor import EditorProcess
from fapstream.errors import InputError, NotAuthorised, SynthesisError
from fapstream.motion import Motion
from fapstream.ports import Bus, Meter
from fapstream.server import Adapting, Address, App, Lobby, Service, Site, running
from fapstream.server.admission import Admission, Limits, Network
from fapstream.server.gate import Gate
from fapstream.server.handover import hand_over, socket_of
from fapstream.server.http import Answer, plain
from fapstream.server.link import Link
from fapstream.server.origins import Doors
from fapstream.tts import LANGUAGES, Manner, language

log = logging.getLogger("fapstream.server")

LAG_S = 0.25
"""So often it is looked how late the event loop is."""

HUB_SOCKET = "hub.sock"


@dataclass(frozen=True, slots=True)
class Plan:
    """What all workers of a server have in common."""

    host: str
    port: int
    heads: Mapping[str, Traversable]
    lang: str
    voice: str | None
    manner: Manner
    motion: Motion = field(default_factory=Motion)
    limits: Limits = field(default_factory=Limits)
    doors: Doors = field(default_factory=Doors)
    proxies: tuple[Network, ...] = ()
    secrets: tuple[bytes, ...] = ()
    channels: tuple[str, ...] = ()
    bus: str | None = None
    tls: tuple[Path, Path] | None = None
    """Certificate and key."""
    drain_s: float = 10.0
    workers: int = 1
    folder: Path | None = None
    """Where the workers of this machine meet; None if there is one."""


def warm_languages() -> None:
    """Have what all workers share in memory before they are made."""
    for lang in LANGUAGES:
        language(lang).warm()


async def work(plan: Plan, index: int, ready: Callable[[str, int], None], parent: int | None = None) -> None:
    """Serve until asked to stop, or until the parent is gone. `ready` is told host and port.

    Raises InputError.
    """
    stop = asyncio.Event()
    loop = asyncio.get_running_loop()
    loop.add_signal_handler(signal.SIGTERM, stop.set)
    if parent is None:
        loop.add_signal_handler(signal.SIGINT, stop.set)
    else:
        loop.add_reader(parent, stop.set)
    meter = Metrics(plan.folder / "metrics" if plan.folder else None, index)
    watch_by_descriptor()
    pool = VoicePool(on_event=partial(_count_voice, meter))
    bus = HubBus(str(plan.folder / HUB_SOCKET)) if plan.folder and plan.bus is None else open_bus(plan.bus)
    bus.on_state(
        lambda there: (
            log.info("the bus is there")
            if there
            else log.warning("the bus is away: listeners elsewhere hear nothing until it is back")
        )
    )
    lag = asyncio.create_task(_watch_lag(meter))
    try:
        app = _app(plan, index, pool, bus, meter)
        async with running(app, _address(plan, index), plan.drain_s) as server:
            await _warm(pool, plan.voice, index == 0)
            gc.collect()
            gc.freeze()  # what is there for good need not be looked through again and again
            app.warm = True
            host, port = server.sockets[0].getsockname()[:2]
            ready(host, port)
            await stop.wait()
            loop.remove_signal_handler(signal.SIGTERM)  # asked twice: at once
            loop.remove_signal_handler(signal.SIGINT)
    except OSError as e:
        raise InputError(f"cannot listen at {plan.host}, port {plan.port}: {e.strerror or e}") from e
    finally:
        lag.cancel()
        await pool.aclose()
        await bus.aclose()


def _app(plan: Plan, index: int, pool: VoicePool, bus: Bus, meter: Metrics) -> App:
    site = Site(plan.heads)
    clock = MonotonicClock()
    admission = Admission(plan.limits, random.Random())
    service = Service(
        pool,
        clock,
        lambda: site.heads,
        plan.lang,
        plan.voice,
        plan.manner,
        plan.motion,
        meter,
        admission.load.sent,
    )
    gate = Gate(admission, clock, plan.secrets)
    lobby = Lobby(service, bus, plan.channels, index, gate.listen_token)
    app = App(service, site, lobby, gate, Adapting(EditorProcess, gate), plan.doors, plan.proxies)
    app.metrics = partial(_metrics, gate, meter)
    app.warm = False
    if plan.folder:
        app.hand_over = partial(_hand_over, plan.folder)
    return app


def _address(plan: Plan, index: int) -> Address:
    tls = tls_context(*plan.tls) if plan.tls else None
    private = socket_of(plan.folder, index) if plan.folder else None
    if private:
        private.unlink(missing_ok=True)
    return Address(plan.host, plan.port, tls, plan.workers > 1, private)


def tls_context(certificate: Path, key: Path) -> ssl.SSLContext:
    """For https and wss. Raises InputError."""
    context = ssl.create_default_context(ssl.Purpose.CLIENT_AUTH)
    try:
        context.load_cert_chain(certificate, key)
    except (OSError, ssl.SSLError) as e:
        reason = getattr(e, "strerror", None) or e
        raise InputError(f"{certificate} and {key} are no certificate and its key: {reason}") from None
    return context


async def _hand_over(folder: Path, link: Link, first: bytes, index: int, address: str) -> bool:
    return await hand_over(link, first, socket_of(folder, index), address)


def _metrics(gate: Gate, meter: Metrics, address: str, headers: Headers) -> Answer:
    """Figures for Prometheus. Where tokens are asked for, it shows one."""
    scheme, _, token = headers.get("Authorization", "").partition(" ")
    try:
        gate.grant(token if scheme.lower() == "bearer" else None).require("metrics")
    except NotAuthorised as e:
        return plain(401, f"{e}\n", ("WWW-Authenticate", "Bearer"))
    body, kind = meter.exposition()
    return Answer(200, (("Content-Type", kind), ("Cache-Control", "no-store")), body)


def _count_voice(meter: Meter, event: str) -> None:
    if event == "restart":
        meter.count("voice_restarts")
    elif event == "hang":
        meter.count("voice_hangs")


async def _watch_lag(meter: Meter) -> None:
    while True:
        due = time.monotonic() + LAG_S
        await asyncio.sleep(LAG_S)
        meter.time("loop_lag", max(0.0, time.monotonic() - due))


async def _warm(pool: VoicePool, voice: str | None, complain: bool) -> None:
    """Have the likely voices running before the first request."""
    likely = [pool.find(voice, None)] if voice else []
    for lang in LANGUAGES:
        try:
            likely.append(pool.find(None, lang))
        except SynthesisError as e:
            if complain:
                print(f"fapstream: {e}", file=sys.stderr)
    for candidate in likely:
        await pool.warm(candidate)


def run_hub(path: Path, ready: Callable[[], None], parent: int) -> None:
    """Be the hub between the workers of this machine until told to stop, or until the parent is gone."""

    async def run() -> None:
        stop = asyncio.Event()
        loop = asyncio.get_running_loop()
        loop.add_signal_handler(signal.SIGTERM, stop.set)
        loop.add_reader(parent, stop.set)
        path.unlink(missing_ok=True)
        hub = Hub(str(path))
        await hub.start()
        ready()
        await stop.wait()
        await hub.aclose()

    asyncio.run(run())


def raise_file_limit() -> None:
    """Every client is an open file: allow as many as the system lets us."""
    with suppress(ImportError, ValueError, OSError):
        import resource

        _, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
        resource.setrlimit(resource.RLIMIT_NOFILE, (hard, hard))


def cores() -> int:
    """Processors that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
