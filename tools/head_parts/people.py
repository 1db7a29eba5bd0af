"""People as data: who the ready heads are, read from people.toml."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np

from head_parts.source import Source
from head_parts.surface import Array

Colour = tuple[float, float, float]
EXPRESSION = {"mouthSmileLeft": 0.10, "mouthSmileRight": 0.10, "eyeBlinkLeft": 0.07, "eyeBlinkRight": 0.07}
"""What the neutral face wears, by ARKit shape: a trace of friendliness."""
CHIN = 5225
"""Vertex of the base mesh at the tip of the chin."""
EVERYBODY = {"african": 1.0, "asian": 1.0, "caucasian": 1.0}


@dataclass(frozen=True)
class SkinLook:
    """Colours 0..255 sRGB; the rest are strengths about 1."""

    tone: Colour
    lip: Colour
    blush: float = 1.0
    freckles: float = 0.0
    stubble: float = 0.0
    lines: float = 0.0


@dataclass(frozen=True)
class EyeLook:
    """`crease`: how far the fold of the upper lid is above its margin, decimetres."""

    iris: Colour
    sclera: Colour = (228, 220, 214)
    crease: float = 0.062


@dataclass(frozen=True)
class BrowLook:
    colour: Colour
    weight: float = 1.0


@dataclass(frozen=True)
class HairLook:
    """`groom` names a table in grooms.toml; `grey` is the share of strands without pigment."""

    groom: str
    root: Colour
    tip: Colour
    grey: float = 0.0


@dataclass(frozen=True)
class ShirtLook:
    """`neckline`: how far the collar is above the usual one, decimetres."""

    colour: Colour
    neckline: float = 0.0


@dataclass(frozen=True)
class Person:
    """`female` and `old` 0..1, `ancestry` shares by name, `shape` target strengths."""

    title: str
    female: float
    old: float
    ancestry: Mapping[str, float]
    shape: Mapping[str, float]
    skin: SkinLook
    eyes: EyeLook
    brows: BrowLook
    hair: HairLook
    shirt: ShirtLook


LOOKS = {"skin": SkinLook, "eyes": EyeLook, "brows": BrowLook, "hair": HairLook, "shirt": ShirtLook}


def people() -> dict[str, Person]:
    """Everybody in people.toml, by the name of the file to write."""
    text = Path(__file__).with_name("people.toml").read_text("utf-8")
    return {name: _person(name, row) for name, row in tomllib.loads(text).items()}


def _person(name: str, row: dict[str, Any]) -> Person:
    looks = {key: _look(f"{name}.{key}", kind, row.pop(key)) for key, kind in LOOKS.items()}
    return Person(**row, **looks)


def _look(where: str, kind: type, row: dict[str, Any]) -> Any:
    unknown = set(row) - {f.name for f in fields(kind)}
    if unknown:
        raise SystemExit(f"people.toml: [{where}] has no {', '.join(sorted(unknown))}")
    return kind(**{key: tuple(value) if isinstance(value, list) else value for key, value in row.items()})


def shaped(source: Source, person: Person) -> Array:
    """The body (n, 3) of a person, decimetres: scaled and shifted so that the eyes are at the same
    place and the head as high as on the average adult. Faces keep their proportions.
    """
    shape = source.adult(person.female, person.old, person.ancestry)
    for target, strength in person.shape.items():
        for name in sorted({target.replace("*", side) for side in "lr"}):
            shape += strength * source.target(name)
    for unit, strength in EXPRESSION.items():
        shape += strength * source.face_unit(unit)
    (eyes, size), (goal, wanted) = _frame(source, shape), _frame(source, source.adult(0.5, 0.0, EVERYBODY))
    return (shape - eyes) * (wanted / size) + goal


def _frame(source: Source, shape: Array) -> tuple[Array, float]:
    """Middle of the eyes, and the height of the head."""
    eyes = [shape[np.unique(source.groups[f"helper-{side}-eye"].vertices)].mean(0) for side in "lr"]
    body = shape[np.unique(source.groups["body"].vertices)]
    return np.mean(eyes, axis=0), float(body[:, 1].max() - shape[CHIN, 1])
