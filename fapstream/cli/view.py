"""Show a talking head in a window, or write it as pictures: of a server, or of a FAP file with its sound."""

from __future__ import annotations

import argparse
import asyncio
import json
import re
import sys
from contextlib import ExitStack
from pathlib import Path

from fapstream.cli.arguments import between, rate, unicode_text
from fapstream.cli.heads import opened
from fapstream.cli.progress import Progress
from fapstream.errors import InputError
from fapstream.head.mesh import Head
from fapstream.tts import LANGUAGES
from fapstream.viewer.canvas import Studio
from fapstream.viewer.clip import Clip, read_clip
from fapstream.viewer.face import FaceMixer
from fapstream.viewer.film import PICTURE, film
from fapstream.viewer.live import Wish, collect, perform
from fapstream.viewer.renderer import Renderer
from fapstream.viewer.show import Show, run_show
from fapstream.viewer.sound import open_device
from fapstream.viewer.window import Window

HELP = "show a talking head in a window, or write it as pictures"
URL = "ws://127.0.0.1:8765/ws"
MOST_PIXELS = 8192
EXAMPLES = f"""examples:
  fapstream view --say "Hello."                        a window on the server at {URL}
  fapstream view --fap a.fap --wav a.wav --head generic
  fapstream view --fap a.fap --wav a.wav --headless --frames out --size 720x720
  ffmpeg -framerate 25 -i out/%05d.png -i out/audio.wav -pix_fmt yuv420p talk.mp4

In the window: drag to look from the side, wheel to come closer, R to go back, Escape to leave."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """[URL], --say, --fap, --wav, --head, --size, --headless, --frames, --fps and so on."""
    parser.epilog = EXAMPLES
    parser.add_argument("url", nargs="?", metavar="ws://HOST:PORT/ws", help=f"the server (default {URL})")
    parser.add_argument(
        "--say",
        type=unicode_text,
        metavar="TEXT",
        help="what the server is to say; `-` reads it from stdin as it arrives",
    )
    parser.add_argument(
        "--listen", metavar="CHANNEL", help="show what is spoken into a channel of the server"
    )
    parser.add_argument("--token", help="what allows it, where the server asks for that")
    parser.add_argument("--lang", choices=LANGUAGES, help="language of what is said")
    parser.add_argument("--voice", help="voice, see `fapstream voices`")
    parser.add_argument("--rate", type=rate, default=1.0, help="speaking rate, 1 is normal")
    parser.add_argument("--fap", type=Path, metavar="F", help="play this FAP file instead of asking a server")
    parser.add_argument("--wav", type=Path, metavar="F", help="the sound that goes with it")
    parser.add_argument(
        "--head",
        metavar="HEAD",
        default="generic",
        help="name of a head in the package, or a GLB or VRM file (default: generic)",
    )
    parser.add_argument("--size", type=size, metavar="WxH", help="pixels of the picture (default 512x512)")
    parser.add_argument("--fullscreen", action="store_true", help="fill the screen")
    parser.add_argument("--no-idle", action="store_true", help="no blinks and glances while nothing is said")
    parser.add_argument("--seed", type=int, default=0, help="seed of blinks and glances")
    parser.add_argument(
        "--trace", type=Path, metavar="F", help="write as JSON lines when pictures were shown"
    )
    parser.add_argument(
        "--headless", action="store_true", help="no window: write every picture to --frames, then exit"
    )
    parser.add_argument("--frames", type=Path, metavar="DIR", help="where pictures and audio.wav go")
    parser.add_argument(
        "--fps", type=between(1, 240), default=25.0, help="pictures a second to write (default 25)"
    )


def size(text: str) -> tuple[int, int]:
    """(width, height) from `WxH`. Raises ArgumentTypeError."""
    match = re.fullmatch(r"(\d{1,5})x(\d{1,5})", text)
    width, height = (int(match[1]), int(match[2])) if match else (0, 0)
    if not (16 <= width <= MOST_PIXELS and 16 <= height <= MOST_PIXELS):
        raise argparse.ArgumentTypeError(f"{text!r} is no size such as 512x512, 16 to {MOST_PIXELS} a side")
    return width, height


def run(args: argparse.Namespace) -> int:
    """Until the window is closed, the file has been played, or all pictures are written."""
    _check(args)
    head = opened(args.head)
    if args.headless:
        _write(args, head)
    else:
        asyncio.run(_show(args, head))
    return 0


def _check(args: argparse.Namespace) -> None:
    """Raises InputError for options that do not go together."""
    if args.wav and not args.fap:
        raise InputError("--wav is the sound of a FAP file; which? (--fap F)")
    if args.fap and (args.url or args.say is not None):
        raise InputError("show a server or a file (--fap), not both")
    if args.listen is not None and (args.fap or args.headless or args.say is not None):
        raise InputError("--listen shows what others say, in a window")
    if args.headless != (args.frames is not None):
        raise InputError("--headless and --frames DIR go together")
    if args.headless and not args.fap and args.say is None:
        raise InputError("what is to be seen? --fap F, or --say TEXT")
    if args.headless and (args.trace or args.fullscreen):
        raise InputError("--trace and --fullscreen are for a window; --headless has none")


def _write(args: argparse.Namespace, head: Head) -> None:
    clip = _clip(args) if args.fap else asyncio.run(collect(_wish(args)))
    studio = Studio(head, args.size or (512, 512))
    try:
        count = film(clip, studio, args.frames, args.fps, Progress("pictures"))
    finally:
        studio.close()
    print(f"{count} pictures and audio.wav in {args.frames}")
    if (args.frames / PICTURE.format(count)).exists():
        _warn(f"{args.frames} still has pictures of a longer talk, from {PICTURE.format(count)} on")


def _clip(args: argparse.Namespace) -> Clip:
    clip = read_clip(args.fap, args.wav)
    for note in clip.notes:
        _warn(f"{args.fap}: {note}")
    return clip


async def _show(args: argparse.Namespace, head: Head) -> None:
    with ExitStack() as stack:
        window = Window(f"fapstream: {head.name}", None if args.fullscreen else args.size or (512, 512))
        stack.callback(window.close)
        renderer = Renderer(window.context, head, window.software)
        mixer = FaceMixer(None if args.no_idle else args.seed)
        show = Show(window, renderer, mixer, open_device(_warn, window.software))
        stack.callback(show.close)
        if args.trace:
            file = stack.enter_context(args.trace.open("w", encoding="utf-8"))
            show.told = lambda shown: print(json.dumps(shown.as_dict()), file=file)
        await run_show(show, _script(args, show))


async def _script(args: argparse.Namespace, show: Show) -> None:
    if args.fap:
        clip = _clip(args)
        show.begin(1, clip.sample_rate)
        show.push(clip.packet(1))
        show.end(1)
    else:
        await perform(_wish(args), show)


def _wish(args: argparse.Namespace) -> Wish:
    return Wish(args.url or URL, args.say, args.lang, args.voice, args.rate, args.token, args.listen)


def _warn(text: str) -> None:
    print(f"fapstream: {text}", file=sys.stderr)
