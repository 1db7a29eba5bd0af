"""Contexts, textures and their faults."""

from __future__ import annotations

import dataclasses
import io
import sys

import numpy as np
import pytest
from PIL import Image as Picture

from fapstream.errors import DataError
from fapstream.head.mesh import Image, Material
from fapstream.viewer import graphics
from fapstream.viewer.graphics import (
    ViewerUnavailable,
    column_major,
    cutoff,
    is_software,
    needed,
    open_context,
    textures_of,
)
from tests.unit.viewer.heads import square, squares


def png(width: int = 2, height: int = 1) -> bytes:
    file = io.BytesIO()
    picture = Picture.new("P", (width, height))
    picture.putpalette([255, 0, 0, 0, 0, 255])
    picture.putdata([0, 1] * (width * height // 2))
    picture.save(file, "PNG")
    return file.getvalue()


def test_pictures_become_textures_once_with_their_first_row_first() -> None:
    context = open_context()
    image = Image(png(), "image/png")
    material = Material("m", texture=image, normal=image)
    head = squares(square("skin", 0, 0.1, material), square("eye_l", 0, 0.1, material))
    textures = textures_of(context, head)
    assert list(textures) == [image]
    assert textures[image].read() == bytes([255, 0, 0, 255, 0, 0, 255, 255])
    context.release()


@pytest.mark.parametrize("software", [True, False])
def test_only_a_graphics_card_filters_textures_dearly(
    software: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What the processor draws is filtered as in the web client: one picture, four of its pixels."""
    monkeypatch.setattr(graphics, "is_software", lambda _: software)
    context = open_context()
    head = squares(square("skin", 0, 0.1, Material("m", texture=Image(png(8, 8), "image/png"))))
    (texture,) = textures_of(context, head).values()
    dear = context.LINEAR_MIPMAP_LINEAR, context.LINEAR
    assert (texture.filter == dear) is not software
    assert (texture.anisotropy > 1) is not software
    context.release()


BOMB = png()[:16] + b"\0\0\xff\xff" * 2 + png()[24:]


@pytest.mark.parametrize("data", [b"", b"no picture", png()[:40], BOMB])
def test_a_broken_picture_is_the_files_fault(data: bytes) -> None:
    context = open_context()
    head = squares(square("skin", 0, 0.1, Material("m", texture=Image(data, "image/png"))))
    with pytest.raises(DataError, match=r"squares: a picture \(image/png\) cannot be used"):
        textures_of(context, head)
    context.release()


def test_a_picture_too_large_is_refused_before_it_is_unpacked(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(graphics, "MAX_PIXELS", 100)
    context = open_context()
    head = squares(square("skin", 0, 0.1, Material("m", texture=Image(png(20, 6), "image/png"))))
    with pytest.raises(DataError, match="20 x 6 pixels"):
        textures_of(context, head)
    context.release()


def test_a_missing_module_is_told_in_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "glfw", None)
    with pytest.raises(ViewerUnavailable, match=r"glfw: pip install 'fapstream\[viewer\]'") as caught:
        needed("glfw")
    assert "\n" not in str(caught.value)


def test_without_gl_the_reason_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(**_: object) -> None:
        raise Exception("libEGL.so not loaded")  # what moderngl raises

    monkeypatch.setattr(needed("moderngl"), "create_context", fails)
    with pytest.raises(ViewerUnavailable, match=r"libEGL\.so.*apt install libegl1"):
        open_context()


@pytest.mark.parametrize(
    ("name", "software"), [("llvmpipe (LLVM 15.0.6, 256 bits)", True), ("NVIDIA GeForce RTX", False)]
)
def test_software_is_known_by_its_name(name: str, software: bool) -> None:
    context = type("Context", (), {"info": {"GL_RENDERER": name}})()
    assert is_software(context) is software


def test_matrices_go_out_by_columns() -> None:
    matrix = np.arange(16.0).reshape(4, 4)
    assert np.frombuffer(column_major(matrix), "f4")[1] == matrix[1, 0]


def test_only_masked_materials_have_holes() -> None:
    masked = Material("m", alpha="MASK", cutoff=0.3)
    assert cutoff(masked) == {"CUTOFF": 0.3}
    assert cutoff(dataclasses.replace(masked, alpha="BLEND")) == {}
