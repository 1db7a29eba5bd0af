"""Articulatory parameters: principal components of parts of the face, each the predictor of all of it.

mother-articulatory-head, section 2.2. A component of the jaw comes first, and what it predicts of all points
is taken away before the lips' three are looked for, and so on: jaw, three of the lips, jaw again, the rest.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fapstream.errors import ClipError

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

LEAST_PART = 1e-12
"""Of the total variance; less is what rounding leaves."""


TWINS = 1e-6
"""Parts that differ by no more than this part of them are as great as each other."""


@dataclass(frozen=True, slots=True)
class Guide:
    """Take so many components of those columns. `sign`: that of the greatest part of each."""

    columns: Ints
    components: int = 1
    sign: int = 1


class GuidedPca:
    """Fits `n` parameters of unit variance to rows of d numbers.

    After `fit`: `mean_`, shape (d,); `basis_`, shape (n, d), what one unit of a parameter adds; `encoder_`,
    shape (d, n), which gives the parameters of a row less the mean; `explained_`, shape (n,), the part of the
    total variance that each takes away.
    """

    def __init__(self, guides: Sequence[Guide]) -> None:
        self.guides = guides

    def fit(self, x: Floats) -> GuidedPca:
        """Of rows (r, d). Raises ClipError if less moves than there are components."""
        self.mean_ = x.mean(axis=0)
        left = x - self.mean_
        # what is left is the rows times this
        residual = np.eye(x.shape[1])
        basis: list[Floats] = []
        encoder, explained = [], []
        total = left.var(axis=0).sum()
        for guide in self.guides:
            for direction in _components(left[:, guide.columns], guide.components):
                score = guide.sign * residual[:, guide.columns] @ direction
                values = (x - self.mean_) @ score
                if not values.var() > LEAST_PART * total:
                    raise ClipError(f"nothing moves that component {len(basis) + 1} could be found in")
                score, values = score / values.std(), values / values.std()
                loading = values @ left / (values @ values)
                before = left.var(axis=0).sum()
                left = left - np.outer(values, loading)
                residual = residual - np.outer(score, loading)
                basis.append(loading)
                encoder.append(score)
                explained.append((before - left.var(axis=0).sum()) / total)
        self.basis_, self.encoder_ = np.array(basis), np.array(encoder).T
        self.explained_ = np.array(explained)
        return self

    def transform(self, x: Floats) -> Floats:
        """Parameters (..., n) of rows (..., d)."""
        found: Floats = (x - self.mean_) @ self.encoder_
        return found

    def inverse_transform(self, parameters: Floats) -> Floats:
        """Rows (..., d) of parameters (..., n)."""
        found: Floats = self.mean_ + parameters @ self.basis_
        return found


def _components(x: Floats, n: int) -> Floats:
    """The first n principal directions of centred rows, shape (n, columns); the greatest part is positive,
    the first of them if twins on either side of a face are as great."""
    _, vectors = np.linalg.eigh(x.T @ x)
    found: Floats = vectors[:, ::-1][:, :n].T
    size = np.abs(found)
    first = (size >= (1 - TWINS) * size.max(axis=1, keepdims=True)).argmax(axis=1)
    largest = found[np.arange(len(found)), first]
    turned: Floats = found * np.sign(largest)[:, None]
    return turned
