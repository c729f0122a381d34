"""TensorBasis: products of periodic B-splines on a flat torus or Klein bottle."""

from __future__ import annotations

from abc import abstractmethod

import numpy as np
from numpy.typing import NDArray

from orbiframe.functions.basis import PiecewiseBasis
from orbiframe.orbifolds.flat_lattice import FlatLattice

Floats = NDArray[np.float64]


class TensorBasis(PiecewiseBasis):
    """A basis that knows the control net of its combinations: sum of P_ij N_i(u) N_j(v) in lattice coordinates.

    lattice: the coordinates; degree: in both directions; knots: those of one period, rising, in u and in v. The period
    is 1, and 2 in u on a Klein bottle, whose double cover the net covers. N_j has the knots j, ..., j + degree + 1.
    """

    lattice: FlatLattice
    degree: int

    @property
    @abstractmethod
    def knots(self) -> tuple[Floats, Floats]:
        """The knots of one period in u and in v."""

    @abstractmethod
    def net(self, coefficients: Floats) -> Floats:
        """The control points (n_u, n_v, q) of q functions from their coefficients (size, q)."""
