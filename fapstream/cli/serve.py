"""Serve the page, the web client, the heads and the websocket on one port.

On this machine alone nobody needs a token. To be reached from elsewhere, give secrets that sign tokens (see
`fapstream token`), or say --open.
"""

from __future__ import annotations

import argparse
import asyncio
import ipaddress
import os
import re
import shutil
import socket
import sys
import tempfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

from fapstream.adapters.metrics import fresh, worker_gone
from fapstream.adapters.pool import VoicePool
from fapstream.cli.arguments import between, port
from fapstream.cli.heads import servable
from fapstream.cli.logs import add_log_arguments, start_log
from fapstream.cli.manner import add_manner, manner
from fapstream.cli.motion import add_motion, motion
from fapstream.cli.serving import HUB_SOCKET, Plan, cores, raise_file_limit, run_hub, warm_languages, work
from fapstream.cli.workers import Lifeline, Supervisor, Work
from fapstream.errors import InputError
from fapstream.server.admission import Limits, networks
from fapstream.server.origins import Doors, listed
from fapstream.server.tokens import SECRET_VARIABLE, read_secrets
from fapstream.tts import LANGUAGES

HELP = "serve the page and the talking head"
PORT = 8765
MOST_WORKERS = 64
CHANNEL = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{0,62}")
LIMITS = Limits()


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Where to listen, who may come, how many, how turns are read that do not say otherwise, and the log."""
    parser.add_argument(
        "--host", default="127.0.0.1", help="address to listen on (default: this machine only)"
    )
    parser.add_argument("--port", type=port, default=PORT, help=f"port (default {PORT}; 0 takes a free one)")
    parser.add_argument("--voice", help="voice for turns that ask for none")
    parser.add_argument(
        "--lang", choices=LANGUAGES, default=LANGUAGES[0], help="language for turns that name none"
    )
    parser.add_argument(
        "--head", action="append", default=[], metavar="NAME|F.glb|F.vrm",
        help="head that pages show unless they ask for another; more can be given and asked for by name",
    )  # fmt: skip
    parser.add_argument(
        "--channel", type=channel, action="append", default=[], metavar="NAME",
        help="a channel that one may speak into and many listen to; can be given again",
    )  # fmt: skip
    _add_scale(parser)
    _add_doors(parser)
    add_manner(parser)
    add_motion(parser)
    add_log_arguments(parser)
    parser.add_argument("--verbose", action="store_true", help="log every connection (--log-level info)")


def _add_scale(parser: argparse.ArgumentParser) -> None:
    group = parser.add_argument_group("how much")
    group.add_argument(
        "--workers", type=workers, default=1, metavar="N|auto",
        help="processes that share the port (default 1; auto: as many as there are processors)",
    )  # fmt: skip
    group.add_argument(
        "--bus", metavar="URL",
        help="a broker that carries channels between machines, redis://HOST:PORT (default: within this one)",
    )  # fmt: skip
    for name, default, what in (
        ("sessions", LIMITS.sessions, "sessions that may speak"),
        ("sessions-per-address", LIMITS.sessions_per_address, "the same from one address"),
        ("listeners", LIMITS.listeners, "listeners"),
        ("listeners-per-address", LIMITS.listeners_per_address, "the same from one address"),
    ):
        group.add_argument(
            f"--max-{name}", type=between(0, 1e6), default=default, metavar="N",
            help=f"most {what}, of each worker (default {default})",
        )  # fmt: skip
    group.add_argument(
        "--drain", type=between(0, 3600), default=10.0, metavar="S",
        help="seconds that those who speak are given when the server is asked to stop (default 10)",
    )  # fmt: skip


def _add_doors(parser: argparse.ArgumentParser) -> None:
    group = parser.add_argument_group("who may come")
    group.add_argument(
        "--secret-file", type=Path, metavar="F",
        help=f"secrets that sign tokens, one a line; the first signs (default: ${SECRET_VARIABLE})",
    )  # fmt: skip
    group.add_argument(
        "--open",
        action="store_true",
        help="listen on other addresses than loopback without asking for tokens",
    )
    group.add_argument(
        "--origin", action="append", default=[], metavar="URL",
        help="pages from there may connect, https://example.org; `*` is everybody; can be given again",
    )  # fmt: skip
    group.add_argument("--tls-cert", type=Path, metavar="F", help="certificate chain for https and wss")
    group.add_argument("--tls-key", type=Path, metavar="F", help="its key")
    group.add_argument(
        "--trust-proxy", action="append", default=[], metavar="ADDRESS",
        help="proxy whose X-Forwarded-For is believed, an address or a network; can be given again",
    )  # fmt: skip


def channel(text: str) -> str:
    """A name that a channel may have. Raises ArgumentTypeError."""
    if not CHANNEL.fullmatch(text) or text.startswith("talk-"):
        raise argparse.ArgumentTypeError(f"{text!r} is no name: letters, digits, `._-`, not `talk-...`")
    return text


def workers(text: str) -> int:
    """A number of processes. Raises ArgumentTypeError."""
    if text == "auto":
        return cores()
    if not (text.isdecimal() and 1 <= int(text) <= MOST_WORKERS):
        raise argparse.ArgumentTypeError(f"{text!r} is neither a number from 1 to {MOST_WORKERS} nor `auto`")
    return int(text)


def run(args: argparse.Namespace) -> int:
    """Until interrupted."""
    plan = _plan(args)
    level = args.log_level or ("info" if args.verbose else "warning")
    start_log(args.log_format, args.log_file, level, [s.decode("utf-8", "replace") for s in plan.secrets])
    raise_file_limit()
    if args.voice:
        VoicePool().find(args.voice, None)
    warm_languages()
    scheme = "https" if plan.tls else "http"

    def ready(host: str, number: int) -> None:
        print(f"fapstream speaks at {scheme}://{_shown(host)}:{number}/", flush=True)

    if plan.workers == 1:
        asyncio.run(work(plan, 0, ready))
        print("closing", file=sys.stderr)
        return 0
    return _run_many(plan, ready)


def _plan(args: argparse.Namespace) -> Plan:
    """What the options ask for. Raises InputError, DataError, OSError."""
    secrets = read_secrets(args.secret_file, os.environ)
    loopback = _loopback(args.host)
    if not (loopback or secrets or args.open):
        raise InputError(
            f"listening at {args.host} lets others come in: give --secret-file "
            "(`fapstream token --new-secret`), or --open to let everybody in"
        )
    if (args.tls_cert is None) != (args.tls_key is None):
        raise InputError("--tls-cert and --tls-key belong together")
    limits = Limits(
        sessions=int(args.max_sessions),
        sessions_per_address=int(args.max_sessions_per_address),
        listeners=int(args.max_listeners),
        listeners_per_address=int(args.max_listeners_per_address),
    )
    return Plan(
        host=args.host, port=args.port, heads=dict(servable(wish) for wish in args.head), lang=args.lang,
        voice=args.voice, manner=manner(args, args.lang, complete=False), motion=motion(args), limits=limits,
        doors=Doors(listed(args.origin), loopback, bool(secrets)), proxies=networks(args.trust_proxy),
        secrets=secrets, channels=tuple(args.channel), bus=args.bus,
        tls=(args.tls_cert, args.tls_key) if args.tls_cert else None, drain_s=args.drain,
        workers=args.workers,
    )  # fmt: skip


def _loopback(host: str) -> bool:
    """Whether nobody but this machine can reach an address."""
    try:
        return ipaddress.ip_address(host.strip("[]")).is_loopback
    except ValueError:
        return host == "localhost"


def _run_many(plan: Plan, ready: Callable[[str, int], None]) -> int:
    """Several processes on one port. Raises InputError, OSError."""
    if not hasattr(os, "fork"):
        raise InputError("several workers need a system that can fork; use --workers 1")
    folder = Path(tempfile.mkdtemp(prefix="fapstream-"))
    held = _reserve(plan)
    host, number = held.getsockname()[:2]
    plan = replace(plan, port=number, folder=folder)
    fresh(folder / "metrics")

    def worker(index: int, line: Lifeline) -> None:
        asyncio.run(work(plan, index, lambda host, number: line.ready(), line.parent))

    helpers: list[Work] = []
    if plan.bus is None:
        helpers.append(lambda index, line: run_hub(folder / HUB_SOCKET, line.ready, line.parent))
    supervisor = Supervisor(
        [worker] * plan.workers,
        helpers,
        lambda: ready(host, number),
        lambda index: worker_gone(folder / "metrics", index),
        plan.drain_s,
    )
    try:
        return supervisor.run()
    finally:
        print("closing", file=sys.stderr)
        held.close()
        shutil.rmtree(folder, ignore_errors=True)


def _reserve(plan: Plan) -> socket.socket:
    """Hold the port, so that all workers get the same one and nobody else does. Raises InputError."""
    try:
        found = socket.getaddrinfo(plan.host, plan.port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE)
        family, kind, protocol, _, address = found[0]
        held = socket.socket(family, kind, protocol)
        held.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        if plan.port:
            _refuse_taken(family, address)
        held.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEPORT, 1)
        held.bind(address)
    except OSError as e:
        raise InputError(f"cannot listen at {plan.host}, port {plan.port}: {e.strerror or e}") from e
    return held


def _refuse_taken(family: int, address: Any) -> None:
    """Another server of ours would share its port: better to be told. Raises OSError."""
    with socket.socket(family, socket.SOCK_STREAM) as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        probe.bind(address)


def _shown(host: str) -> str:
    if host in ("0.0.0.0", "::"):
        return "localhost"
    return f"[{host}]" if ":" in host else host
