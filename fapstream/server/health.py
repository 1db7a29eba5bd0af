"""What watchers ask a server: whether it is alive, and whether it wants to be given work. Pure."""

from __future__ import annotations

from fapstream.server.http import Answer, plain

ALIVE = "/healthz"
READY = "/readyz"


def health(path: str, warm: bool, draining: bool) -> Answer | None:
    """The answer to a question about health, None for another path.

    Alive is who answers at all. Ready is who has warm voices and is not about to go: proxies send newcomers
    elsewhere on a 503, and nobody is restarted for it.
    """
    if path == ALIVE:
        return plain(200, "alive\n")
    if path != READY:
        return None
    if draining:
        return plain(503, "draining: let those who are here finish, send nobody\n")
    return plain(200, "ready\n") if warm else plain(503, "warming up\n", ("Retry-After", "1"))
