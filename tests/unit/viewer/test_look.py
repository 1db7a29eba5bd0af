"""The shared look: what is read from the package, and how it becomes #defines."""

from __future__ import annotations

import re

import pytest

from fapstream.head.mesh import Material
from fapstream.viewer.look import Look, define_lines, load_look

SMALL = Look(
    {
        "fov": 20,
        "defines": {"KEY": [1.0, 0.5, 0.25]},
        "layers": ["hair", "skin", "", "lash"],
        "shadow": {"casters": ["skin", "hair"]},
        "finishes": [
            {"parts": ["skin", "lips"], "defines": {"SKIN": True, "GLOSS": 1}},
            {"parts": [""], "defines": {"GLOSS": 0.5}},
        ],
    },
    {"head.vert": "void main() {}\n", "head.frag": "// frag\n"},
)


def test_values_become_glsl() -> None:
    lines = define_lines({"A": True, "B": False, "C": 2, "D": 0.0016, "E": [1, 0.25], "F": (0.5, 1, 2)})
    assert lines.splitlines() == [
        "#define A 1",
        "#define C 2.0",
        "#define D 0.0016",
        "#define E vec2(1.0, 0.25)",
        "#define F vec3(0.5, 1.0, 2.0)",
    ]
    assert define_lines({"X": 1e-7}) == "#define X 1e-07\n"


def test_the_first_finish_that_fits_wins() -> None:
    assert SMALL.finish("skin") == {"SKIN": True, "GLOSS": 1}
    assert SMALL.finish("lips_upper")["SKIN"] is True
    assert SMALL.finish("shirt") == {"GLOSS": 0.5}


def test_layers_are_drawn_in_order_and_transparent_parts_last() -> None:
    opaque, blend = Material("a"), Material("b", alpha="BLEND")
    order = [("hair", opaque), ("skin", opaque), ("eye_l", opaque), ("lashes_l", opaque), ("hair", blend),
             ("tear", blend), ("lashes_l", blend)]  # fmt: skip
    layers = [SMALL.layer(name, material) for name, material in order]
    assert layers == sorted(layers)
    assert len(set(layers)) == len(layers)


def test_a_program_is_version_then_defines_then_source() -> None:
    program = SMALL.program("head", {"GLOSS": 0.5})
    assert program["vertex_shader"] == (
        "#version 330 core\n#define KEY vec3(1.0, 0.5, 0.25)\n#define GLOSS 0.5\nvoid main() {}\n"
    )
    assert program["fragment_shader"].endswith("#define GLOSS 0.5\n// frag\n")


def test_the_packages_look_has_what_is_asked_for() -> None:
    look = load_look()
    assert look.fov == 20
    assert {"head.vert", "head.frag", "shadow.vert", "shadow.frag"} <= set(look.sources)
    assert look.casters
    assert "skin".startswith(look.casters)
    assert look.finish("skin") != look.finish("eye_l") != look.finish("no such part")
    for stop, place in look.settings["background"]:
        assert re.fullmatch("#[0-9a-f]{6}", stop)
        assert place == pytest.approx(min(1, max(0, place)))
