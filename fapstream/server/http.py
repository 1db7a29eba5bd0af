"""The few files the server gives out: the page, the client, the heads. Pure: a path in, a response out.

Nothing but the listed names is ever looked for: no path is joined, and nothing is decoded.
"""

from __future__ import annotations

import gzip
import hashlib
import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib import resources
from importlib.resources.abc import Traversable
from pathlib import Path

from fapstream.errors import InputError

TYPES = {
    ".html": "text/html; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".glb": "model/gltf-binary",
    ".svg": "image/svg+xml",
}

ANYWHERE = ("Access-Control-Allow-Origin", "*")
"""Pages of any origin may read the answer, if only to learn that there is no such head."""

METHODS = ("GET", "HEAD")

ALWAYS = (
    ("X-Content-Type-Options", "nosniff"),
    ("Referrer-Policy", "no-referrer"),
)
"""On every answer whatever."""

NO_PAGE = (*ALWAYS, ("Content-Security-Policy", "default-src 'none'; frame-ancestors 'none'"))
"""What is no page does nothing and is shown nowhere, should somebody open it by itself. Scripts, pictures and
heads that pages elsewhere embed are theirs and heed the pages' own policies."""

PAGE_POLICY = "; ".join(
    [
        "default-src 'none'",
        "script-src 'self'",  # the sound worklet as well
        "worker-src 'self'",
        "style-src 'self'",
        "img-src 'self' blob:",
        "connect-src 'self' blob: ws: wss:",  # a head just made is a blob; older browsers miss sockets
        "form-action 'self'",
        "base-uri 'none'",
        "frame-ancestors 'self'",
    ]
)
DEVICES = ("camera", "geolocation", "payment", "usb", "serial", "midi", "display-capture")

"""What no page of ours needs. The microphone is for `hear`."""

OF_PAGES = (
    *ALWAYS,
    ("Content-Security-Policy", PAGE_POLICY),
    ("Permissions-Policy", ", ".join(["microphone=(self)", *(f"{device}=()" for device in DEVICES)])),
    ("Cross-Origin-Opener-Policy", "same-origin"),
    ("Cross-Origin-Resource-Policy", "same-origin"),
)
OF_THE_REST = (*NO_PAGE, ANYWHERE, ("Cross-Origin-Resource-Policy", "cross-origin"))
"""Pages of any origin may embed the head."""

PAGE = re.compile(r"/([a-z0-9][a-z0-9.-]{0,63})?")
GZIP = re.compile(r"\bgzip\b(?!\s*;\s*q=0(\.0*)?\s*(,|$))")
DEFAULT_HEAD = "default"
HEAD = re.compile(r"/heads/([A-Za-z0-9][A-Za-z0-9_-]{0,63})\.glb")


@dataclass(frozen=True, slots=True)
class File:
    """A file ready to be sent."""

    body: bytes
    packed: bytes
    """The same, gzipped."""
    content_type: str
    etag: str


@dataclass(frozen=True, slots=True)
class Answer:
    """An HTTP response."""

    status: int
    headers: tuple[tuple[str, str], ...]
    body: bytes = b""
    """Not sent in answer to HEAD, but measured."""


def plain(status: int, text: str, *headers: tuple[str, str]) -> Answer:
    """A line of text that nobody stores."""
    form = (("Content-Type", "text/plain; charset=utf-8"), ("Cache-Control", "no-store"))
    return Answer(status, (*form, *NO_PAGE, *headers), text.encode())


class Site:
    """What can be fetched. `heads`: head files by name, put before those in the package.

    The first head is also found as `default`.
    """

    def __init__(self, heads: Mapping[str, Traversable] | None = None) -> None:
        """Raises InputError for a name that no address could have."""
        for name in heads or ():
            if not HEAD.fullmatch(f"/heads/{name}.glb"):
                raise InputError(
                    f"a head cannot be called {name!r}: letters, digits, `-` and `_`, at most 64"
                )
        own = dict(heads or {})
        self._heads = {**own, **{n: f for n, f in packaged_heads().items() if n not in own}}

    @property
    def heads(self) -> tuple[str, ...]:
        """Names of the heads, the default one first."""
        return tuple(self._heads)

    def answer(
        self, path: str, accept_encoding: str = "", if_none_match: str = "", method: str = "GET"
    ) -> Answer:
        """The response to a request for `path` as it came, undecoded; query strings are ignored."""
        if method not in METHODS:
            return plain(405, "Only GET and HEAD\n", ("Allow", ", ".join(METHODS)))
        found = self._find(path.partition("?")[0])
        if found is None:
            return plain(404, "Not found\n", ANYWHERE)
        file = _load(found)
        headers = [
            ("Content-Type", file.content_type),
            ("Cache-Control", "no-cache"),
            ("Vary", "Accept-Encoding"),
            ("ETag", file.etag),
            *(OF_PAGES if file.content_type == TYPES[".html"] else OF_THE_REST),
        ]
        if file.etag in if_none_match:  # one of several perhaps, or weakened by a proxy
            return Answer(304, tuple(headers))
        if GZIP.search(accept_encoding):
            return Answer(200, (*headers, ("Content-Encoding", "gzip")), file.packed)
        return Answer(200, tuple(headers), file.body)

    def _find(self, path: str) -> Traversable | None:
        if match := HEAD.fullmatch(path):
            return self._heads.get(self.heads[0] if match[1] == DEFAULT_HEAD else match[1])
        if match := PAGE.fullmatch(path):
            name = match[1] or "index.html"
            return _pages().get(name) or _pages().get(f"{name}.html")
        return None


def packaged_heads() -> dict[str, Traversable]:
    """The heads that come with the package; `generic` first."""
    folder = resources.files("fapstream").joinpath("assets", "heads")
    found = {f.name[:-4]: f for f in folder.iterdir() if f.name.endswith(".glb")}
    return dict(sorted(found.items(), key=lambda item: (item[0] != "generic", item[0])))


@cache
def _pages() -> dict[str, Traversable]:
    """The built web client by file name. Only what is listed here can be fetched."""
    folder = resources.files("fapstream.server").joinpath("web")
    return {f.name: f for f in folder.iterdir() if f.is_file() and Path(f.name).suffix in TYPES}


_loaded: dict[str, File] = {}


def _load(source: Traversable) -> File:
    """The file, read once."""
    key = str(source)
    if key not in _loaded:
        _loaded[key] = _read(source)
    return _loaded[key]


def _read(source: Traversable) -> File:
    body = source.read_bytes()
    digest = hashlib.sha256(body).hexdigest()[:16]
    kind = TYPES.get(Path(source.name).suffix, "application/octet-stream")
    return File(body, gzip.compress(body, 6, mtime=0), kind, f'"{digest}"')
