"""What each photo tells of the skin."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from fapstream.adapt.layers import SPREADS, Canvas, seen, skinlike, smoothstep, without_light
from tests.unit.adapt.painted import BACKDROP, PERSON, photographed, plain
from tests.unit.adapt.persons import adapted
from tests.unit.head.packaged import packaged

HIDING = ("skin", "eye_l", "eye_r")


@cache
def canvas() -> Canvas:
    return Canvas.of(adapted(PERSON).part("skin"), packaged().part("skin"), 512)


def parts() -> dict[str, object]:
    return {name: adapted(PERSON).part(name) for name in HIDING}


def test_texels_know_where_they_are() -> None:
    skin = adapted(PERSON).part("skin")
    assert len(canvas().places) > 0.6 * 512**2
    assert np.abs(np.linalg.norm(canvas().normals, axis=1) - 1).max() < 1e-3
    for vertex in range(0, len(skin.positions), 371):
        u, v = skin.uvs[vertex] * 512
        at = int(v) * 512 + int(u)
        texel = np.flatnonzero(canvas().hits.pixels == at)
        if len(texel) and 0 <= u < 512:
            assert np.linalg.norm(canvas().places[texel[0]] - skin.positions[vertex]) < 6e-3
    picture = canvas().picture(canvas().home)
    assert np.array_equal(canvas().texels(picture), canvas().home.astype(np.float32))


@pytest.mark.parametrize("view", ["front", "profile"])
def test_what_a_photo_shows_is_put_where_it_is(view: str) -> None:
    layer = seen(canvas(), photographed(plain)[view], parts())  # type: ignore[arg-type]
    sure = layer.trust > 0.9
    assert sure.mean() > 0.1
    off = np.abs(layer.light[sure] - plain(canvas().home[sure])).max(1)
    assert np.quantile(off, 0.95) < 0.03
    away = layer.facing < 0
    assert not layer.trust[away].any(), "the far side is not seen"


def test_one_thing_before_another_hides_it() -> None:
    """In the profile the nose hides nothing, but the near side hides the far one, and lids hide the
    sockets.
    """
    layer = seen(canvas(), photographed(plain)["front"], parts())  # type: ignore[arg-type]
    home = canvas().home
    behind_eyes = (np.abs(np.abs(home[:, 0]) - 0.0285) < 0.006) & (np.abs(home[:, 1] - 0.0385) < 0.002)
    behind_eyes &= home[:, 2] < 0.080
    assert behind_eyes.sum() > 20
    assert layer.trust[behind_eyes].mean() < 0.05


def haired(places: np.ndarray) -> np.ndarray:
    light = plain(places)
    light[places[:, 1] > 0.075] = (0.02, 0.015, 0.01)
    return light


def test_hair_and_backdrop_are_no_skin_but_features_are_kept() -> None:
    light = plain(canvas().home)
    fringe = canvas().home[:, 1] > 0.075
    light[fringe] = (0.02, 0.015, 0.01)
    backdrop = (canvas().home[:, 1] < -0.09) & (canvas().home[:, 2] > 0)
    light[backdrop] = BACKDROP
    brow = np.hypot(np.abs(canvas().home[:, 0]) - 0.032, canvas().home[:, 1] - 0.06) < 0.004
    light[brow] = (0.02, 0.015, 0.01)
    like = skinlike(canvas(), light, np.ones(len(light)), SPREADS)
    assert like[fringe].mean() < 0.1
    assert like[backdrop].mean() < 0.1
    assert like[brow & (canvas().home[:, 2] > 0.07)].mean() > 0.9, "brows belong to the face"
    cheek = np.linalg.norm(canvas().home - (0.035, 0.0, 0.08), axis=1) < 0.012
    assert like[cheek].mean() > 0.9


def test_hair_in_a_photo_is_not_trusted() -> None:
    raw = seen(canvas(), photographed(haired)["front"], parts())  # type: ignore[arg-type]
    layer = without_light(canvas(), raw)
    fringe = (canvas().home[:, 1] > 0.078) & (raw.trust > 0.9)
    face = (np.linalg.norm(canvas().home - (0.03, 0.0, 0.085), axis=1) < 0.015) & (raw.trust > 0.9)
    assert fringe.sum() > 100
    assert layer.trust[fringe].mean() < 0.05
    assert layer.trust[face].mean() > 0.9


def test_smoothstep() -> None:
    assert smoothstep(1.0, 3.0, np.array([0.0, 1, 2, 3, 9])).tolist() == [0, 0, 0.5, 1, 1]
