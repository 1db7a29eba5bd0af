"""Which pages may talk to the server. Browsers say where a page came from (Origin), and whom it asked (Host).

A page from elsewhere could use a visitor's browser to reach a server that only the visitor can reach; and by
DNS rebinding it could make its own name mean that server, so that it looks like a page of ours. Programs send
no Origin and are let through: what keeps them out is a token.
"""

from __future__ import annotations

import ipaddress
import re
from collections.abc import Iterable
from dataclasses import dataclass

from fapstream.errors import InputError

ORIGIN = re.compile(r"([a-z][a-z0-9+.-]*)://(\[[0-9a-f:.]+\]|[a-z0-9_.-]+)(?::([0-9]{1,5}))?")
HOST = re.compile(r"(\[[0-9a-f:.]+\]|[a-z0-9_.-]+)(?::([0-9]{1,5}))?")
PORTS = {"http": "80", "https": "443"}


@dataclass(frozen=True, slots=True)
class Doors:
    """Whom a server expects."""

    origins: frozenset[str] = frozenset()
    """Normalised by `listed`; `*`: everybody."""
    loopback: bool = True
    """It listens on loopback addresses only."""
    tokens: bool = False
    """Nobody does anything without a token."""


def listed(origins: Iterable[str]) -> frozenset[str]:
    """Origins as browsers write them. Raises InputError for what is none."""
    return frozenset(origin if origin in ("*", "null") else _normal(origin) for origin in origins)


def refusal(origin: str | None, host: str | None, doors: Doors) -> str | None:
    """Why a request with these headers is refused; None: it is not. For HTTP, `origin` is None."""
    if "*" in doors.origins:
        return None
    if not (host is None or _ours(host, doors)):
        return f"this server does not go by the name {host[:80]!r}; --origin tells it to"
    if origin is None or origin.lower() in doors.origins or _from_here(origin, host, doors):
        return None
    return f"pages from {origin[:80]!r} may not use this server; --origin lets them"


def _ours(host: str, doors: Doors) -> bool:
    """Whether a name cannot have been made to mean this server by somebody else."""
    match = HOST.fullmatch(host.lower())
    if match is None:
        return False
    named = {m[2] for m in map(ORIGIN.fullmatch, doors.origins) if m}
    return doors.tokens or match[1] in named or _is_loopback(match[1]) or _ip(match[1]) is not None


def _from_here(origin: str, host: str | None, doors: Doors) -> bool:
    """Whether a page is one of ours, or of this machine where nobody else can come in."""
    match = ORIGIN.fullmatch(origin.lower())
    if match is None or match[1] not in PORTS:
        return False
    if doors.loopback and _is_loopback(match[2]):
        return True
    here = HOST.fullmatch(host.lower()) if host else None
    usual = PORTS[match[1]]
    return here is not None and (here[1], here[2] or usual) == (match[2], match[3] or usual)


def _is_loopback(name: str) -> bool:
    """`localhost` and names under it, which browsers never look up, and addresses of this machine."""
    found = _ip(name)
    return found.is_loopback if found else name == "localhost" or name.endswith(".localhost")


def _ip(name: str) -> ipaddress.IPv4Address | ipaddress.IPv6Address | None:
    try:
        return ipaddress.ip_address(name.strip("[]"))
    except ValueError:
        return None


def _normal(origin: str) -> str:
    match = ORIGIN.fullmatch(origin.lower().rstrip("/"))
    if match is None:
        raise InputError(
            f"{origin!r} is no origin such as https://example.org or http://localhost:3000 "
            "(names in other scripts as xn--...)"
        )
    scheme, name, port = match.groups()
    return f"{scheme}://{name}" + (f":{port}" if port and port != PORTS.get(scheme) else "")
