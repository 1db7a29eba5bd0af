"""Bones and parts by the names that modelling programs give them."""

import numpy as np
import pytest

from fapstream.head.nodes import Node
from fapstream.head.rig import bones, kind_of


def found(*names: str, shown: set[int] = frozenset(), **given: int) -> dict[str, str]:  # type: ignore[assignment]
    nodes = [Node(name, None, np.eye(4)) for name in names]
    return {bone: names[i] for bone, i in bones(nodes, set(shown), given).items()}


@pytest.mark.parametrize(
    ("neck", "head", "left", "right"),
    [
        ("Neck", "Head", "LeftEye", "RightEye"),
        ("mixamorig:Neck", "mixamorig:Head", "mixamorig:LeftEye", "mixamorig:RightEye"),
        ("J_Bip_C_Neck", "J_Bip_C_Head", "J_Adj_L_FaceEye", "J_Adj_R_FaceEye"),
        ("CC_Base_Neck", "CC_Base_Head", "CC_Base_L_Eye", "CC_Base_R_Eye"),
        ("neck", "head", "eye.L", "eye.R"),
        ("DEF-neck", "DEF-head", "eye_l", "eye_r"),
        ("Bip01 Neck", "Bip01 Head", "Bip01 LEye left", "Bip01 REye right"),
    ],
)
def test_bones(neck: str, head: str, left: str, right: str) -> None:
    rest = ("Hips", "HeadTop_End", "LeftEyeBrow", "Eyelid_L", "Forehead", "LeftEye_End", "EyeTarget_L")
    assert found(*rest, neck, head, left, right) == {
        "neck": neck, "head": head, "leftEye": left, "rightEye": right,
    }  # fmt: skip


def test_a_mesh_is_no_bone_and_the_file_knows_best() -> None:
    assert found("Wolf3D_Head", "Head", shown={0}) == {"head": "Head"}
    assert found("Head", "Skull", head=1) == {"head": "Skull"}


@pytest.mark.parametrize(
    ("names", "kind"),
    [
        (("Wolf3D_Skin", "", ""), "skin"), (("N00_000_00_FaceMouth_00_FACE", "", ""), "mouth"),
        (("F00_EyeIris_00_EYE", "Face", ""), "eye"), (("F00_FaceEyelash", "", ""), "lashes"),
        (("F00_FaceBrow_00", "", ""), "brows"), (("Hair_Brown", "", ""), "hair"),
        (("mat1", "EyeLeft", ""), "eye"),
        (("mat1", "mesh3", "Wolf3D_Teeth"), "teeth"), (("Outfit_Top", "", ""), "shirt"),
        (("a", "b", "c"), "part"),
        (("EyeHighlight", "", ""), "cornea"), (("Tongue", "", ""), "tongue"),
    ],
)  # fmt: skip
def test_parts(names: tuple[str, str, str], kind: str) -> None:
    assert kind_of(names) == kind
