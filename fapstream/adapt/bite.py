"""Teeth where the lips want them: for f and v the lower lip comes to the edge of the upper teeth."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from fapstream.fap.tables import visemes
from fapstream.head.deform import deform
from fapstream.head.mesh import Head

Floats = NDArray[np.float64]

BITTEN = 2
"""The viseme of f and v."""
EDGE = "9.10"
"""The feature point on the edge of the upper teeth."""
CLOSEST = 12
"""Vertices of the lip that count as what touches the teeth."""
INSIDE = ("teeth", "tongue")
"""How the names of the parts begin that are moved."""
ON_THEM = ("6.", "9.8", "9.9", "9.10", "9.11")
"""How the names of the feature points begin that lie on them."""


def bitten(head: Head, generic: Head, scale: float) -> Head:
    """`head` with its teeth and tongue shifted up or down, forward or back, so that they meet the lip as
    they do on `generic`, which it was carried over from, at a size of `scale`. As it is, if it has no teeth.
    """
    if EDGE not in generic.fdp or not any(part.name == "teeth_upper" for part in generic.parts):
        return head
    edge = np.array(generic.fdp[EDGE])
    lips = _under_f(generic)
    touching = np.linalg.norm(lips - edge, axis=1).argsort()[:CLOSEST]
    goal = _under_f(head)[touching].mean(0) + scale * (edge - lips[touching].mean(0))
    shift = (goal - np.array(head.fdp[EDGE])) * (0, 1, 1)
    parts = tuple(
        replace(part, positions=(part.positions + shift).astype(np.float32))
        if part.name.startswith(INSIDE)
        else part
        for part in head.parts
    )
    fdp = {
        name: (place[0], place[1] + float(shift[1]), place[2] + float(shift[2]))
        if name.startswith(ON_THEM)
        else place
        for name, place in head.fdp.items()
    }
    return replace(head, parts=parts, fdp=fdp)


def _under_f(head: Head) -> Floats:
    """The skin and the lining of the mouth under f: (n, 3) metres."""
    names = [part.name for part in head.parts if part.name in ("skin", "mouth")]
    parts = tuple(part for part in head.parts if part.name in names)
    fat = tuple(entry for entry in head.fat if entry.part in names)
    moved = deform(replace(head, parts=parts, fat=fat, turns=()), visemes()[BITTEN])
    return np.concatenate([moved[name] for name in names])
