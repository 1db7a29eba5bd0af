"""The methods: ways to take the generic head to feature points found in photos."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fapstream.adapt.covariance import Covariance
from fapstream.adapt.parts import fit_parts
from fapstream.adapt.rbf import fit_radial
from fapstream.adapt.refine import Located
from fapstream.adapt.rigid import Similarity
from fapstream.adapt.smooth import fit_diffeomorphism, fit_probable
from fapstream.adapt.warp import Chain, Warp

Floats = NDArray[np.float64]

NOISE = 0.0004
"""Metres that a located feature point is off, roughly."""


@dataclass(frozen=True, slots=True)
class Task:
    """What a method is given: feature points by name on the generic head, where they are to be, and all
    places on the generic head that have names, MPEG-4's among them; (3,), metres."""

    source: Mapping[str, Floats]
    target: Mapping[str, Floats]
    places: Mapping[str, Floats]

    @classmethod
    def of(
        cls, located: Located, generic: Mapping[str, Floats], fdp: Mapping[str, tuple[float, float, float]]
    ) -> Task:
        """To fit what was located."""
        target = dict(zip(located.names, located.points, strict=True))
        return cls(generic, target, {name: np.array(at) for name, at in fdp.items()} | dict(generic))

    def arrays(self) -> tuple[Floats, Floats]:
        """Sources and targets, (n, 3) each."""
        source, target = (
            np.array([table[name] for name in self.target]) for table in (self.source, self.target)
        )
        return source, target


def rigid(task: Task) -> Warp:
    """Rotation, scale and translation alone."""
    return Similarity.fit(*task.arrays())


def _after_rigid(task: Task, local: Callable[[Floats, Floats], Warp]) -> Warp:
    source, target = task.arrays()
    pose = Similarity.fit(source, target)
    return Chain((pose, local(pose(source), target)))


def radial(task: Task) -> Warp:
    """Radial basis functions: the paper's comparison."""
    return _after_rigid(task, fit_radial)


def facial_parts(task: Task) -> Warp:
    """Facial parts deformation: the first paper's method."""
    pose = Similarity.fit(*task.arrays())
    source, places = (
        {name: pose(at[None])[0] for name, at in table.items()} for table in (task.source, task.places)
    )
    return Chain((pose, fit_parts(source, task.target, places)))


def diffeomorphic(task: Task) -> Warp:
    """Steps of Gaussian kernels: the third paper's method."""
    return _after_rigid(task, fit_diffeomorphism)


def best(task: Task) -> Warp:
    """The most probable face: symmetric and smooth at several sizes."""
    return _after_rigid(task, lambda source, target: fit_probable(source, target, NOISE, Covariance()))


METHODS: Mapping[str, Callable[[Task], Warp]] = {
    "best": best, "fpd": facial_parts, "rbf": radial, "diffeo": diffeomorphic, "rigid": rigid,
}  # fmt: skip
