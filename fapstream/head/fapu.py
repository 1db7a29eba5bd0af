"""FAPU: the facial animation parameter units of one face (ISO/IEC 14496-2, Annex C)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from fapstream.errors import DataError
from fapstream.fap.tables import ANGLE_UNIT_RAD

Point = tuple[float, float, float]

_DISTANCES: tuple[tuple[str, str, str, int], ...] = (
    ("IRISD0", "3.1", "3.3", 1),
    ("ES0", "3.5", "3.6", 0),
    ("ENS0", "3.5", "9.15", 1),
    ("MNS0", "9.15", "2.2", 1),
    ("MW0", "8.3", "8.4", 0),
)
"""Name, the two feature points, and the coordinate along which they are measured."""


@dataclass(frozen=True, slots=True)
class Fapu:
    """Distances in metres on the neutral face; a FAP unit is 1/1024 of one of them."""

    irisd0: float
    es0: float
    ens0: float
    mns0: float
    mw0: float

    def per_unit(self, unit: str) -> float:
        """What one unit of a FAP is worth: metres, or radians for `AU`.

        `unit` is the standard's name: IRISD, ES, ENS, MNS, MW or AU. Raises KeyError.
        """
        if unit == "AU":
            return ANGLE_UNIT_RAD
        return self.as_dict()[f"{unit}0"] / 1024

    def as_dict(self) -> dict[str, float]:
        """By the names of protocol/HEAD.md."""
        values = (self.irisd0, self.es0, self.ens0, self.mns0, self.mw0)
        return {row[0]: value for row, value in zip(_DISTANCES, values, strict=True)}


def measure(fdp: Mapping[str, Point], where: str = "fdp") -> Fapu:
    """FAPU of the face whose feature points, in metres, are `fdp`.

    Raises DataError naming `where` if a point is missing or a distance is not positive.
    """
    values = []
    for name, high, low, axis in _DISTANCES:
        if high not in fdp or low not in fdp:
            raise DataError(where, None, f"{name} needs the feature points {high} and {low}")
        distance = fdp[high][axis] - fdp[low][axis]
        if not distance > 0:
            raise DataError(where, None, f"{name} = {high} - {low} is {distance:g} m, not positive")
        values.append(float(distance))
    return Fapu(*values)
