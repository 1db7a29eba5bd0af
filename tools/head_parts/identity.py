"""Random persons from the CC0 identity targets: a test instrument for adaptation, not people.

Macro targets give age, gender, ancestry and weight; then every slider of head, face, ears and neck is drawn
about nothing; then one side of the face is made a little unlike the other.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np

from head_parts.people import BrowLook, Colour, EyeLook, HairLook, Person, ShirtLook, SkinLook
from head_parts.source import Source

SLIDER_SD = 0.2
"""Gives heads 2.4 to 3.1 mm rms from the mean head; 0.45 gives caricatures."""
ASYMMETRY_SD = 0.12
FOLDERS = ("head", "forehead", "eyebrows", "eyes", "nose", "mouth", "ears", "chin", "cheek", "neck")
ENDS = (
    ("decr", "incr"), ("down", "up"), ("in", "out"), ("backward", "forward"), ("concave", "convex"),
    ("compress", "uncompress"),
)  # fmt: skip
"""How the two ends of a slider are called."""
SHAPES = ("oval", "round", "rectangular", "square", "triangular", "invertedtriangular", "diamond")
POSE = re.compile(r"head-trans|neck-trans|head-angle|(nose|mouth)-trans-(in|out)|measure-|head-age")
"""Where the head is held rather than how it is made, the two that shift one feature out of the middle, and
age, which the macro targets have."""

TONES: tuple[tuple[Colour, Colour], ...] = (
    ((238, 200, 178), (206, 132, 122)), ((226, 182, 154), (200, 122, 116)),
    ((221, 174, 149), (196, 126, 114)), ((196, 148, 116), (176, 106, 96)),
    ((160, 114, 86), (142, 90, 80)), ((124, 87, 68), (112, 74, 66)),
)  # fmt: skip
"""Skin and lips."""
IRISES: tuple[Colour, ...] = ((92, 66, 42), (58, 38, 26), (86, 104, 116), (98, 116, 84), (120, 96, 60))
HAIRS: tuple[tuple[Colour, Colour], ...] = (
    ((40, 27, 20), (112, 78, 54)), ((20, 16, 15), (62, 48, 42)), ((92, 68, 42), (168, 132, 88)),
    ((74, 36, 22), (142, 78, 48)), ((110, 106, 102), (190, 186, 180)),
)  # fmt: skip
"""Roots and tips."""
GROOMS = ("crop", "buzz", "bob", "layers")


@dataclass(frozen=True)
class Sliders:
    """What can be drawn: (negative, positive) target names, "*" for both sides, and asymmetric targets."""

    pairs: tuple[tuple[str, str], ...]
    uneven: tuple[str, ...]

    @classmethod
    def of(cls, source: Source) -> Sliders:
        """All that the source has, in a fixed order."""
        pairs = []
        for folder in FOLDERS:
            names = {re.sub(r"^[lr]-", "*-", name) for name in source.targets(folder)}
            for name in sorted(names):
                for low, high in ENDS:
                    other = name.removesuffix(low) + high
                    if name.endswith(f"-{low}") and other in names and not POSE.search(name):
                        pairs.append((f"{folder}/{name}", f"{folder}/{other}"))
        uneven = [f"asym/{name}" for name in source.targets("asym") if name.startswith("asym-")]
        return cls(tuple(pairs), tuple(sorted(uneven)))

    def draw(self, rng: np.random.Generator) -> dict[str, float]:
        """Strengths by target."""
        shape: dict[str, float] = {}
        for pair in self.pairs:
            value = float(np.clip(rng.normal(0, SLIDER_SD), -1, 1))
            shape[pair[value > 0]] = abs(value)
        for name in self.uneven:
            value = float(rng.normal(0, ASYMMETRY_SD))
            if value > 0:
                shape[name] = value
        shape[f"head/head-{rng.choice(SHAPES)}"] = float(rng.uniform(0, 0.5))
        return shape


def random_person(source: Source, sliders: Sliders, seed: int) -> Person:
    """The same person for the same seed."""
    rng = np.random.default_rng(seed)
    female = float(np.clip(rng.integers(2) + rng.normal(0, 0.12), 0, 1))
    old = float(rng.uniform(0, 0.6))
    shares = rng.dirichlet((0.6, 0.6, 0.6))
    shape = sliders.draw(rng) | _weight(female, old, float(np.clip(rng.normal(0, 0.3), -0.7, 0.7)))
    tone, lip = TONES[rng.integers(len(TONES))]
    root, tip = HAIRS[rng.integers(len(HAIRS))]
    brow = _colour(0.7 * np.array(root) + 0.3 * np.array(tip))
    shirt = _colour(rng.integers(50, 200, 3))
    return Person(
        title=f"Person {seed}", female=female, old=old,
        ancestry=dict(zip(("african", "asian", "caucasian"), shares.tolist(), strict=True)), shape=shape,
        skin=SkinLook(tone, lip, blush=float(rng.uniform(0.4, 1)), freckles=float(rng.uniform(0, 0.3)),
                      stubble=float(0.5 * (female < 0.5) * rng.random()), lines=max(0.0, 2 * old - 0.4)),
        eyes=EyeLook(IRISES[rng.integers(len(IRISES))]),
        brows=BrowLook(brow, float(rng.uniform(0.6, 1))),
        hair=HairLook(str(rng.choice(GROOMS[:2] if female < 0.5 else GROOMS[2:])), root, tip),
        shirt=ShirtLook(shirt),
    )  # fmt: skip


def _colour(values: np.ndarray) -> Colour:
    red, green, blue = values.tolist()
    return red, green, blue


def _weight(female: float, old: float, much: float) -> dict[str, float]:
    """Thinner (negative) or heavier than the average weight."""
    kind = f"macrodetails/universal-{'female' if female > 0.5 else 'male'}-{'old' if old > 0.5 else 'young'}"
    end = "maxweight" if much > 0 else "minweight"
    return {f"{kind}-averagemuscle-{end}": abs(much), f"{kind}-averagemuscle-averageweight": -abs(much)}
