"""What makes a head move, put together: the model, its articulators, motions, feature points and turns.

`build_head` calls these in the order below; looks (skin, hair, eyes, clothes) are made elsewhere.
"""

from __future__ import annotations

import numpy as np

from fapstream.head.fapu import measure
from fapstream.head.mesh import Turn
from head_parts import dress
from head_parts.assemble import Piece
from head_parts.bust import Bust
from head_parts.cheeks import folded, lifts, puffs
from head_parts.fields import Motion, Y
from head_parts.jaw import Jaw, jaw_motions
from head_parts.lips import Lips
from head_parts.motions import Lids, Model, brow_motions, ear_motions, eye_motions, patch_motions
from head_parts.mouth import bite_of, tongue_of
from head_parts.points import on_skin
from head_parts.source import METRES, Source
from head_parts.surface import Array
from head_parts.teeth import CROWNS

CONDYLE_SKIN = (12045, 5446)
"""Vertices of the base mesh in front of the left and the right tragus, over the condyles."""
INCISOR = {row: crowns[0][1] for row, crowns in CROWNS.items()}
ATLAS_CUBE = slice(14070, 14078)
"""Vertices of the base mesh's cube about the joint of the head with the neck."""


def make_model(source: Source, bust: Bust) -> Model:
    """What all motions of this face are made from."""
    skin, points = bust.skin, on_skin(bust)
    lower = np.unique(source.groups["helper-lower-teeth"].vertices)
    opened = source.face_unit("jawOpen")
    before_ears = [bust.shape[vertex] for vertex in CONDYLE_SKIN]
    condyles = np.mean(before_ears, axis=0) * (0, 1, 1)
    teeth = bust.shape[lower], (bust.shape + opened)[lower]
    jaw = Jaw.fit(condyles, teeth, skin.points, bust.fine(opened))
    lips = Lips.of(skin, _still_skin(bust, points))
    bite, tongue = bite_of(source, bust, points), tongue_of(source, bust, points)
    return Model(bust, lips, jaw, bite, tongue, points, _units(bust, points))


def _still_skin(bust: Bust, named: dict[str, int]) -> np.ndarray:
    """bool (n,): skin that no lip FAP moves: eyes and up, the nose, the depth of the mouth."""
    points, under_nose = bust.skin.points, bust.skin.points[named["9.15"]]
    wing = points[named["9.1"]]
    still = points[:, 1] > bust.eyes["l"].centre[1] - 0.16
    still |= (
        (points[:, 1] > under_nose[1] - 0.01)
        & (np.abs(points[:, 0]) < wing[0] + 0.01)
        & (points[:, 2] > under_nose[2] - 0.11)
    )
    depth = points[bust.skin.inner.vertices][:, 2].min()
    lining = np.zeros(len(points), bool)
    lining[np.unique(bust.step.faces.reshape(4, -1, 4)[:, bust.charts == 1])] = True
    return still | (lining & (points[:, 2] < depth - 0.12))


def _units(bust: Bust, points: dict[str, int]) -> dict[str, float]:
    """FAPU in decimetres (AU: radians) per unit, from the skin and the eyes' centres."""
    at = {name: tuple(bust.skin.points[vertex]) for name, vertex in points.items()}
    at |= {"3.5": tuple(bust.eyes["l"].centre), "3.6": tuple(bust.eyes["r"].centre)}
    fapu = measure(at)
    return {name: fapu.per_unit(name) for name in ("IRISD", "ES", "ENS", "MNS", "MW", "AU")}


def make_motions(source: Source, model: Model, pieces: dict[str, Piece]) -> list[Motion]:
    """All FAPs that displace vertices, on every part they move."""
    body, unit = model.tongue, model.unit
    carried = {
        "teeth_lower": (pieces["teeth_lower"].points, np.ones(len(pieces["teeth_lower"].points))),
        "tongue": (body.mesh.points, 0.5 + 0.5 * np.minimum(body.t / 0.35, 1)),
    }
    guide = lambda name: model.bust.fine(source.face_unit(name))  # noqa: E731
    motions = folded(model.lips, model.lips.motions(unit, model.jaw.bone), guide)
    motions += puffs(model.lips, model.points, guide, unit) + lifts(model.lips, model.points, guide, unit)
    motions += body.motions(unit) + brow_motions(model)
    motions += jaw_motions(model.jaw, model.lips, model.points["2.1"], unit, carried)
    motions += patch_motions(model) + ear_motions(model, dress.ear_mask(source, model.bust))
    for side in "lr":
        motions += Lids(model, side).motions(pieces[f"lashes_{side}"].points)
        for name in eye_parts(pieces, side):
            motions += eye_motions(model.bust.eyes[side], side, name, pieces[name].points, model.unit)
    lining = [Motion(m.fap, "mouth", m.knots, m.moves) for m in motions if m.part == "skin"]
    return motions + lining


def eye_parts(pieces: dict[str, Piece], side: str) -> list[str]:
    """The parts that turn with an eye: eye_l, cornea_l and the like; not the lashes."""
    return [name for name in pieces if name.endswith(f"_{side}") and not name.startswith(("lashes", "lid"))]


def feature_points(model: Model, pieces: dict[str, Piece]) -> dict[str, Array]:
    """All 84 feature points, in the source's frame."""
    points = {name: model.skin.points[vertex] for name, vertex in model.points.items()}
    body = model.tongue.mesh.points
    left, right = model.tongue.borders
    points |= {"6.1": body[model.tongue.tip], "6.2": body[model.tongue.body]}
    points |= {"6.3": body[left], "6.4": body[right]}
    for name, side in (("3.5", "l"), ("3.6", "r")):
        ball, centre = pieces[f"eye_{side}"].points, model.bust.eyes[side].centre
        points[name] = ball[np.argmax(ball[:, 2] - 9 * np.linalg.norm((ball - centre)[:, :2], axis=1))]
    bite = model.bite
    for row, arch, edge, names in (("upper", bite.upper, bite.upper_edge, ("9.10", "9.8")),
                                   ("lower", bite.lower, bite.lower_edge, ("9.11", "9.9"))):  # fmt: skip
        crown = (1 if row == "upper" else -1) * INCISOR[row]
        points[names[0]] = np.array([0.0, edge, arch.front])
        points[names[1]] = np.array([0.0, edge + crown, arch.front])
    points["11.5"] = points["11.4"] + _hair_over(points["11.4"], pieces["hair"].points) * Y
    points["7.1"] = atlas(model.bust)
    return points


def _hair_over(skull: Array, hair: Array) -> float:
    """How far the hair (n, 3) rises above a point of the skull."""
    near = np.linalg.norm((hair - skull)[:, [0, 2]], axis=1) < 0.15
    return float(np.maximum(hair[near, 1] - skull[1], 0).max(initial=0))


def atlas(bust: Bust) -> Array:
    """The top of the spine, about which the head turns."""
    return np.array([0.0, *bust.shape[ATLAS_CUBE].mean(0)[1:]])


def make_turns(source: Source, model: Model, pieces: dict[str, Piece], origin: Array) -> tuple[Turn, ...]:
    """Eyes about their centres, the head about the atlas; `origin` is the head file's, decimetres."""
    out = []
    for side, yaw, pitch in (("l", 23, 25), ("r", 24, 26)):
        pivot = tuple(float(c) for c in (model.bust.eyes[side].centre - origin) * METRES)
        parts = tuple(eye_parts(pieces, side))
        out.append(Turn((yaw, pitch), ((0.0, 1.0, 0.0), (1.0, 0.0, 0.0)), parts, pivot))
    neck = dress.neck_weights(source, model.bust)
    weights = {}
    for name in ("skin", "mouth"):
        weights[name] = _bytes(neck[pieces[name].sources])
    weights["shirt"] = _bytes(dress.spread(model.skin.points, neck, pieces["shirt"].points))
    axes = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    pivot = tuple(float(c) for c in (atlas(model.bust) - origin) * METRES)
    out.append(Turn((48, 49, 50), axes, None, pivot, weights))
    return tuple(out)


def _bytes(weights: Array) -> np.ndarray:
    return (np.rint(np.clip(weights, 0, 1) * 255) / np.float32(255)).astype(np.float32)
