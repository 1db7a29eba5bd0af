"""The key light's view of the head, drawn before each picture: what it does not see lies in shadow."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from fapstream.head.mesh import Camera, Head
from fapstream.viewer.camera import Matrix
from fapstream.viewer.graphics import MAP_UNIT, Drawn, Programs, column_major, cutoff, write
from fapstream.viewer.look import Look


class Shadow:
    """`texture` is the depth from the light; `matrix` leads from the head to the light's clip space."""

    def __init__(self, programs: Programs, head: Head, thrifty: bool = False) -> None:
        context, look = programs.context, programs.look
        size = int(look.settings["shadow"]["thriftySize" if thrifty else "size"])
        self._context, self._programs = context, programs
        self.matrix = shadow_matrix(head.camera, look)
        self.texture = context.depth_texture((size, size))
        self.texture.compare_func = "<="
        self.texture.filter = (context.LINEAR, context.LINEAR)
        self.texture.repeat_x = self.texture.repeat_y = False
        self._target = context.framebuffer(depth_attachment=self.texture)
        self._casts: dict[str, Any] = {}

    def draw(self, parts: Sequence[Drawn]) -> None:
        """The depth of all parts that throw shadows, where they are now."""
        self._target.use()
        self._target.clear(depth=1.0)
        self._context.enable_only(self._context.DEPTH_TEST)
        for part in parts:
            name, material = part.shape.part.name, part.shape.part.material
            if name.startswith(self._programs.look.casters) and material.alpha != "BLEND":
                if name not in self._casts:
                    self._casts[name] = self._cast(part)
                if part.map:
                    part.map.use(MAP_UNIT)
                part.cull()
                self._casts[name].render()

    def _cast(self, part: Drawn) -> Any:
        defines = cutoff(part.shape.part.material) if part.map else {}
        program = self._programs.get("shadow", defines)
        write(program, "shadowMatrix", column_major(self.matrix))
        return part.vertices(program)


def shadow_matrix(camera: Camera, look: Look) -> Matrix:
    """4x4, along the key light, for a sphere of `reach` portrait heights round what the camera looks at."""
    radius = look.settings["shadow"]["reach"] * camera.height
    towards = np.asarray(look.settings["defines"]["KEY_FROM"], float)
    towards /= np.linalg.norm(towards)
    side = np.cross((0.0, 1.0, 0.0), towards)
    side /= np.linalg.norm(side)
    axes = np.array([side, np.cross(towards, side), -towards])
    matrix = np.eye(4)
    matrix[:3, :3] = axes / radius
    matrix[:3, 3] = -axes @ np.asarray(camera.target) / radius
    return matrix
