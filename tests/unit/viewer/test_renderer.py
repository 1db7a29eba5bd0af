"""The renderer in a framebuffer of the test's: light, shadow, and where it draws."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fapstream.fap import ANGLE_UNIT_RAD
from fapstream.head.mesh import Head, Material, Turn
from fapstream.viewer.camera import View
from fapstream.viewer.canvas import Canvas
from fapstream.viewer.graphics import open_context
from fapstream.viewer.look import load_look
from fapstream.viewer.renderer import Renderer
from tests.unit.head.packaged import packaged
from tests.unit.viewer.heads import face, square, squares

SIZE = (64, 64)
KEY = np.asarray(load_look().settings["defines"]["KEY_FROM"], float)
GREY = Material("grey", color=(0.5, 0.5, 0.5, 1.0), roughness=1.0, double_sided=True)


def drawn(head: Head, values: np.ndarray | None = None, view: View | None = None) -> np.ndarray:
    """Linear enough: uint8 as int (64, 64, 4), top row first."""
    context = open_context()
    renderer, canvas = Renderer(context, head), Canvas(context, SIZE, 0)
    renderer.deform(face() if values is None else values)
    renderer.draw(canvas.framebuffer, view or View(), backdrop=False)
    data = np.frombuffer(canvas.framebuffer.read(components=4), np.uint8).reshape(64, 64, 4)[::-1].astype(int)
    context.release()
    return data


def test_what_stands_in_the_light_throws_a_shadow() -> None:
    """The same picture without the caster is brighter behind it, and only there."""
    wall = square("skin", 0.0, 0.15, GREY)
    caster = square("hair", 0.0, 0.02, GREY)
    moved = replace(caster, positions=caster.positions + np.float32(0.08 * KEY / np.linalg.norm(KEY)))
    plain, shaded = drawn(squares(wall)), drawn(squares(wall, moved))
    darker = (plain - shaded)[..., :3].sum(axis=2)
    assert darker[30:34, 30:34].min() > 20, "the middle of the wall lies in the caster's shadow"
    assert abs(darker[8:20, 8:20]).max() < 6, "far from it nothing changes"


def test_light_comes_from_the_side_of_the_key() -> None:
    """Of two upright squares turned to the left and to the right the one that faces the key is brighter."""
    left, right = (turned(square("shirt", 0.0, 0.08, GREY), angle) for angle in (-50, 50))
    brightness = [drawn(squares(part))[32, 32, :3].sum() for part in (left, right)]
    assert (brightness[1] > brightness[0]) == (KEY[0] > 0)


def turned(part, degrees: float):  # type: ignore[no-untyped-def]
    """About the upright axis; positive turns it to +x."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    matrix = np.float32([[c, 0, s], [0, 1, 0], [-s, 0, c]])
    return replace(part, positions=part.positions @ matrix.T, normals=part.normals @ matrix.T)


def test_backs_are_drawn_only_of_two_sided_materials() -> None:
    behind = View(yaw=180)
    for double in (True, False):
        head = squares(square("shirt", 0.0, 0.1, replace(GREY, double_sided=double)))
        assert bool(drawn(head, view=behind)[32, 32, 3]) is double


def test_light_is_lost_towards_the_back_of_the_mouth() -> None:
    """Of two walls the one behind the lips is darker, just as much when the head has turned."""
    yaw = Turn((49,), ((0.0, 1.0, 0.0),), None, (0.0, 0.0, 0.0))

    def share(degrees: float) -> float:
        values = face(f49=np.radians(degrees) / ANGLE_UNIT_RAD)
        heads = [replace(squares(square("mouth", z, 0.15, GREY)), turns=(yaw,)) for z in (0.0, -0.08)]
        front, behind = (drawn(head, values)[32, 32, :3].sum() for head in heads)
        return float(behind / front)

    assert share(0) < 0.5
    assert share(50) == pytest.approx(share(0), rel=0.1)


def test_what_is_shown_does_not_depend_on_what_was() -> None:
    """Only parts that moved are sent to the card, those that go back to rest among them."""
    context = open_context()
    renderer, canvas = Renderer(context, packaged()), Canvas(context, SIZE, 0)

    def shown(values: np.ndarray) -> bytes:
        renderer.deform(values)
        renderer.draw(canvas.framebuffer)
        return canvas.framebuffer.read(components=4)

    faces = [face(), face(f49=20_000, f3=300), face(f5=-300, f23=9000)]
    first = [shown(values) for values in faces]
    assert len(set(first)) == 3
    assert [shown(values) for values in reversed(faces)] == first[::-1]
    context.release()


def test_it_draws_where_the_viewport_says() -> None:
    context = open_context()
    renderer = Renderer(context, squares(square("shirt", 0.0, 0.1, GREY)))
    target = context.framebuffer([context.renderbuffer((96, 64), 4)], context.depth_renderbuffer((96, 64)))
    target.viewport = (32, 0, 64, 64)
    renderer.deform(face())
    renderer.draw(target, backdrop=False)
    target.viewport = (0, 0, 96, 64)
    alpha = np.frombuffer(target.read(components=4), np.uint8).reshape(64, 96, 4)[..., 3]
    assert alpha[32, 50:78].min() == 255
    assert alpha[:, :47].max() == 0
    context.release()
