"""Slide step: the equations of one step of a sliding fit, assembled once and solved for any fairing."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import scipy.sparse
from numpy.typing import NDArray
from scipy.sparse import csr_array

from orbiframe_fitters.coupled import KIND, coupled, nearly_solved
from orbiframe_fitters.gram import Gram
from orbiframe_fitters.normal_equations import solved

Floats = NDArray[np.float64]

# Up to so many functions the equations of a step are factored as a whole; of more, iteration takes less time.
_DIRECT = 200


class SlideStep(NamedTuple):
    """The sums of the data, six kinds of matrices and the right side (size, 3), and those of the energy for fairing 1.

    energy: (size, size), None where there is none; pull: its product with the coefficients; whole: whether equations
    are factored as a whole, however many they are.
    """

    gram: Gram
    right: Floats
    energy: Any
    pull: Floats
    whole: bool

    def change(self, fairing: float) -> Floats:
        """The change of the coefficients, (size, 3)."""
        size = len(self.right)
        stiff: Any = csr_array((size, size)) if self.energy is None else fairing * self.energy
        right = self.right - fairing * self.pull
        if size > _DIRECT and not self.whole:
            return nearly_solved(coupled(self.gram, stiff), right)
        blocks = [block + stiff if kind in (0, 3, 5) else block for kind, block in enumerate(self.gram.matrices())]
        rows = [[blocks[kind] for kind in line] for line in KIND]
        return solved(_joined(rows), right.T.reshape(-1, 1)).reshape(3, -1).T


def _joined(rows: list[list[Any]]) -> Floats | csr_array:
    """The matrix of three coordinates from its blocks."""
    if isinstance(rows[0][0], np.ndarray):
        return np.block(rows)
    return csr_array(scipy.sparse.block_array(rows))
