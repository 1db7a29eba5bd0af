"""What is behind the head: the gradient of look.json, as the web client's style sheet has it."""

from __future__ import annotations

from typing import Any

import numpy as np

from fapstream.viewer.look import VERSION, Look

WIDTH, HEIGHT = 1.2, 0.9
"""Radii of the ellipse at which the last colour is reached, as shares of the picture."""
CENTRE = (0.5, 0.32)
"""From the left and from the top."""

VERTEX = """
out vec2 spot;
void main() {
  vec2 corner = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
  spot = 0.5 + 0.5 * vec2(corner.x, -corner.y);
  gl_Position = vec4(corner, 1.0, 1.0);
}
"""
FRAGMENT = """
uniform vec4 stops[STOPS];
uniform vec4 ellipse;
in vec2 spot;
out vec4 color;
void main() {
  float r = length((spot - ellipse.xy) / ellipse.zw);
  vec3 c = stops[0].rgb;
  for (int i = 1; i < STOPS; i++) {
    float share = (r - stops[i - 1].a) / (stops[i].a - stops[i - 1].a);
    c = mix(c, stops[i].rgb, clamp(share, 0.0, 1.0));
  }
  color = vec4(c, 1.0);
}
"""


class Backdrop:
    """Fills the framebuffer in use."""

    def __init__(self, context: Any, look: Look) -> None:
        stops = [(*colour(name), float(place)) for name, place in look.settings["background"]]
        head = VERSION + f"#define STOPS {len(stops)}\n"
        self._context = context
        self._program = context.program(vertex_shader=head + VERTEX, fragment_shader=head + FRAGMENT)
        self._program["stops"].write(np.array(stops, "f4").tobytes())
        self._program["ellipse"].value = (*CENTRE, WIDTH, HEIGHT)
        self._vertices = context.vertex_array(self._program, [])

    def draw(self) -> None:
        """Leaves depth as it is."""
        self._context.enable_only(self._context.NOTHING)
        self._vertices.render(vertices=3)


def colour(name: str) -> tuple[float, float, float]:
    """sRGB components, 0 to 1, of a colour such as `#cfd7de`."""
    r, g, b = bytes.fromhex(name.lstrip("#"))
    return r / 255, g / 255, b / 255
