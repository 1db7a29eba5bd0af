"""The light's view."""

from __future__ import annotations

import numpy as np
import pytest

from fapstream.head.deformer import Deformer
from fapstream.head.mesh import Camera, Material
from fapstream.viewer.graphics import Drawn, Programs, open_context
from fapstream.viewer.look import load_look
from fapstream.viewer.shadow import Shadow, shadow_matrix
from tests.unit.viewer.heads import square, squares

LOOK = load_look()
CAMERA = Camera((0.01, -0.02, 0.03), 0.4)
REACH = 0.4 * LOOK.settings["shadow"]["reach"]


def test_the_target_is_in_the_middle_and_the_light_looks_along_its_way() -> None:
    matrix = shadow_matrix(CAMERA, LOOK)
    towards = np.asarray(LOOK.settings["defines"]["KEY_FROM"])
    towards = towards / np.linalg.norm(towards)
    target = np.asarray(CAMERA.target)
    assert matrix @ [*target, 1] == pytest.approx([0, 0, 0, 1])
    nearer = matrix @ [*(target + REACH * towards), 1]
    assert nearer == pytest.approx([0, 0, -1, 1]), "what is nearer to the light has less depth"
    assert np.linalg.det(matrix[:3, :3]) == pytest.approx(-(REACH**-3)), "depth grows away from the light"


def test_only_casters_are_in_the_map_where_the_matrix_puts_them() -> None:
    context = open_context()
    head = squares(
        square("skin", 0.0, 0.02, Material("s", double_sided=True)),
        square("cornea_l", 0.05, 0.2, Material("c", double_sided=True)),
    )
    programs = Programs(context, LOOK)
    drawn = [Drawn(programs, shape, head, {}) for shape in Deformer(head).shapes]
    shadow = Shadow(programs, head)
    shadow.draw(drawn)
    size = shadow.texture.size[0]
    depth = np.frombuffer(shadow.texture.read(), "f4").reshape(size, size)
    assert depth[size // 2, size // 2] == pytest.approx(0.5, abs=1e-3)
    covered = (depth < 1).mean()
    towards = np.asarray(LOOK.settings["defines"]["KEY_FROM"])
    facing = abs(towards[2]) / np.linalg.norm(towards)
    radius = head.camera.height * LOOK.settings["shadow"]["reach"]
    assert covered == pytest.approx(0.04**2 * facing / (2 * radius) ** 2, rel=0.05)
    context.release()
