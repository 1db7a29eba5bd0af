"""Who may come in: tokens, and as many as there is room for."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from functools import partial

from fapstream.ports import Clock
from fapstream.protocol import generated as g
from fapstream.server.admission import Admission, Bucket, Kind
from fapstream.server.tokens import EVERYTHING, Grant, check, mint

LISTEN_TTL_S = 24 * 3600.0
"""How long the token that a shared session gives out is good for."""

Leave = Callable[[], None]


class Gate:
    """Without `secrets` nobody needs a token."""

    def __init__(self, admission: Admission, clock: Clock, secrets: Sequence[bytes] = ()) -> None:
        self._admission = admission
        self._clock = clock
        self._secrets = secrets

    def open(self, address: str) -> Leave:
        """Let a connection in that has not said what it comes for. Raises Busy."""
        return self.enter("opening", address)

    def speak(self, hello: g.Hello, address: str) -> Leave:
        """Let a speaker in; what is returned is called when its session is over.

        Raises NotAuthorised, Busy.
        """
        self.grant(hello.token).require("speak", hello.channel)
        return self.enter("session", address)

    def listen(self, wish: g.Listen, address: str) -> Leave:
        """Let a listener in, likewise."""
        self.grant(wish.token).require("listen", wish.channel)
        return self.enter("listener", address)

    def adapt(self, token: str | None, address: str) -> Leave:
        """Let an editor page in, likewise."""
        self.grant(token).require("adapt")
        return self.enter("adapting", address)

    def grant(self, token: str | None) -> Grant:
        """What a token allows now. Raises NotAuthorised."""
        return check(token or "", self._secrets, time.time()) if self._secrets else EVERYTHING

    def enter(self, kind: Kind, address: str) -> Leave:
        """Count one in. Raises Busy."""
        self._admission.enter(kind, address, self._clock.now())
        return partial(self._admission.leave, kind, address)

    def listen_token(self, channel: str) -> str | None:
        """A token that allows to listen to one channel; None where nobody needs one."""
        if not self._secrets:
            return None
        grant = Grant(frozenset({"listen"}), channel)
        return mint(self._secrets[0], grant, LISTEN_TTL_S, time.time())

    def pace(self) -> Callable[[int], float]:
        """For one connection: seconds to wait before the next message is read after one of so many bytes."""
        limits, clock = self._admission.limits, self._clock
        messages = Bucket(limits.messages_per_s, limits.messages_burst)
        size = Bucket(limits.bytes_per_s, limits.bytes_burst)

        def wait(n: int) -> float:
            now = clock.now()
            return max(messages.take(1, now), size.take(n, now))

        return wait
