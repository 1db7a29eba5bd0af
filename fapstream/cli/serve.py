"""Serve the page, the web client, the heads and the websocket on one port."""

from __future__ import annotations

import argparse
import asyncio
import logging
import signal
import sys
from importlib.resources.abc import Traversable

from fapstream.adapters.clock import MonotonicClock
from fapstream.adapters.pool import VoicePool
from fapstream.cli.arguments import port
from fapstream.cli.editor import editor
from fapstream.cli.heads import servable
from fapstream.cli.manner import add_manner, manner
from fapstream.errors import InputError, SynthesisError
from fapstream.server import Adapting, Service, Site, running
from fapstream.tts import LANGUAGES, language

HELP = "serve the page and the talking head"
PORT = 8765


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """--host, --port, --voice, --lang, --head, --verbose, and how turns are read that do not say
    otherwise."""
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
    add_manner(parser)
    parser.add_argument("--verbose", action="store_true", help="log every connection")


def run(args: argparse.Namespace) -> int:
    """Until interrupted."""
    logging.basicConfig(
        level=logging.INFO if args.verbose else logging.WARNING, format="%(asctime)s %(name)s %(message)s"
    )
    asyncio.run(_serve(args, dict(servable(wish) for wish in args.head)))
    return 0


async def _serve(args: argparse.Namespace, heads: dict[str, Traversable]) -> None:
    pool = VoicePool()
    if args.voice:
        pool.find(args.voice, None)
    wished = manner(args, args.lang, complete=False)
    site = Site(heads)
    service = Service(pool, MonotonicClock(), lambda: site.heads, args.lang, args.voice, wished)
    stop = asyncio.Event()
    loop = asyncio.get_running_loop()
    for number in (signal.SIGINT, signal.SIGTERM):
        loop.add_signal_handler(number, stop.set)
    try:
        await _warm(pool, args.voice)
        async with running(service, site, args.host, args.port, Adapting(editor)) as server:
            host, number = server.sockets[0].getsockname()[:2]
            print(f"fapstream speaks at http://{_shown(host)}:{number}/", flush=True)
            await stop.wait()
            print("closing", file=sys.stderr)
    except OSError as e:
        raise InputError(f"cannot listen at {args.host}, port {args.port}: {e.strerror or e}") from e
    finally:
        await pool.aclose()


async def _warm(pool: VoicePool, voice: str | None) -> None:
    """Have the languages ready and the likely voices running before the first request."""
    for lang in LANGUAGES:
        language(lang).warm()
    likely = [pool.find(voice, None)] if voice else []
    for lang in LANGUAGES:
        try:
            likely.append(pool.find(None, lang))
        except SynthesisError as e:
            print(f"fapstream: {e}", file=sys.stderr)
    for candidate in likely:
        await pool.warm(candidate)


def _shown(host: str) -> str:
    if host in ("0.0.0.0", "::"):
        return "localhost"
    return f"[{host}]" if ":" in host else host
