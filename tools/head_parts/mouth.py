"""The articulators behind the lips: teeth with gums, tongue, the lining of the mouth. Decimetres."""

from __future__ import annotations

import numpy as np

from head_parts import paint
from head_parts.assemble import Piece
from head_parts.bust import Bust
from head_parts.lip_mesh import lip_loops, skin_piece
from head_parts.source import Source
from head_parts.surface import Array
from head_parts.teeth import Bite, teeth
from head_parts.tongue import Tongue

LINING = 554
"""Vertex of the base mesh behind the middle of the upper lip."""
TONGUE_TIP = (0.075, 0.035)
"""How far the tongue's tip is behind the front of the lower arch and below the teeth's edge."""
DARKENS = {"tongue": 0.25, "mouth": 0.6}
"""How much of the picture's fall into darkness a part takes; the light falls off besides."""
TONGUE_SINK = (0.0, -0.045, -0.06)
"""From the source's joints to the tongue's midline."""


def articulators(source: Source, bust: Bust, points: dict[str, int]) -> dict[str, Piece]:
    """The parts `teeth_upper`, `teeth_lower`, `tongue` and `mouth` (the lining)."""
    lining = bust.charts == 1
    # as fine as the skin it is joined to, so that no crack opens between them
    beside_lips = np.isin(bust.quads, lip_loops(bust)[-1]).any(1)
    bite, body = bite_of(source, bust, points), tongue_of(source, bust, points)
    pieces = {
        "teeth_upper": Piece.of("teeth_upper", teeth("upper", bite), paint.TEETH),
        "teeth_lower": Piece.of("teeth_lower", teeth("lower", bite), paint.TEETH),
        "tongue": Piece.of("tongue", body.mesh, paint.TONGUE),
        "mouth": skin_piece("mouth", bust, lining, beside_lips & lining, paint.MOUTH),
    }
    for name, gloom in DARKENS.items():
        pieces[name].uvs = into_depth(pieces[name].points, bite) * (1.0, gloom)
    return pieces


def into_depth(points: Array, bite: Bite) -> Array:
    """Texture coordinates (n, 2) of the mouth's inside: v is how far back."""
    depth = np.clip((bite.upper.front - 0.025 - points[:, 2]) / 0.65, 0.06, 0.98) ** 1.4
    return np.stack([np.full(len(points), 0.5), depth], 1)


def bite_of(source: Source, bust: Bust, points: dict[str, int]) -> Bite:
    """The teeth of this face, on the source's own and behind its lips."""
    cage = bust.shape[np.unique(source.groups["helper-upper-teeth"].vertices)]
    lining = float(bust.shape[LINING][2])
    return Bite.of(cage, lining, float(bust.skin.points[points["2.2"]][1]))


def tongue_of(source: Source, bust: Bust, points: dict[str, int]) -> Tongue:
    """The tongue on the source's joints, its tip behind the lower teeth."""
    bite = bite_of(source, bust, points)
    joints = [bust.shape[np.unique(source.groups[f"joint-tongue-{k}"].vertices)].mean(0) for k in (1, 2, 3)]
    tip = np.array([0.0, bite.lower_edge - TONGUE_TIP[1], bite.lower.front - TONGUE_TIP[0]])
    return Tongue.grown(np.array(joints) + TONGUE_SINK, tip, 0.72 * bite.lower.half_width)
