"""Who may come in while the server is full or behind. Pure: times are arguments, in seconds of one clock.

Those who are in are never touched; newcomers are told when to come back, each at another time.
"""

from __future__ import annotations

import ipaddress
import math
import random
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from fapstream.errors import Busy, InputError

Kind = Literal["opening", "session", "listener", "adapting"]
Network = ipaddress.IPv4Network | ipaddress.IPv6Network
IpAddress = ipaddress.IPv4Address | ipaddress.IPv6Address


@dataclass(frozen=True, slots=True)
class Limits:
    """What one server process takes. Counts are of sockets, rates are for one socket."""

    sessions: int = 200
    """Clients that may speak."""
    sessions_per_address: int = 50
    listeners: int = 2000
    """Clients that only listen; they cost no voice."""
    listeners_per_address: int = 200
    adapting: int = 4
    """Editor pages: each keeps photos in memory and the processor busy."""
    adapting_per_address: int = 2
    opening: int = 500
    """Sockets that have not said `hello` yet."""
    opening_per_address: int = 100
    messages_per_s: float = 500.0
    """Above what language models write."""
    messages_burst: int = 2000
    bytes_per_s: float = 8192.0
    """Of messages: hundreds of times as fast as text is spoken."""
    bytes_burst: int = 1 << 20
    """A long article passes in one piece."""
    strained_lateness_s: float = 0.02
    """Newcomers wait while more than one recent packet in a hundred leaves later than this."""

    def of(self, kind: Kind) -> tuple[int, int]:
        """(in all, from one address)."""
        match kind:
            case "session":
                return self.sessions, self.sessions_per_address
            case "listener":
                return self.listeners, self.listeners_per_address
            case "adapting":
                return self.adapting, self.adapting_per_address
            case "opening":
                return self.opening, self.opening_per_address


NAMES: dict[Kind, str] = {
    "opening": "connections are being opened",
    "session": "sessions are open",
    "listener": "listeners are here",
    "adapting": "heads are being made",
}


class Admission:
    """Counts who is in and refuses who is too many. `chance` spreads the times to come back."""

    def __init__(self, limits: Limits, chance: random.Random) -> None:
        self.limits = limits
        self.load = Load(limits.strained_lateness_s)
        self._inside: Counter[Kind] = Counter()
        self._from: Counter[tuple[Kind, str]] = Counter()
        self._returns = Returns(chance)

    def inside(self, kind: Kind) -> int:
        """How many are in."""
        return self._inside[kind]

    def enter(self, kind: Kind, address: str, now: float) -> None:
        """Count one in; who raised nothing here has to `leave`. Raises Busy."""
        most, most_of_one = self.limits.of(kind)
        if self._inside[kind] >= most:
            raise self._busy(f"too many {NAMES[kind]} here", now)
        if self._from[kind, address] >= most_of_one:
            raise self._busy(f"too many {NAMES[kind]} from your address", now)
        if kind != "opening" and self.load.strained(now):
            raise self._busy("the server is behind with those who are here", now)
        self._inside[kind] += 1
        self._from[kind, address] += 1

    def leave(self, kind: Kind, address: str) -> None:
        """Count one out that was let in."""
        self._inside[kind] -= 1
        self._from[kind, address] -= 1
        if not self._from[kind, address]:
            del self._from[kind, address]  # the table stays as large as the crowd

    def _busy(self, reason: str, now: float) -> Busy:
        return Busy(reason, round(1000 * self._returns.delay_s(now)))


class Returns:
    """When those who were refused shall come back: one after the other, not all at once."""

    SOONEST_S = 1.0
    SPREAD_S = 4.0
    LATEST_S = 60.0
    PER_S = 20.0
    """How many are asked back for the same second."""
    FORGOTTEN_S = 30.0

    def __init__(self, chance: random.Random) -> None:
        self._chance = chance
        self._recent = Fading(self.FORGOTTEN_S)

    def delay_s(self, now: float) -> float:
        """For one more who was refused."""
        turn = self._recent.add(1.0, now) / self.PER_S
        if turn > self.LATEST_S:
            turn = self._chance.uniform(0, self.LATEST_S)
        return self.SOONEST_S + turn + self._chance.uniform(0, self.SPREAD_S)


class Load:
    """Whether the server keeps up, judged by when packets left and when they should have."""

    LATE_SHARE = 0.01
    LEAST_LATE = 5.0
    """A packet or two may be late in a second when a disk or a neighbour is busy."""
    FORGOTTEN_S = 5.0
    CALM_S = 2.0
    """After so long without a late packet it is over, however many there were: they may all have left."""

    def __init__(self, late_s: float) -> None:
        self._late_s = late_s
        self._last_late = -math.inf
        self._all = Fading(self.FORGOTTEN_S)
        self._late = Fading(self.FORGOTTEN_S)

    def sent(self, lateness_s: float, now: float) -> None:
        """A packet has left so long after it was due."""
        self._all.add(1.0, now)
        if lateness_s > self._late_s:
            self._late.add(1.0, now)
            self._last_late = now

    def strained(self, now: float) -> bool:
        """Whether the 99th percentile of the recent packets' lateness is above the limit."""
        if now - self._last_late > self.CALM_S:
            return False
        late = self._late.add(0.0, now)
        return late >= self.LEAST_LATE and late > self.LATE_SHARE * self._all.add(0.0, now)


class Fading:
    """A sum whose parts lose their weight with time, down to 1/e after `fades_s`."""

    __slots__ = ("_at", "_fades_s", "_sum")

    def __init__(self, fades_s: float) -> None:
        self._fades_s = fades_s
        self._sum = 0.0
        self._at = -math.inf

    def add(self, amount: float, now: float) -> float:
        """The sum with this in it."""
        if now > self._at:
            self._sum *= math.exp((self._at - now) / self._fades_s)
            self._at = now
        self._sum += amount
        return self._sum


class Bucket:
    """A rate that may be exceeded for a while: `burst` at once, `per_s` on and on."""

    __slots__ = ("_at", "_burst", "_level", "_per_s")

    def __init__(self, per_s: float, burst: float) -> None:
        self._per_s, self._burst = per_s, burst
        self._level = burst
        self._at = -math.inf

    def take(self, amount: float, now: float) -> float:
        """Seconds to wait before this may go on; it is taken at once. More than fits is owed."""
        if now > self._at:
            self._level = min(self._burst, self._level + (now - self._at) * self._per_s)
            self._at = now
        self._level -= amount
        return max(0.0, -self._level / self._per_s)


def networks(texts: Sequence[str]) -> tuple[Network, ...]:
    """Addresses and networks of proxies to be believed, such as `10.0.0.0/8`. Raises InputError."""
    found = []
    for text in texts:
        try:
            found.append(ipaddress.ip_network(text.strip(), strict=False))
        except ValueError:
            raise InputError(f"{text!r} is no address and no network such as 10.0.0.0/8") from None
    return tuple(found)


def address_of(peer: str, forwarded: str | None, trusted: Sequence[Network]) -> str:
    """Who a client counts as: its IPv4 address, or the /64 of its IPv6 address, which one customer has whole.

    `peer`: the other end of the socket. `forwarded`: X-Forwarded-For, its lines joined by commas; believed
    only as far as it was written by proxies that are trusted, so from the right up to the first stranger.
    """
    hops = [hop for hop in (forwarded or "").split(",") if hop.strip()]
    here = _parsed(peer)
    while here and hops and any(here in network for network in trusted):
        before = _parsed(hops.pop())
        if before is None:
            break  # a proxy that hides whom it serves counts itself
        here = before
    if here is None:
        return peer[:64]
    return str(here) if here.version == 4 else str(ipaddress.ip_network((int(here) >> 64 << 64, 64)))


def _parsed(text: str) -> IpAddress | None:
    """`1.2.3.4`, `1.2.3.4:80`, `2001:db8::1`, `[2001:db8::1]:80`; IPv4 in IPv6 as IPv4."""
    text = text.strip().strip('"')
    if text.startswith("["):
        text = text[1:].partition("]")[0]
    elif text.count(":") == 1:
        text = text.partition(":")[0]
    try:
        found = ipaddress.ip_address(text.partition("%")[0])
    except ValueError:
        return None
    return getattr(found, "ipv4_mapped", None) or found
