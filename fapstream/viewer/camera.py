"""Where the camera stands for a portrait; the same as the web client's."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fapstream.head.fapu import Point
from fapstream.head.mesh import Camera

NEEDED_WIDTH = 0.8
"""Width of a portrait that holds the whole head, as a share of its height."""
NEAR, FAR = 0.05, 10.0

Matrix = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class View:
    """How the viewer departs from the portrait.

    `yaw`, `pitch`: degrees that the camera goes round to the subject's left, and up. `zoom`: how many times
    larger. `target`: what to look at instead of the portrait's own.
    """

    yaw: float = 0.0
    pitch: float = 0.0
    zoom: float = 1.0
    target: Point | None = None


PORTRAIT = View()


@dataclass(frozen=True, slots=True)
class Lens:
    """What the shaders need: 4x4 matrices for column vectors, and the camera's place in metres."""

    view: Matrix
    projection: Matrix
    position: NDArray[np.float64]


def lens(camera: Camera, fov_degrees: float, aspect: float, view: View = PORTRAIT) -> Lens:
    """The camera that frames `camera.height` metres, or more where the picture is too narrow for the head.

    `aspect`: width over height. Turning and zooming leave the distance, and so the perspective, as it is.
    """
    half = np.tan(np.radians(fov_degrees) / 2)
    distance = camera.height * max(1.0, NEEDED_WIDTH / aspect) / 2 / half
    turn = _turn(np.radians(view.yaw), np.radians(view.pitch))
    target = np.asarray(camera.target if view.target is None else view.target, float)
    position = target + turn @ (0.0, 0.0, distance)
    matrix = np.eye(4)
    matrix[:3, :3] = turn.T
    matrix[:3, 3] = -turn.T @ position
    return Lens(matrix, _projection(view.zoom / half, aspect), position)


def pinhole(
    axes: Matrix,
    position: NDArray[np.float64],
    focal: float,
    centre: tuple[float, float],
    size: tuple[int, int],
) -> Lens:
    """The camera of a photo of `size` (width, height) pixels.

    `axes` (3, 3): rows are the camera's right, up and backward; `position` (3,) metres; `focal` length and
    principal point `centre` (x, y from the upper left corner) in pixels.
    """
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = axes, -axes @ position
    width, height = size
    projection = _projection(2 * focal / height, width / height)
    projection[0, 2], projection[1, 2] = 1 - 2 * centre[0] / width, 2 * centre[1] / height - 1
    return Lens(matrix, projection, position)


def _turn(yaw: float, pitch: float) -> Matrix:
    """From the camera's axes to the head's."""
    about_y = np.array([[np.cos(yaw), 0, np.sin(yaw)], [0, 1, 0], [-np.sin(yaw), 0, np.cos(yaw)]])
    about_x = np.array([[1, 0, 0], [0, np.cos(pitch), np.sin(pitch)], [0, -np.sin(pitch), np.cos(pitch)]])
    turn: Matrix = about_y @ about_x
    return turn


def _projection(focal: float, aspect: float) -> Matrix:
    matrix = np.zeros((4, 4))
    matrix[0, 0], matrix[1, 1] = focal / aspect, focal
    matrix[2, 2], matrix[2, 3] = (FAR + NEAR) / (NEAR - FAR), 2 * FAR * NEAR / (NEAR - FAR)
    matrix[3, 2] = -1.0
    return matrix
