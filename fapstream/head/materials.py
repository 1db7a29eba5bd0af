"""glTF materials to ours."""

from __future__ import annotations

from typing import Any

from fapstream.head.document import Document
from fapstream.head.mesh import Image, Material

TRANSFORM = "KHR_texture_transform"


class Materials(Document):
    """A document whose materials can be read."""

    def __init__(self, document: dict[str, Any], binary: bytes, where: str) -> None:
        super().__init__(document, binary, where)
        self._materials: dict[int, Material] = {}

    def material(self, index: Any, place: str) -> Material:
        """The material of that number: parts that name the same one share one object."""
        if index is None:
            return Material("plain")
        row = self.item("materials", index, place)
        if index not in self._materials:
            self._materials[index] = self._material(row, place)
        return self._materials[index]

    def _material(self, row: dict[str, Any], place: str) -> Material:
        pbr = row.get("pbrMetallicRoughness", {})
        if not isinstance(pbr, dict):
            self.fail(place, "has a material without pbrMetallicRoughness")
        red, green, blue, opacity = self.vector(
            pbr.get("baseColorFactor", [1.0, 1.0, 1.0, 1.0]), 4, place + ".baseColorFactor"
        )
        alpha = row.get("alphaMode", "OPAQUE")
        if alpha not in ("OPAQUE", "MASK", "BLEND"):
            self.fail(place, f"alphaMode is {alpha!r:.40}")
        return Material(
            name=str(row.get("name", "")),
            color=(red, green, blue, opacity),
            texture=self.image(pbr.get("baseColorTexture"), place + ".baseColorTexture"),
            normal=self.image(row.get("normalTexture"), place + ".normalTexture"),
            normal_repeat=self.repeat(row.get("normalTexture"), place + ".normalTexture"),
            roughness=self.number(pbr.get("roughnessFactor", 1.0), place + ".roughnessFactor"),
            metallic=self.number(pbr.get("metallicFactor", 1.0), place + ".metallicFactor"),
            alpha=alpha,
            cutoff=self.number(row.get("alphaCutoff", 0.5), place + ".alphaCutoff"),
            double_sided=bool(row.get("doubleSided", False)),
        )

    def image(self, reference: Any, place: str) -> Image | None:
        return None if reference is None else Image(*self.picture(reference, place))

    def repeat(self, reference: Any, place: str) -> float:
        """How often a picture lies along u and v: KHR_texture_transform's scale, the same for both."""
        extensions = reference.get("extensions", {}) if isinstance(reference, dict) else {}
        transform = extensions.get(TRANSFORM, {}) if isinstance(extensions, dict) else {}
        scale = transform.get("scale", [1.0, 1.0]) if isinstance(transform, dict) else None
        if not isinstance(scale, list) or len(scale) != 2 or scale[0] != scale[1]:
            self.fail(place, "its scale is not the same number twice")
        return self.positive(scale[0], place + ".scale")
