"""Kinks: where splines with creases need not be smooth, the surface still has one tangent plane, as far as can be."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array, diags_array

from orbiframe import Basis, DifferentiableBasis
from orbiframe.splines import ElementBasis, hair_points

Floats = NDArray[np.float64]


class Kinks(NamedTuple):
    """At points of the hairs of a basis: the rows of the jump of the slope across, and of the two slopes beside it."""

    jump: csr_array
    across: csr_array
    slopes: tuple[csr_array, csr_array]

    @classmethod
    def of(cls, basis: Basis) -> Kinks | None:
        """Those of a basis on a domain with creases; None for any other."""
        if not isinstance(basis, ElementBasis) or basis.domain.crease is None:
            return None
        points = hair_points(basis.domain)
        return cls._between(basis, *points) if len(points.across) else None

    @classmethod
    def _between(cls, basis: DifferentiableBasis, inside, outside, across: Floats) -> Kinks:  # type: ignore[no-untyped-def]
        here, there = basis.jet_matrices(inside, 1), basis.jet_matrices(outside, 1)
        a, b = (diags_array(across[:, k]) for k in range(2))
        jump = a @ (here[1] - there[1]) + b @ (here[2] - there[2])
        slope = a @ (here[1] + there[1]) / 2 + b @ (here[2] + there[2]) / 2
        means = csr_array((here[1] + there[1]) / 2), csr_array((here[2] + there[2]) / 2)
        return cls(csr_array(jump), csr_array(slope), means)

    def seen(self, coefficients: Floats) -> tuple[Floats, Floats]:
        """The unit normals at the points, (n, 3), and the kinks there against the slope across, (n,): small angles."""
        normal = np.cross(self.slopes[0] @ coefficients, self.slopes[1] @ coefficients)
        normal /= np.maximum(np.linalg.norm(normal, axis=1), np.finfo(float).tiny)[:, None]
        size = np.linalg.norm(self.across @ coefficients, axis=1)
        kink = np.einsum("ni,ni->n", self.jump @ coefficients, normal)
        return normal, np.asarray(kink / np.maximum(size, np.finfo(float).tiny))
