"""One head on OpenGL 3.3: deform, shadow, draw. Knows nothing of time, turns or windows."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from fapstream.head.deform import Values
from fapstream.head.deformer import Deformer, head_turn
from fapstream.head.mesh import Head
from fapstream.viewer.backdrop import Backdrop
from fapstream.viewer.camera import PORTRAIT, Lens, Matrix, View, lens
from fapstream.viewer.graphics import SHADOW_UNIT, Drawn, Programs, column_major, textures_of, write
from fapstream.viewer.look import Look, load_look
from fapstream.viewer.shadow import Shadow


class Renderer:
    """Draws `head` into framebuffers of a moderngl context."""

    def __init__(self, context: Any, head: Head, thrifty: bool = False, look: Look | None = None) -> None:
        self.context, self.head = context, head
        self._look = look or load_look()
        self._deformer = Deformer(head)
        programs = Programs(context, self._look)
        self._shadow = Shadow(programs, head, thrifty)
        self._backdrop = Backdrop(context, self._look)
        pictures = textures_of(context, head)
        order = sorted(self._deformer.shapes, key=lambda s: self._look.layer(s.part.name, s.part.material))
        self._drawn = [Drawn(programs, shape, head, pictures, thrifty) for shape in order]
        self._rest: Matrix = np.eye(4)

    def deform(self, values: Values) -> None:
        """Take the face that the FAPs (68,), FAP n at n-1, describe."""
        self._deformer.apply(values)
        self._rest[:] = np.linalg.inv(head_turn(self.head, values))
        for drawn in self._drawn:
            if drawn.shape.part.name in self._deformer.moved:
                drawn.upload()

    def draw(self, target: Any, view: View | Lens = PORTRAIT, backdrop: bool = True) -> None:
        """Draw the face into the framebuffer `target`, as a portrait or through a lens of one's own; without
        `backdrop` on nothing (alpha 0).
        """
        self._shadow.draw(self._drawn)
        target.use()
        width, height = target.viewport[2:]
        target.clear(0.0, 0.0, 0.0, 0.0, depth=1.0)
        if backdrop:
            self._backdrop.draw()
        camera = view if isinstance(view, Lens) else self._portrait(width / height, view)
        self._shadow.texture.use(SHADOW_UNIT)
        gl = self.context
        gl.enable(gl.DEPTH_TEST | gl.BLEND)
        gl.blend_func = gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA, gl.ONE, gl.ONE_MINUS_SRC_ALPHA
        for drawn in self._drawn:
            self._aim(drawn, camera.view, camera.projection, camera.position)
            target.depth_mask = drawn.shape.part.material.alpha != "BLEND"
            drawn.draw()
        target.depth_mask = True

    def _portrait(self, aspect: float, view: View) -> Lens:
        return lens(self.head.camera, self._look.fov, aspect, view)

    def _aim(self, drawn: Drawn, view: Matrix, projection: Matrix, position: NDArray[np.float64]) -> None:
        program = drawn.program
        write(program, "viewMatrix", column_major(view))
        write(program, "projectionMatrix", column_major(projection))
        write(program, "cameraPosition", position.astype("f4").tobytes())
        write(program, "rest", column_major(self._rest))
        write(program, "shadowMatrix", column_major(self._shadow.matrix))
