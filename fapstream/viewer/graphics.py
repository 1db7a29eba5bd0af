"""What a head is on the graphics card: contexts, textures, and the buffers of one part."""

from __future__ import annotations

import importlib
import io
from collections.abc import Mapping
from typing import Any

import numpy as np

from fapstream.errors import DataError, FapstreamError
from fapstream.head.deformer import Shape
from fapstream.head.mesh import Head, Image, Material, Part
from fapstream.viewer.camera import Matrix
from fapstream.viewer.look import Look, Value, define_lines

MAP_UNIT, NORMAL_UNIT, SHADOW_UNIT = range(3)
ANISOTROPY = 4.0
"""Of textures seen at a flat angle; the processor, which would take three times as long, does without."""
MAX_PIXELS = 1 << 26
"""Of one picture in a head file; more is taken for an attack."""


class ViewerUnavailable(FapstreamError):
    """Heads cannot be drawn on this machine."""

    code = "viewer_unavailable"


def open_context() -> Any:
    """A moderngl context without a window (EGL). Raises ViewerUnavailable."""
    moderngl = needed("moderngl")
    try:
        return moderngl.create_context(standalone=True, backend="egl", require=330)
    except Exception as e:  # moderngl raises bare Exceptions
        raise ViewerUnavailable(
            f"no OpenGL 3.3 without a window here ({e}); on Debian: apt install libegl1 libgl1-mesa-dri"
        ) from e


def needed(module: str) -> Any:
    """A module of the extra `viewer`. Raises ViewerUnavailable."""
    try:
        return importlib.import_module(module)
    except ImportError as e:
        raise ViewerUnavailable(f"this needs {module}: pip install 'fapstream[viewer]'") from e


def is_software(context: Any) -> bool:
    """Is it the processor that draws?"""
    name = str(context.info["GL_RENDERER"]).lower()
    return any(word in name for word in ("llvmpipe", "softpipe", "swiftshader", "software"))


def column_major(matrix: Matrix) -> bytes:
    """A 4x4 matrix for column vectors, as GLSL has it."""
    return np.ascontiguousarray(matrix.T, "f4").tobytes()


def write(program: Any, name: str, data: bytes) -> None:
    """Set a uniform, if the program has kept it."""
    if name in program:
        program[name].write(data)


def cutoff(material: Material) -> dict[str, Value]:
    """The define that makes the holes of a masked material."""
    return {"CUTOFF": material.cutoff} if material.alpha == "MASK" else {}


def textures_of(context: Any, head: Head) -> dict[Image, Any]:
    """Every picture of the head once. Raises DataError for one that cannot be read."""
    images = {
        image
        for part in head.parts
        for image in (part.material.texture, part.material.normal)
        if image is not None
    }
    return {image: _texture(context, image, head.name) for image in images}


def _texture(context: Any, image: Image, name: str) -> Any:
    pictures = needed("PIL.Image")
    try:
        with pictures.open(io.BytesIO(image.data)) as opened:
            if opened.width * opened.height > MAX_PIXELS:
                raise ValueError(f"{opened.width} x {opened.height} pixels")
            rgba = opened.convert("RGBA")
    except (OSError, ValueError, SyntaxError, pictures.DecompressionBombError) as e:
        raise DataError(name or "head", None, f"a picture ({image.mime}) cannot be used: {e}") from e
    texture = context.texture(rgba.size, 4, rgba.tobytes())
    texture.build_mipmaps()
    if is_software(context):
        texture.filter = context.LINEAR_MIPMAP_NEAREST, context.LINEAR
    else:
        texture.anisotropy = ANISOTROPY
    return texture


class Programs:
    """Shader programs of a context, each made once: parts of one finish share theirs."""

    def __init__(self, context: Any, look: Look) -> None:
        self.context, self.look = context, look
        self._made: dict[str, Any] = {}

    def get(self, name: str, defines: Mapping[str, Value]) -> Any:
        """The program of `name`.vert and `name`.frag; its textures are bound to the units named here."""
        key = name + define_lines(defines)
        if key not in self._made:
            program = self._made[key] = self.context.program(**self.look.program(name, defines))
            for texture, unit in (("map", MAP_UNIT), ("normalMap", NORMAL_UNIT), ("shadowMap", SHADOW_UNIT)):
                write(program, texture, np.int32(unit).tobytes())
        return self._made[key]


class Drawn:
    """One part with its program, uniforms and buffers."""

    def __init__(
        self, programs: Programs, shape: Shape, head: Head, pictures: dict[Image, Any], thrifty: bool = False
    ) -> None:
        self.shape, self.context = shape, programs.context
        part, material = shape.part, shape.part.material
        self.map = pictures[material.texture] if material.texture else None
        self.normal_map = pictures[material.normal] if material.normal else None
        self.positions = self.context.buffer(shape.positions.tobytes(), dynamic=True)
        self.normals = self.context.buffer(shape.normals.tobytes(), dynamic=True)
        self.uvs = self.context.buffer(np.ascontiguousarray(part.uvs, "f4").tobytes())
        self.indices = self.context.buffer(part.triangles.astype("u4").tobytes())
        finish = programs.look.finish(part.name)
        self.program = programs.get("head", {**finish, **self._defines(thrifty)})
        self._uniforms = _uniforms(part, head, "EYE" in finish)
        self._vertices = self.vertices(self.program)

    def _defines(self, thrifty: bool) -> dict[str, Value]:
        switches = {
            "SHADOW": True,
            "HAS_MAP": self.map is not None,
            "HAS_NORMAL": self.normal_map is not None,
            "THRIFTY": thrifty,
        }
        return {**{k: v for k, v in switches.items() if v}, **cutoff(self.shape.part.material)}

    def vertices(self, program: Any) -> Any:
        """The part's vertices for a program, whichever attributes that has."""
        content = [
            (buffer, f"{width}f", name)
            for buffer, width, name in (
                (self.positions, 3, "position"), (self.normals, 3, "normal"), (self.uvs, 2, "uv"),
            )
            if name in program
        ]  # fmt: skip
        return self.context.vertex_array(program, content, self.indices)

    def upload(self) -> None:
        """The shape has moved."""
        self.positions.write(self.shape.positions)
        self.normals.write(self.shape.normals)

    def draw(self) -> None:
        """With the part's own program, into the framebuffer in use."""
        if self.map:
            self.map.use(MAP_UNIT)
        if self.normal_map:
            self.normal_map.use(NORMAL_UNIT)
        for name, data in self._uniforms.items():
            write(self.program, name, data)
        self.cull()
        self._vertices.render()

    def cull(self) -> None:
        """Backs are drawn only where the material has two sides."""
        if self.shape.part.material.double_sided:
            self.context.disable(self.context.CULL_FACE)
        else:
            self.context.enable(self.context.CULL_FACE)


def _uniforms(part: Part, head: Head, is_eye: bool) -> dict[str, bytes]:
    """What is the part's own."""
    low, high = part.positions.min(0), part.positions.max(0)
    values: dict[str, Any] = {
        "tint": part.material.color,
        "anchor": (low + high) / 2 if is_eye else head.mouth.center,
        "roughness": part.material.roughness,
        "normalRepeat": part.material.normal_repeat,
    }
    return {name: np.asarray(value, "f4").tobytes() for name, value in values.items()}
