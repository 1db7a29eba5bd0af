"""p, b, m close the lips, f, v touch the teeth: between all vowels, under every expression, on every head.

Measured on the deformed head: the slit is the height between the lowest point of the upper lip and the
highest of the lower lip, in columns round the middle, as seen from the front.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache
from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from fapstream.fap import EXPRESSIONS, expressions, visemes
from fapstream.head.deform import deform
from fapstream.head.mesh import Head
from fapstream.motion import closure
from fapstream.motion.idle import Idle, Look
from fapstream.motion.mixer import Mouth, Streams, mix
from fapstream.motion.mouths import DEFAULT_MODEL, MODELS, Model, Motion, mouth_track
from fapstream.records import SILENCE, Phone
from fapstream.tts import LANGUAGES, phone_set
from tests.unit.adapt.persons import NAMES as PERSONS
from tests.unit.adapt.persons import adapted
from tests.unit.fakes import timed
from tests.unit.head.packaged import NAMES, packaged

HEADS = (*NAMES, *PERSONS)
"""Those of the package, and some that were adapted to photos."""
SPEAKERS = pytest.mark.parametrize(
    ("name", "model"),
    [*((name, DEFAULT_MODEL) for name in HEADS), *((HEADS[0], m) for m in MODELS if m != DEFAULT_MODEL)],
)
"""The mouth that users get on every head, the others on one."""
RATE, FPS = 16000, 25
AHEAD = Idle(0.0, Look(0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
MOODS = (None, *EXPRESSIONS)
SOME = 3
LENGTHS_MS = (25.0, 40.0, 60.0, 90.0)

MOST_SLIT = 0.01
"""Of MW0: what counts as closed."""
MOST_PRESSED_M = 0.003
"""Lips are soft; deeper into each other would be seen."""
MOST_FROM_TEETH_M = 0.0006
NEAR_M = 0.0006
"""Points of the teeth are no further apart."""
MOST_BITTEN_M = 0.0015
"""How far the lower lip may be off the edge of the upper teeth, or yield to it."""


@dataclass(frozen=True)
class Lips:
    """Lips and upper incisors of one head, which has no other parts."""

    head: Head
    upper: NDArray[np.intp]
    lower: NDArray[np.intp]
    inside: dict[str, NDArray[np.intp]]
    """Triangles (n, 3) of the lower lip and its inner side, by part."""
    teeth: NDArray[np.float64]
    """Points (n, 3) on the lowest 3 mm of the upper incisors, metres."""
    near: cKDTree
    """Of the teeth."""

    def slit(self, values: NDArray[np.int16]) -> NDArray[np.float64]:
        """How far the lips are apart in each column, metres; negative where they are pressed together."""
        skin, width = deform(self.head, values)["skin"], self.head.fapu.mw0
        upper, lower = skin[self.upper], skin[self.lower]
        near = 0.05 * width
        return np.array(
            [
                upper[np.abs(upper[:, 0] - x) < near, 1].min()
                - lower[np.abs(lower[:, 0] - x) < near, 1].max()
                for x in np.linspace(-0.25, 0.25, 11) * width
            ]
        )

    def bite(self, values: NDArray[np.int16]) -> tuple[float, float]:
        """How near the lower lip comes to the upper incisors, and how deep it is in them, metres."""
        positions = deform(self.head, values)
        lip = np.vstack([_spread(positions[part][t]) for part, t in self.inside.items()])
        between = (lip > self.teeth.min(axis=0) - NEAR_M) & (lip < self.teeth.max(axis=0) + NEAR_M)
        deepest = max(map(self._depth, lip[between.all(axis=1)]), default=0.0)
        return float(self.near.query(lip)[0].min()), deepest

    def _depth(self, point: NDArray[np.float64]) -> float:
        """The shortest way out of the teeth for a point of the lip: forward, back or down. 0 outside."""
        off = np.abs(self.teeth - point) < NEAR_M
        across, over = self.teeth[off[:, 0] & off[:, 1], 2], self.teeth[off[:, 0] & off[:, 2], 1]
        if not across.size or not over.size:
            return 0.0
        ways = across.max() - point[2], point[2] - across.min(), point[1] - over.min()
        return max(0.0, float(min(ways)))


def _spread(triangles: NDArray[np.float64]) -> NDArray[np.float64]:
    """Points all over triangles (n, 3, 3)."""
    weights = [(a, b, 4 - a - b) for a in range(5) for b in range(5 - a)]
    return np.einsum("kc,ncd->nkd", np.array(weights) / 4, triangles).reshape(-1, 3)


@cache
def lips(name: str) -> Lips:
    whole = adapted(name) if name in PERSONS else packaged(name)
    parts = tuple(p for p in whole.parts if p.name in ("skin", "mouth"))
    names = [p.name for p in parts]
    head = replace(whole, parts=parts, fat=tuple(e for e in whole.fat if e.part in names), turns=())
    up, down = _moved(head, (4, 8, 9)), _moved(head, (5, 10, 11))
    rest, most = head.part("skin").positions.astype(np.float64), 200 / 1024 * head.fapu.mns0
    middle = np.abs(rest[:, 0] - head.mouth.center[0]) < 0.3 * head.fapu.mw0
    upper = middle & (-up["skin"] > 0.6 * most) & (np.abs(up["skin"]) > np.abs(down["skin"]))
    lower = middle & (down["skin"] > 0.6 * most) & (np.abs(down["skin"]) > np.abs(up["skin"]))
    inside = {}
    for part in parts:
        lip = (down[part.name] > 0.3 * most) & (np.abs(part.positions[:, 0]) < 0.007)
        inside[part.name] = part.triangles[lip[part.triangles].all(axis=1)].astype(np.intp)
    teeth = _incisors(whole)
    return Lips(head, np.flatnonzero(upper), np.flatnonzero(lower), inside, teeth, cKDTree(teeth))


def _incisors(head: Head) -> NDArray[np.float64]:
    part, tip = head.part("teeth_upper"), np.array(head.fdp["9.10"])
    points = _spread(part.positions[part.triangles].astype(np.float64))
    there = (np.abs(points[:, 0]) < 0.007) & (np.abs(points[:, 1] - tip[1] - 0.0013) < 0.0017)
    return points[there]


@cache
def slit_of(name: str, face: bytes) -> NDArray[np.float64]:
    return lips(name).slit(np.frombuffer(face, np.int16))


@cache
def bite_of(name: str, face: bytes) -> tuple[float, float]:
    return lips(name).bite(np.frombuffer(face, np.int16))


def _moved(head: Head, faps: tuple[int, ...]) -> dict[str, NDArray[np.float64]]:
    """How far up these FAPs at 200 move each vertex, metres, by part."""
    values = np.zeros(68, np.int16)
    values[np.array(faps) - 1] = 200
    moved = deform(head, values)
    return {part.name: moved[part.name][:, 1] - part.positions[:, 1] for part in head.parts}


def _face(mouth: Mouth, mood: str | None) -> bytes:
    """What is shown, int16 (68,), as bytes so that equal faces are measured once."""
    nothing = np.zeros(68)
    felt = expressions()[mood] if mood else nothing
    return np.rint(mix(Streams(mouth, felt, nothing, AHEAD))).astype(np.int16).tobytes()


@cache
def spoken(model: Model, lang: str, closing: str, seal: bool) -> tuple[Mouth, ...]:
    """The mouth at the frame of contact between any two vowels, whatever the lengths; 25 frames a second."""
    vowels = [p for p, i in phone_set(lang).items() if i.kind == "vowel"]
    found = []
    for k, (before, after) in enumerate(product(vowels, vowels)):
        lead, length = 40 + 7.3 * (k % 9), LENGTHS_MS[k % len(LENGTHS_MS)]
        phones = timed(
            [Phone(SILENCE, lead), Phone(before, 90.0, stress=1), Phone(closing, length),
             Phone(after, 80.0, stress=1), Phone(SILENCE, 200.0)], RATE,
        )  # fmt: skip
        track = mouth_track(Motion(model), lang, RATE, FPS)
        for phone in phones:
            track.add(phone)
        faces = track.at(np.arange(0, phones[-1].end, RATE // FPS))
        mouths = [
            replace(faces, values=v, speaks=a, seal=s, bite=b)
            for v, a, s, b in zip(faces.values, faces.speaks, faces.seal, faces.bite, strict=True)
        ]
        found.append(max(mouths, key=lambda m: m.seal if seal else m.bite))
    return tuple(found)


def faces_of(name: str, mouths: tuple[Mouth, ...]) -> set[bytes]:
    """A few of the mouths, others for each head, under all expressions: all are too many to be measured."""
    first = HEADS.index(name)
    some = [mouths[(first + k * len(mouths) // SOME) % len(mouths)] for k in range(SOME)]
    return {_face(mouth, mood) for mouth, mood in product(some, MOODS)}


@SPEAKERS
@pytest.mark.parametrize("lang", LANGUAGES)
@pytest.mark.parametrize("closing", ["p", "b", "m"])
def test_lips_close_between_all_vowels_under_all_expressions(
    model: Model, closing: str, lang: str, name: str
) -> None:
    most = MOST_SLIT * lips(name).head.fapu.mw0
    faces = faces_of(name, spoken(model, lang, closing, True))
    for face in faces:
        slit = slit_of(name, face)
        assert slit.max() < most
        assert slit.min() > -MOST_PRESSED_M


@SPEAKERS
@pytest.mark.parametrize("lang", LANGUAGES)
@pytest.mark.parametrize("closing", ["f", "v"])
def test_the_lip_touches_the_teeth_between_all_vowels_under_all_expressions(
    model: Model, closing: str, lang: str, name: str
) -> None:
    faces = faces_of(name, spoken(model, lang, closing, False))
    for face in faces:
        near, deep = bite_of(name, face)
        assert near < MOST_FROM_TEETH_M
        assert deep < MOST_BITTEN_M
        assert slit_of(name, face)[4:7].min() > 0.0005, "the upper lip keeps clear, the teeth are seen"


@pytest.mark.parametrize("name", HEADS)
def test_the_measure_sees_an_open_mouth_and_a_mood_that_would_break_the_closure(name: str) -> None:
    head = lips(name)
    wide = np.frombuffer(_face(Mouth(visemes()[10], 1.0), None), np.int16)
    assert head.slit(wide).max() > 0.15 * head.head.fapu.mw0
    broken = (visemes()[1] + expressions()["surprise"] * 0.3).astype(np.int16)
    assert head.slit(broken).max() > MOST_SLIT * head.head.fapu.mw0


FRAME = st.lists(st.floats(-600, 600), min_size=68, max_size=68).map(np.array)


@given(FRAME)
def test_seal_sets_the_distance_and_keeps_what_the_lips_do_together(values: NDArray[np.float64]) -> None:
    shown = values.copy()
    closure.seal(shown, 1.0)
    upper, lower = closure.UPPER[closure.VERTICAL], closure.LOWER[closure.VERTICAL]
    wanted = visemes()[1]
    assert shown[upper] + shown[lower] == pytest.approx(wanted[upper] + wanted[lower])
    corners = np.array([6, 7, 12, 13, 53, 54, 59, 60]) - 1
    assert np.array_equal(shown[corners], values[corners])
    assert shown[16] - shown[15] == pytest.approx(wanted[16] - wanted[15])
    again = shown.copy()
    closure.seal(again, 1.0)
    assert again == pytest.approx(shown)


@given(FRAME, st.floats(0, 1))
def test_rules_come_and_go_gradually(values: NDArray[np.float64], share: float) -> None:
    for rule in (closure.seal, closure.bite):
        none, some, whole = values.copy(), values.copy(), values.copy()
        rule(none, 0.0)
        rule(some, share)
        rule(whole, 1.0)
        assert none == pytest.approx(values)
        assert some == pytest.approx(values + share * (whole - values), abs=1e-6)


@given(FRAME)
def test_lips_never_go_through_each_other(values: NDArray[np.float64]) -> None:
    upper, lower = closure.UPPER[closure.VERTICAL], closure.LOWER[closure.VERTICAL]
    pressed = visemes()[1][upper] + visemes()[1][lower]
    shown = values.copy()
    closure.part(shown)
    assert (shown[upper] + shown[lower] <= pressed + 1e-6).all()
    apart = values[upper] + values[lower] <= pressed
    assert np.array_equal(shown[upper][apart], values[upper][apart])
