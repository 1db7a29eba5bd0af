"""A face and what moves it: head files in and out, FAPs to vertices, other people's avatars."""

from __future__ import annotations

from fapstream.head.deform import deform
from fapstream.head.deformer import Deformer
from fapstream.head.export import export_shapes, export_talk
from fapstream.head.fapu import Fapu, measure
from fapstream.head.foreign import load_head
from fapstream.head.gltf import read_head
from fapstream.head.gltf_write import write_head
from fapstream.head.lips import LipContours, lip_contours
from fapstream.head.mesh import FatEntry, Head, Material, Part, Turn

__all__ = [
    "Deformer",
    "Fapu",
    "FatEntry",
    "Head",
    "LipContours",
    "Material",
    "Part",
    "Turn",
    "deform",
    "export_shapes",
    "export_talk",
    "lip_contours",
    "load_head",
    "measure",
    "read_head",
    "write_head",
]
