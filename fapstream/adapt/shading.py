"""The light in photos: colours as amounts of light, and how much of it a surface got by the way it faces."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.floating[Any]]

LUMINANCE = np.array([0.2126, 0.7152, 0.0722], np.float32)
RENDERED = ((0.992, 0.227), (0.798, -0.060), (0.744, -0.160))
"""By channel: log picture = first * log shown + second; fitted to renders of the packaged heads' skins."""
ROUNDS = 6
STIFF = 0.02
"""How much a coefficient costs, in mean squared log luminance."""
EVERY = 13
"""Light is fitted to one texel of so many."""
OFF = 0.25
"""Log luminance that a texel may be off before it counts less: brows, nostrils, highlights."""


def linear(pixels: NDArray[np.uint8] | Floats) -> Floats:
    """sRGB 0..255 to amounts of light 0..1 (IEC 61966-2-1)."""
    if pixels.dtype == np.uint8:
        return _LIGHT[pixels]
    value = np.asarray(pixels, np.float64) / 255
    light: Floats = np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)
    return light


_LIGHT = linear(np.arange(256.0)).astype(np.float32)


def encoded(light: Floats) -> NDArray[np.uint8]:
    """Amounts of light to sRGB 0..255."""
    value = np.clip(light, 0, 1)
    bent = np.where(value <= 0.0031308, 12.92 * value, 1.055 * value ** (1 / 2.4) - 0.055)
    pixels: NDArray[np.uint8] = np.rint(255 * bent).astype(np.uint8)
    return pixels


def unrendered(light: Floats) -> Floats:
    """What the skin's picture has to have (n, 3) for the clients to show it, on the whole, as `light` (n,
    3).
    """
    power, factor = np.array(RENDERED, np.float32).T
    found: Floats = np.minimum(np.exp(factor) * np.maximum(light, 1e-5) ** power, 1.0)
    return found


def harmonics(normals: Floats) -> Floats:
    """(n, 9): the functions of the direction that matte surfaces show distant light by, up to factors.

    R. Basri, D. W. Jacobs (2003), Lambertian reflectance and linear subspaces, IEEE PAMI 25(2).
    """
    x, y, z = normals.T
    return np.stack([np.ones_like(x), x, y, z, x * y, x * z, y * z, x * x - y * y, 3 * z * z - 1], 1)


def unlit(light: Floats, normals: Floats, weights: Floats) -> Floats:
    """(n, 3): `light` (n, 3) with the differences in brightness taken out that come from how the surface
    faces.

    Fitted to log luminance by robust least squares with `weights` (n,), which tell skin of one colour from
    the rest; what is left has the same brightness on the whole.
    """
    level = np.log(np.maximum(light @ LUMINANCE, 1e-4))
    basis = harmonics(normals)
    found = _fitted(basis[::EVERY], level[::EVERY], weights[::EVERY])
    shade = basis @ found
    shade -= float((shade * weights).sum() / max(float(weights.sum()), 1e-9))
    flat: Floats = light * np.exp(-np.clip(shade, -1.2, 1.2))[:, None]
    return flat


def _fitted(basis: Floats, level: Floats, weights: Floats) -> Floats:
    """Coefficients (9,) by robust least squares."""
    weight = weights.copy()
    cost = STIFF * np.diag([1e-6] + [1.0] * 8)
    for _ in range(ROUNDS):
        total = max(float(weight.sum()), 1e-9)
        normal = basis.T @ (basis * weight[:, None]) / total + cost
        found = np.linalg.solve(normal, basis.T @ (level * weight) / total)
        off = level - basis @ found
        weight = weights / (1 + (off / OFF) ** 2)
    return found.astype(np.float32)


def calibration(here: Floats, there: Floats, weights: Floats) -> tuple[Floats, Floats]:
    """A, B (3,): A * there + B has the mean and the spread of `here`; both (n, 3), weights (n,).

    Sarris, Grammalidis, Strintzis, equations 15 and 16, per channel: A = s_here / s_there, B = m_here - A
    m_there.
    """
    share = weights / max(float(weights.sum()), 1e-12)
    means = [share @ row for row in (here, there)]
    spreads = [np.sqrt(share @ (row - mean) ** 2) for row, mean in zip((here, there), means, strict=True)]
    factor = np.clip(spreads[0] / np.maximum(spreads[1], 1e-6), 0.6, 1.6)
    return factor, means[0] - factor * means[1]
