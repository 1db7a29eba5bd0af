"""Renders a head file with given FAP values to a PNG, without a display (EGL).

python tools/render_head.py --fap 3=400 --fap 5=-300 --yaw 30 --out face.png
"""

from __future__ import annotations

import argparse
import io
from dataclasses import dataclass
from pathlib import Path

import moderngl
import numpy as np
from PIL import Image as Picture

from fapstream.head.deform import deform
from fapstream.head.gltf import read_head
from fapstream.head.mesh import Head, Part

GENERIC = Path(__file__).parents[1] / "fapstream/assets/heads/generic.glb"
BACKGROUND = (0.80, 0.835, 0.86)

VERTEX = """
#version 330
uniform mat4 view, projection;
in vec3 position, normal; in vec2 uv;
out vec3 at, n; out vec2 t;
void main() { vec4 p = view * vec4(position, 1.0); at = p.xyz; n = mat3(view) * normal; t = uv;
              gl_Position = projection * p; }
"""

FRAGMENT = """
#version 330
uniform sampler2D picture; uniform bool textured; uniform vec4 color;
uniform float roughness, cutoff; uniform bool flip;
in vec3 at, n; in vec2 t; out vec4 result;
const vec3 towards[3] = vec3[](vec3(-0.45, 0.55, 0.75), vec3(0.75, 0.15, 0.55), vec3(0.3, 0.6, -0.85));
const vec3 light[3] = vec3[](vec3(2.3, 2.22, 2.1), vec3(0.75, 0.8, 0.9), vec3(1.0, 1.0, 1.05));
vec3 tone(vec3 c) { return clamp((c * (2.51 * c + 0.03)) / (c * (2.43 * c + 0.59) + 0.14), 0.0, 1.0); }
void main() {
  vec4 base = color;
  if (textured) { vec4 p = texture(picture, t); base *= vec4(pow(p.rgb, vec3(2.2)), p.a); }
  if (base.a < cutoff) discard;
  vec3 v = normalize(-at), m = normalize(n);
  if (flip && !gl_FrontFacing) m = -m;
  vec3 sum = base.rgb * mix(vec3(0.30, 0.27, 0.26), vec3(0.62, 0.64, 0.68), m.y * 0.5 + 0.5);
  float a = roughness * roughness, a2 = a * a;
  for (int i = 0; i < 3; i++) {
    vec3 l = normalize(towards[i]), h = normalize(l + v);
    float nl = max(dot(m, l), 0.0), nv = max(dot(m, v), 1e-3), nh = max(dot(m, h), 0.0);
    float d = a2 / (3.14159 * pow(nh * nh * (a2 - 1.0) + 1.0, 2.0));
    float g = 0.5 / (nl * sqrt(nv * nv * (1.0 - a2) + a2) + nv * sqrt(nl * nl * (1.0 - a2) + a2) + 1e-4);
    float f = 0.04 + 0.96 * pow(1.0 - max(dot(v, h), 0.0), 5.0);
    sum += light[i] * nl * (base.rgb / 3.14159 * (1.0 - f) + vec3(d * g * f));
  }
  result = vec4(pow(tone(sum * 1.05), vec3(1.0 / 2.2)), base.a);
}
"""


@dataclass(frozen=True)
class View:
    """Where the picture is taken from: degrees, and how many times closer than the portrait."""

    yaw: float = 0.0
    pitch: float = 0.0
    zoom: float = 1.0
    mouth: bool = False


class Renderer:
    """One head, many pictures."""

    def __init__(self, head: Head, size: int) -> None:
        self.head, self.size = head, size
        self.context = moderngl.create_context(standalone=True, backend="egl")
        self.program = self.context.program(vertex_shader=VERTEX, fragment_shader=FRAGMENT)
        pixels = (size * 2, size * 2)
        self.target = self.context.framebuffer(
            [self.context.texture(pixels, 4)], self.context.depth_renderbuffer(pixels)
        )
        self.textures = {part.name: self._texture(part) for part in head.parts}

    def picture(self, values: np.ndarray, view: View) -> Picture.Image:
        """The face under one FAP frame int16 (68,)."""
        self.target.use()
        self.context.enable(moderngl.DEPTH_TEST | moderngl.BLEND)
        self.target.clear(*BACKGROUND, 1.0, depth=1.0)
        self._camera(view)
        positions = deform(self.head, values)
        for part in sorted(self.head.parts, key=lambda p: p.material.alpha == "BLEND"):
            self._draw(part, positions[part.name])
        data = self.target.read(components=3)
        image = Picture.frombytes("RGB", (self.size * 2, self.size * 2), data)
        return image.transpose(Picture.Transpose.FLIP_TOP_BOTTOM).resize(
            (self.size, self.size), Picture.Resampling.LANCZOS
        )

    def _texture(self, part: Part) -> moderngl.Texture | None:
        if part.material.texture is None:
            return None
        image = Picture.open(io.BytesIO(part.material.texture.data)).convert("RGBA")
        texture = self.context.texture(image.size, 4, image.tobytes())
        texture.build_mipmaps()
        texture.anisotropy = 8.0
        return texture

    def _camera(self, view: View) -> None:
        camera = self.head.camera
        target = np.array(self.head.mouth.center if view.mouth else camera.target)
        distance, height = 0.95, camera.height / view.zoom
        yaw, pitch = np.radians(-view.yaw), np.radians(view.pitch)
        matrix = np.eye(4)
        about_y = np.array([[np.cos(yaw), 0, np.sin(yaw)], [0, 1, 0], [-np.sin(yaw), 0, np.cos(yaw)]])
        about_x = np.array([[1, 0, 0], [0, np.cos(pitch), -np.sin(pitch)], [0, np.sin(pitch), np.cos(pitch)]])
        matrix[:3, :3] = about_x @ about_y
        matrix[:3, 3] = -matrix[:3, :3] @ target + (0, 0, -distance)
        near, far, focal = 0.1, 3.0, 2 * distance / height
        projection = np.zeros((4, 4))
        projection[0, 0] = projection[1, 1] = focal
        projection[2, 2], projection[2, 3] = (far + near) / (near - far), 2 * far * near / (near - far)
        projection[3, 2] = -1
        self.program["view"].write(matrix.T.astype("f4").tobytes())
        self.program["projection"].write(projection.T.astype("f4").tobytes())

    def _draw(self, part: Part, positions: np.ndarray) -> None:
        material, texture, program = part.material, self.textures[part.name], self.program
        program["textured"] = texture is not None
        if texture is not None:
            texture.use(0)
        program["color"] = material.color
        program["roughness"] = material.roughness
        program["cutoff"] = material.cutoff if material.alpha == "MASK" else 0.0
        program["flip"] = material.double_sided
        if material.double_sided:
            self.context.disable(moderngl.CULL_FACE)
        else:
            self.context.enable(moderngl.CULL_FACE)
        rows = np.hstack([positions, welded_normals(part, positions), part.uvs]).astype("f4")
        vertices = self.context.buffer(rows.tobytes())
        indices = self.context.buffer(part.triangles.astype("u4").tobytes())
        array = self.context.vertex_array(
            program, [(vertices, "3f 3f 2f", "position", "normal", "uv")], indices
        )
        array.render()
        for thing in (array, vertices, indices):
            thing.release()


def welded_normals(part: Part, positions: np.ndarray) -> np.ndarray:
    """Normals (n, 3) from the triangles, shared by vertices that coincide at rest."""
    _, group = np.unique(part.positions, axis=0, return_inverse=True)
    group = group.ravel()
    a, b, c = (positions[part.triangles[:, k]] for k in range(3))
    face = np.cross(b - a, c - a)
    total = np.zeros((int(group.max()) + 1, 3))
    for k in range(3):
        np.add.at(total, group[part.triangles[:, k]], face)
    normals = total[group]
    return normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)


def fap_frame(settings: list[str]) -> np.ndarray:
    """int16 (68,) from `fap=value` strings."""
    values = np.zeros(68, np.int16)
    for setting in settings:
        fap, _, value = setting.partition("=")
        values[int(fap) - 1] = int(value)
    return values


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--head", type=Path, default=GENERIC)
    parser.add_argument("--fap", action="append", default=[], metavar="N=VALUE")
    parser.add_argument("--yaw", type=float, default=0.0, help="camera to the subject's left, degrees")
    parser.add_argument("--pitch", type=float, default=0.0)
    parser.add_argument("--zoom", type=float, default=1.0)
    parser.add_argument("--mouth", action="store_true", help="look at the mouth rather than the portrait")
    parser.add_argument("--size", type=int, default=512)
    parser.add_argument("--out", type=Path, required=True)
    options = parser.parse_args()
    head = read_head(options.head.read_bytes(), str(options.head))
    view = View(options.yaw, options.pitch, options.zoom, options.mouth)
    Renderer(head, options.size).picture(fap_frame(options.fap), view).save(options.out)


if __name__ == "__main__":
    main()
