"""What is true of a random person: the generic head's skin, vertex by vertex, and the feature points on
it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from scipy.spatial import cKDTree

from fapstream.adapt.points import generic_places
from fapstream.head.mesh import Head
from head_parts import dress, paint
from head_parts.bust import Bust, cut, fit_ball, lower_arms, reshaped
from head_parts.hair import Scalp, groom
from head_parts.lip_mesh import skin_piece
from head_parts.people import Person, people, shaped
from head_parts.source import METRES, Source
from head_parts.surface import Array

EYE_POINTS = {"3.5": "l", "3.6": "r"}
"""Feature points on the eyeballs; all others lie on the skin."""


@dataclass(frozen=True)
class Likeness:
    """A person in the generic head's terms, metres, in the frame of that person's head file.

    `skin` (n, 3): where the generic skin's vertices are; `points`: feature points by name, (3,).
    """

    skin: Array
    points: dict[str, Array]


@dataclass(frozen=True)
class Measure:
    """The generic head's skin as a mixture of the base mesh's vertices, so that it can be had of any
    person.
    """

    source: Source
    bust: Bust
    blend: sp.csr_matrix
    vertices: dict[str, int]
    """Of the skin, by feature point."""
    front: float
    """How far before its centre an eyeball's foremost point lies, in radii."""

    @classmethod
    def of(cls, source: Source, generic: Head) -> Measure:
        """`generic`: the packaged head, which the source must give again."""
        person = people()["generic"]
        bust = cut(source, lower_arms(source, shaped(source, person)))
        scalp = Scalp(bust, groom(person.hair.groom), dress.ear_mask(source, bust))
        visible = dress.visible_skin(bust, scalp, person.shirt)
        detail = visible & dress.worth_detail(bust, scalp)
        piece = skin_piece("skin", bust, visible, detail, paint.MOUTH).packed()
        skin = generic.part("skin").positions
        if np.abs(piece.part(_origin(source, bust.shape)).positions - skin).max() > 1e-4:
            raise SystemExit("the packaged generic head was not built from this source")
        tree = cKDTree(skin)
        places = generic_places(generic.fdp)
        vertices = {name: int(tree.query(at)[1]) for name, at in places.items() if name not in EYE_POINTS}
        eye = bust.eyes["l"]
        middle = (eye.centre - _origin(source, bust.shape)) * METRES
        front = (places["3.5"][2] - middle[2]) / (eye.radius * METRES)
        assert piece.blend is not None
        return cls(source, bust, piece.blend, vertices, float(front))

    def likeness(self, person: Person) -> Likeness:
        """Of any person."""
        shape = reshaped(self.bust, lower_arms(self.source, shaped(self.source, person)))
        origin = _origin(self.source, shape)
        skin = (self.blend @ (self.bust.step.matrix @ shape[self.bust.control]) - origin) * METRES
        points = {name: skin[vertex] for name, vertex in self.vertices.items()}
        for name, side in EYE_POINTS.items():
            ball = shape[np.unique(self.source.groups[f"helper-{side}-eye"].vertices)]
            centre, radius = fit_ball(ball)
            points[name] = (centre + (0, 0, self.front * radius) - origin) * METRES
        return Likeness(skin, points)


def _origin(source: Source, shape: Array) -> Array:
    return shape[np.unique(source.groups["joint-head"].vertices)].mean(0)
