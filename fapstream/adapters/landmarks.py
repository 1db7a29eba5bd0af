"""Feature points found in photos, with models that run on LiteRT (the extra `landmarks`)."""

from __future__ import annotations

import importlib.util
import os
from collections.abc import Sequence
from threading import Lock
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fapstream.adapt import facemesh, found, sclera, seam, silhouette
from fapstream.adapt.crop import Crop
from fapstream.adapt.outline import sharpened, trace
from fapstream.adapt.points import Facing, Marks
from fapstream.data import PACKAGE
from fapstream.errors import DataError, FapstreamError, PhotoError

Floats = NDArray[np.float64]
Picture = NDArray[np.uint8]

MODELS = os.path.join(PACKAGE, "assets", "landmarks")
DETECTOR, MESH, MASK = "face_detection_short_range", "face_landmark", "selfie_segmentation"
MASK_SIDE = 256
LEAST_SIDE = 64
"""Pixels; a smaller picture shows no features."""
LARGEST_OUTLINE = 768
"""Pixels a side in which an outline is traced: more would not make it more exact."""


class LandmarksUnavailable(FapstreamError):
    """Points cannot be found here; they can be given by hand."""

    code = "no_landmarks"


def installed() -> bool:
    """Whether the package that runs the models is there."""
    return importlib.util.find_spec("ai_edge_litert") is not None


class Landmarker:
    """Finds feature points. The models are read when they are first needed, each once; threads take turns."""

    def __init__(self) -> None:
        """Raises LandmarksUnavailable."""
        if not installed():
            raise LandmarksUnavailable(
                "finding points needs LiteRT: pip install 'fapstream[landmarks]'; or give them by --points, "
                "in a file that the editor at /adapt writes"
            )
        self._models: dict[str, Any] = {}
        self._lock = Lock()

    def front(self, picture: Picture) -> Marks:
        """See the port."""
        _check(picture)
        mesh, score = self.mesh(picture, found.only_face(self.faces(picture)))
        facemesh.check_front(mesh, score)
        return facemesh.front_marks(picture, mesh, score)

    def profile(self, picture: Picture) -> tuple[Marks, Facing]:
        """See the port."""
        _check(picture)
        faces = self.faces(picture)
        face = found.only_face(faces) if faces else None
        if face is not None:
            facemesh.check_profile(*self.mesh(picture, face))
        line = self.outline(picture, face)
        laid = silhouette.lay(line, None if face is None else silhouette.FACE_HEIGHT * face.size)
        seen = {"8.3": seam.mouth_corner(picture, laid), **sclera.profile_eye(picture, laid)}
        return silhouette.profile_marks(laid, _size(picture), seen), laid.facing

    def outline(self, picture: Picture, face: found.Face | None) -> Floats:
        """The outline (k, 2) of a person, pixels, around the face if there is one."""
        crop = _whole(picture) if face is None else silhouette.crop_around(face)
        mask = self._run(MASK, crop.cut(picture, MASK_SIDE) / 255)[0]
        n = int(np.clip(crop.side, MASK_SIDE, LARGEST_OUTLINE))
        line = trace(sharpened(mask.reshape(MASK_SIDE, MASK_SIDE), crop.cut(picture, n)))
        return crop.place(line / n)

    def faces(self, picture: Picture) -> list[found.Face]:
        faces = self._detect(picture, _whole(picture))
        if not faces:
            tiles = found.tiles(*_size(picture))
            faces = [face for tile in tiles for face in self._detect(picture, tile)]
        return found.each_once(faces)

    def _detect(self, picture: Picture, crop: Crop) -> list[found.Face]:
        boxes, scores = self._run(DETECTOR, crop.cut(picture, found.DETECTOR_SIDE) / 127.5 - 1)
        return found.decode(boxes, scores, crop)

    def mesh(self, picture: Picture, face: found.Face) -> tuple[Floats, float]:
        """The mesh (468, 3) of a face, pixels, and its score: the least of three looks at it.

        Each look has its square from the mesh of the one before; where no face looks here, they stray.
        """
        first, sure = self._look(picture, [face.crop])
        again, still = self._look(picture, [found.mesh_crop(first)])
        steady, yet = self._look(picture, facemesh.glances(found.mesh_crop(again)))
        return steady, min(sure, still, yet)

    def _look(self, picture: Picture, crops: Sequence[Crop]) -> tuple[Floats, float]:
        """The mean mesh (468, 3) seen in some crops, pixels, and its mean score."""
        seen = [self._run(MESH, crop.cut(picture, found.MESH_SIDE) / 255) for crop in crops]
        meshes = [found.place_mesh(raw, crop) for (raw, _), crop in zip(seen, crops, strict=True)]
        return np.mean(meshes, axis=0), float(np.mean([found.chance(score)[0] for _, score in seen]))

    def _run(self, name: str, picture: NDArray[np.floating[Any]]) -> list[NDArray[np.float32]]:
        """The outputs of a model for a picture (n, n, 3) in its unit."""
        with self._lock:
            model = self._models.get(name) or self._models.setdefault(name, _read(name))
            model.set_tensor(model.get_input_details()[0]["index"], picture[None].astype(np.float32))
            model.invoke()
            return [model.get_tensor(out["index"])[0].copy() for out in model.get_output_details()]


def _size(picture: Picture) -> tuple[int, int]:
    return picture.shape[1], picture.shape[0]


def _whole(picture: Picture) -> Crop:
    return Crop.whole(*_size(picture))


def _read(name: str) -> Any:
    from ai_edge_litert.interpreter import Interpreter

    path = os.path.join(MODELS, f"{name}.tflite")
    if not os.path.isfile(path):
        raise DataError(path, None, "not in the package")
    model = Interpreter(path, num_threads=1)
    model.allocate_tensors()
    return model


def _check(picture: Picture) -> None:
    if picture.ndim != 3 or picture.shape[2] != 3 or picture.dtype != np.uint8:
        raise PhotoError(f"a picture is (height, width, 3) of uint8, not {picture.shape} of {picture.dtype}")
    if min(picture.shape[:2]) < LEAST_SIDE:
        height, width = picture.shape[:2]
        raise PhotoError(f"a photo of {width} x {height} pixels is too small; {LEAST_SIDE} are the least")
