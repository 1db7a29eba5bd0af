"""Teeth where the lips want them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fapstream.adapt.bite import bitten
from fapstream.head.mesh import Head
from tests.unit.head.packaged import packaged


def shifted(head: Head, shift: tuple[float, float, float]) -> Head:
    """The head with its teeth somewhere else."""
    parts = tuple(
        replace(p, positions=p.positions + np.float32(shift)) if p.name.startswith(("teeth", "tongue")) else p
        for p in head.parts
    )
    return replace(head, parts=parts, fdp=head.fdp | {"9.10": tuple(np.array(head.fdp["9.10"]) + shift)})


def test_teeth_that_went_astray_come_back_but_not_aside() -> None:
    head = packaged()
    for shift in ((0.0, 0.004, -0.003), (0.0, -0.002, 0.005)):
        again = bitten(shifted(head, shift), head, 1.0)
        for name in ("teeth_upper", "teeth_lower", "tongue"):
            np.testing.assert_allclose(again.part(name).positions, head.part(name).positions, atol=1e-6)
        np.testing.assert_allclose(again.fdp["9.10"], head.fdp["9.10"], atol=1e-6)
    aside = bitten(shifted(head, (0.003, 0.0, 0.0)), head, 1.0)
    assert abs(aside.fdp["9.10"][0] - 0.003) < 1e-6


def test_a_head_without_teeth_is_left_alone() -> None:
    head = packaged()
    bare = replace(head, parts=tuple(p for p in head.parts if p.name != "teeth_upper"))
    assert bitten(bare, bare, 1.0) is bare
