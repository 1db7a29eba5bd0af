"""A few articulatory parameters instead of many FAPs of the mouth (mother-articulatory-head, section 2.2)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

SPOKEN = (*range(3, 14), *range(51, 61))
"""FAPs that the parameters move: jaw, inner and outer lips. All of them can be measured from in front."""
COLUMNS = np.array(SPOKEN) - 1


@dataclass(frozen=True, slots=True)
class Articulation:
    """Parameters of unit variance over speech to the FAPs of SPOKEN, linearly, in FAP units.

    `mean`: shape (faps,), of speech; `basis`: shape (n, faps), what one unit of each parameter adds. `names`:
    what each does at its positive end.
    """

    names: tuple[str, ...]
    mean: Floats
    basis: Floats

    @property
    def n(self) -> int:
        """How many parameters there are."""
        return len(self.basis)

    def faps(self, parameters: Floats) -> Floats:
        """FAPs (..., faps) of parameters (..., n)."""
        found: Floats = self.mean + parameters @ self.basis
        return found

    def parameters(self, faps: Floats) -> Floats:
        """The parameters (..., n) whose FAPs are nearest to those, shape (..., faps)."""
        found: Floats = (faps - self.mean) @ np.linalg.pinv(self.basis)
        return found
