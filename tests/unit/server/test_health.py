"""Alive and ready are two questions."""

from __future__ import annotations

import pytest

from fapstream.server.health import health


@pytest.mark.parametrize("warm", [False, True])
@pytest.mark.parametrize("draining", [False, True])
def test_who_answers_is_alive_and_ready_is_who_is_warm_and_stays(warm: bool, draining: bool) -> None:
    alive, ready = health("/healthz", warm, draining), health("/readyz", warm, draining)
    assert alive
    assert ready
    assert alive.status == 200
    assert ready.status == (200 if warm and not draining else 503)
    assert ("Cache-Control", "no-store") in alive.headers
    assert ready.body.endswith(b"\n")


def test_other_paths_are_somebody_elses() -> None:
    assert health("/", True, False) is None
    assert health("/healthz/", True, False) is None
