"""Energy: how unfair functions are, as sparse rows and their weights."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from orbiframe import Basis, DifferentiableBasis, FitError, Samples

Floats = NDArray[np.float64]

# The default weight of the energy of each order, from measurements: docs/decisions/0015.
FAIRING = {2: 0.003, 3: 0.001}


class Energy(NamedTuple):
    """The integral of factor |D^order f|^2 over the surface in space: `factor` has length^(2 order).

    Order 2: D^2 f is the Laplacian; order 3: the gradient of the Laplacian. Those on X times stretch^(order / 2) are
    those on the surface. factor: (n,), for each sample, without the stretch.
    """

    order: int
    factor: Floats

    def weights(self, chosen: NDArray[np.intp] | slice, stretch: Floats) -> Floats:
        """The weights of the rows of some samples where the surface is stretched so much."""
        return np.asarray(self.factor[chosen] * stretch**self.order)

    def rows(self, jets: list[csr_array]) -> list[csr_array]:
        """The rows of samples from their jets of the order of the energy."""
        if self.order == 2:
            return [jets[3] + jets[5]]
        return [jets[6] + jets[8], jets[9] + jets[11]]


def energy_of(basis: Basis, samples: Samples) -> Energy:
    """The energy that belongs to samples, for a fairing of 1.

    Functions with one continuous derivative have no third one, so that their energy is of order 2. Raises FitError for
    a basis that does not know the derivatives that fairing needs.
    """
    if not isinstance(basis, DifferentiableBasis):
        raise FitError(
            f"{type(basis).__name__} does not know derivatives, which fairing needs; set fairing = 0 or choose "
            "another basis"
        )
    order = min(samples.order, 2 if basis.smoothness < 2 else 3)
    length = np.full(len(samples.weights), spacing(basis, samples)) if samples.length is None else samples.length
    return Energy(order, samples.shares * length ** (2 * order))


def spacing(basis: Basis, samples: Samples) -> float:
    """The distance of neighbouring functions in space: the root of the area of the surface per function."""
    stretched = float(samples.shares @ samples.stretch)
    if not stretched > 0:
        raise FitError("the stretch of all samples is zero, which fairing needs; set fairing = 0 or check the map")
    return float(np.sqrt(basis.orbifold.area * samples.shares.sum() / stretched / basis.size))
