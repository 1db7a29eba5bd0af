"""High-level FAPs to low-level: what FAP 1 (viseme) and FAP 2 (expression) do to FAPs 3-68.

How ISO/IEC 14496-2 (semantics of viseme, expression, init_face and the two define flags) is read here:

- Viseme shape = v1 * blend/63 + v2 * (1 - blend/63); expression shape = e1 * i1/63 + e2 * i2/63. The shapes
  are tables in data. Explicit low-level FAPs blend with both by addition, so that a row of all 68 FAPs whose
  low-level part is 0 still shows its viseme.
- A FAP that is not sent keeps its last value; so do FAP 1 and FAP 2. Everything begins at 0.
- viseme_def: the mouth's FAPs (groups 2, 6 and 8) sent along are the shape of viseme_select1 from now on.
  expression_def: the other FAPs sent along are the shape of expression_select1 at full intensity; without
  viseme_def the mouth's FAPs belong to it as well. FAPs that define a shape move the face only through it.
- init_face: the expression of this row is not shown; it becomes the face at rest, "within the neutral face
  constraints" of the standard: these fix jaw, lips, tongue, teeth, lids, eyes and head, so that what is left
  are brows, cheeks, nose and ears (groups 4, 5, 9 and 10). All that follows is added to this face.
  No expression (both selects 0) with init_face gives the first face back.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fapstream.fap.rows import MAX_VALUE, FapRow, Mask
from fapstream.fap.tables import EXPRESSIONS, FULL, expressions, faps, visemes
from fapstream.records import N_FAPS, ExpressionFap, VisemeFap

_GROUP = np.array([f.group for f in faps()])
_MOUTH = np.isin(_GROUP, (2, 6, 8))
_FREE_AT_REST = np.isin(_GROUP, (4, 5, 9, 10))
_HIGH_LEVEL = _GROUP == 1


def uses(row: FapRow) -> tuple[Mask, Mask, Mask]:
    """What the low-level FAPs sent are for, each bool (68,): they move the face, or define the viseme or
    the expression."""
    none = np.zeros_like(row.mask)
    explicit, of_viseme, of_expression = row.mask & ~_HIGH_LEVEL, none, none
    if row.viseme and row.viseme.define:
        explicit, of_viseme = explicit & ~_MOUTH, explicit & _MOUTH
    if row.expression and row.expression.define:
        explicit, of_expression = none, explicit
    return explicit, of_viseme, of_expression


class Expander:
    """A decoder's memory: shapes as defined so far, the face at rest, and every FAP's last value."""

    def __init__(self) -> None:
        self._visemes = visemes().copy()
        self._expressions = np.vstack([np.zeros(N_FAPS), *(expressions()[name] for name in EXPRESSIONS)])
        self._rest = np.zeros(N_FAPS)
        self._low = np.zeros(N_FAPS)
        self._viseme = VisemeFap()
        self._expression = ExpressionFap()

    def step(self, row: FapRow) -> NDArray[np.int32]:
        """The face after the next row: FAPs 3-68 in FAP units, shape (68,), 0 for FAPs 1 and 2.

        What passes 32 bits stays at their end.
        """
        explicit, of_viseme, of_expression = uses(row)
        if row.viseme and row.viseme.define:
            self._define(self._visemes, row.viseme.select1, of_viseme, row)
        if row.expression and row.expression.define:
            self._define(self._expressions, row.expression.select1, of_expression, row)
        self._low[explicit] = row.values[explicit]
        self._viseme = row.viseme or self._viseme
        self._expression = row.expression or self._expression
        if self._expression.init_face:
            self._rest = np.where(_FREE_AT_REST, self._expression_shape(), 0)
            self._expression = ExpressionFap()
        face = self._rest + self._low + self._viseme_shape() + self._expression_shape()
        return np.rint(np.clip(face, -MAX_VALUE, MAX_VALUE)).astype(np.int32)

    @staticmethod
    def _define(shapes: NDArray[np.float64], select: int, sent: Mask, row: FapRow) -> None:
        if select:
            shapes[select] = np.where(sent, row.values, 0)

    def _viseme_shape(self) -> NDArray[np.float64]:
        v, weight = self._viseme, self._viseme.blend / FULL
        shape: NDArray[np.float64] = (
            weight * self._visemes[v.select1] + (1 - weight) * self._visemes[v.select2]
        )
        return shape

    def _expression_shape(self) -> NDArray[np.float64]:
        e = self._expression
        shape: NDArray[np.float64] = (
            e.intensity1 / FULL * self._expressions[e.select1]
            + e.intensity2 / FULL * self._expressions[e.select2]
        )
        return shape
