"""Jets of quotients phi / W from the jets of phi and W, by the rules of Leibniz."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

# Where the Hessian entry ij and the entry of its derivative along e_k stand in a jet of order 3.
_SECOND = {(1, 1): 3, (1, 2): 4, (2, 1): 4, (2, 2): 5}
_THIRD = {6 + 3 * (k - 1) + n: (k, *ij) for k in (1, 2) for n, ij in enumerate(((1, 1), (1, 2), (2, 2)))}


def divide_jets(jets: Floats, total: Floats, count: Ints) -> Floats:
    """The jets of phi / W; rows as `DifferentiableBasis.jet_matrices` has them, order 0 to 3.

    jets: (m, p), overwritten, the values of the first point, then those of the second and so on; total: (m, r), the jet
    of W at each point; count: (r,), how many values each point has.
    """
    jets *= np.repeat(1 / total[0], count)
    w = [np.repeat(row, count) for row in total / total[0]]
    for i in range(1, min(len(jets), 3)):
        jets[i] -= jets[0] * w[i]
    if len(jets) > 3:
        for row, (i, j) in enumerate(((1, 1), (1, 2), (2, 2)), start=3):
            jets[row] -= jets[i] * w[j] + jets[j] * w[i] + jets[0] * w[row]
    if len(jets) > 6:
        for row, (k, i, j) in _THIRD.items():
            for a, b, c in ((k, i, j), (i, k, j), (j, k, i)):
                jets[row] -= jets[a] * w[_SECOND[b, c]] + jets[_SECOND[b, c]] * w[a]
            jets[row] -= jets[0] * w[row]
    return jets
