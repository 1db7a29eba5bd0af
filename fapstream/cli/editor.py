"""What the server's editor page works with, put together when the first page comes: most servers never need
it.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import TYPE_CHECKING

from fapstream.cli.heads import packaged
from fapstream.errors import FapstreamError, InputError
from fapstream.head.gltf import read_head
from fapstream.head.mesh import Head

if TYPE_CHECKING:
    from fapstream.adapt.session import Session
    from fapstream.ports import Landmarker

NEEDED = "adapting a head needs Pillow and SciPy on the server: pip install 'fapstream[adapt]'"


def editor(clock: Callable[[], float]) -> Session:
    """A session for one page. Raises InputError where the adapt extra is not installed."""
    try:
        from fapstream.adapt.session import Session
    except ModuleNotFoundError as e:
        if (e.name or "").partition(".")[0] in ("PIL", "scipy"):
            raise InputError(NEEDED) from None
        raise
    return Session(_generic(), _finder(), clock)


@cache
def _generic() -> Head:
    return read_head(packaged("generic").read_bytes(), "generic")


@cache
def _finder() -> Landmarker | None:
    """None where the landmarks extra is not installed: points are then placed by hand."""
    from fapstream.adapters import landmarks

    try:
        return landmarks.Landmarker()
    except FapstreamError:
        return None
