"""Materials: glTF's defaults, and what is refused."""

from typing import Any

import pytest

from fapstream.errors import DataError
from fapstream.head.materials import Materials
from fapstream.head.mesh import Material


def read(index: Any, **row: Any) -> Material:
    document = {"asset": {"version": "2.0"}, "materials": [{"name": "m", **row}]}
    return Materials(document, b"", "x.glb").material(index, "p")


def test_without_anything_glTFs_defaults_hold() -> None:
    assert read(0) == Material("m", roughness=1.0, metallic=1.0)
    assert read(None) == Material("plain")


def test_what_is_there_is_read() -> None:
    pbr = {"baseColorFactor": [0.1, 0.2, 0.3, 0.4], "roughnessFactor": 0.5, "metallicFactor": 0}
    material = read(0, pbrMetallicRoughness=pbr, alphaMode="MASK", alphaCutoff=0.3, doubleSided=True)
    assert material == Material("m", (0.1, 0.2, 0.3, 0.4), None, None, 1.0, 0.5, 0.0, "MASK", 0.3, True)


def test_one_number_is_one_object() -> None:
    """Whoever shows the head loads its pictures once."""
    document = {"asset": {"version": "2.0"}, "materials": [{"name": "m"}, {"name": "m"}]}
    materials = Materials(document, b"", "x.glb")
    assert materials.material(0, "p") is materials.material(0, "q")
    assert materials.material(0, "p") is not materials.material(1, "p")


@pytest.mark.parametrize("index", [True, -1, 1, "0", [0], {}, 0.0])
def test_a_number_that_is_none_is_refused(index: Any) -> None:
    with pytest.raises(DataError, match=r"x\.glb: p: materials\["):
        read(index)


@pytest.mark.parametrize(
    "row",
    [
        {"pbrMetallicRoughness": 3},
        {"pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1]}},
        {"pbrMetallicRoughness": {"roughnessFactor": "rough"}},
        {"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}},
        {"alphaMode": "SOMETIMES"},
        {"alphaMode": ["BLEND"]},
        {"normalTexture": 7},
    ],
)
def test_what_is_wrong_is_refused(row: dict[str, Any]) -> None:
    with pytest.raises(DataError, match=r"x\.glb: p"):
        read(0, **row)
