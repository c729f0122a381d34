"""Surface forms: scalar products of functions on X/H, and of their gradients, by area on X or on a surface in space."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array, diags_array

from orbiframe.errors import FitError
from orbiframe.functions.basis import Basis, DifferentiableBasis
from orbiframe.orbifolds.atlas import Points
from orbiframe.surfaces.surface import OrbifoldSurface
from orbiframe.surfaces.surface_integrals import Integration, over_faces, within

Floats = NDArray[np.float64]

_CHUNK = 1 << 14
# Gauss points along each direction: one more than the degree, and so many at least.
_LEAST = 6
# How little gradients count beyond a boundary, where nothing else holds the functions: integrals change by that share.
_BEYOND = 1e-8


@dataclass(frozen=True, eq=False)
class SurfaceForms:
    """Quadratic forms of functions on X/H.

    points: n Gauss points; weights: (n,), the area of each; metric: (n, 3), the entries 11, 12 and 22 of the inverse of
    the first fundamental form there, in the frames of X; drift: (n, 2), what the Laplacian of the surface takes away
    from the traces of covariant Hessians of X, as a vector along which to derive. Of a surface with a boundary all this
    is on the surface alone, where equations mean that nothing flows across the boundary; beyond: what `stiffness` has
    besides, so that functions that lie beyond are held, (size, size), None for a closed surface.

    >>> import numpy as np
    >>> from orbiframe import fit
    >>> from orbiframe.surfaces import SurfaceForms
    >>> forms = SurfaceForms.of(fit("dataset:torus", size=300).surface)
    >>> print(round(forms.area / (1.6 * np.pi**2), 3))  # the area of the torus with the radii 1 and 0.4
    1.0
    """

    basis: DifferentiableBasis
    points: Points
    weights: Floats
    metric: Floats
    drift: Floats
    beyond: csr_array | None = None

    @classmethod
    def of(
        cls, surface: OrbifoldSurface, basis: DifferentiableBasis | None = None, *, on_x: bool = False
    ) -> SurfaceForms:
        """The forms of the functions of a basis, by default those of the surface, on the surface or on X itself.

        Raises FitError for functions without derivatives.
        """
        chosen = surface.basis if basis is None else basis
        if not isinstance(chosen, DifferentiableBasis):
            raise FitError("this basis knows no derivatives, which gradients need; use one that does, such as 'ps6'")
        over, own, beyond = within(surface, chosen, _number(chosen)), surface.triangulation.inside, None
        if own is not None:
            beyond = _BEYOND * cls._on_x(chosen, over_faces(surface, np.flatnonzero(~own), 2)).stiffness
        if on_x:
            return replace(cls._on_x(chosen, over), beyond=beyond)
        _, first, second = surface.jet(over.points)
        e, f, g = (np.einsum("ni,ni->n", first[:, a], first[:, b]) for a, b in ((0, 0), (0, 1), (1, 1)))
        square = (over.area / over.area_on_x * surface.scale**2) ** 2
        metric = np.stack([g, -f, e], axis=1) / square[:, None]
        # The two connections differ by the tangential part of the covariant Hessian of the surface.
        bend = np.einsum("nk,nki,nai->na", metric * [1.0, 2.0, 1.0], second, first)
        return cls(chosen, over.points, over.area * surface.scale**2, metric, _raised(metric, bend), beyond)

    @classmethod
    def _on_x(cls, basis: DifferentiableBasis, over: Integration) -> SurfaceForms:
        count = len(over.area)
        return cls(basis, over.points, over.area_on_x, np.tile([1.0, 0.0, 1.0], (count, 1)), np.zeros((count, 2)))

    @property
    def area(self) -> float:
        """The area of the surface, or of X/H."""
        return float(self.weights.sum())

    @cached_property
    def mass(self) -> csr_array:
        """The integrals of b_i b_j, sparse (size, size)."""
        return self._sum((jets[0].T @ (diags_array(w) @ jets[0])) for jets, w, _ in self._parts(0))

    @cached_property
    def stiffness(self) -> csr_array:
        """The integrals of <grad b_i, grad b_j>, sparse (size, size)."""
        found = self._sum(_gradients(jets[1], jets[2], w[:, None] * metric) for jets, w, metric in self._parts(1))
        return found if self.beyond is None else csr_array(found + self.beyond)

    @cached_property
    def integrals(self) -> Floats:
        """The integrals of b_i, (size,)."""
        return self.against(self.weights)

    def against(self, weighted: Floats) -> Floats:
        """The integrals of b_i times a function that is given as values times weights at the Gauss points, (n,)."""
        parts = (jets[0].T @ weighted[chosen] for jets, chosen in self._rows())
        return np.asarray(sum(parts, start=np.zeros(self.basis.size)))

    def laplacians(self, coefficients: Floats) -> Floats:
        """The Laplacians (n, q) at the Gauss points of q functions with coefficients (size, q)."""
        parts = []
        for begin in range(0, len(self.weights), _CHUNK):
            chosen = slice(begin, begin + _CHUNK)
            part = Points(self.points.patch[chosen], self.points.x[chosen])
            parts.append(self._laplacians(self.basis.jets(part, coefficients, 2), chosen))
        return np.concatenate(parts)

    def _laplacians(self, jets: Floats, chosen: slice) -> Floats:
        bends = np.einsum("nk,knq->nq", self.metric[chosen] * [1.0, 2.0, 1.0], jets[3:])
        return np.asarray(bends - np.einsum("nk,knq->nq", self.drift[chosen], jets[1:3]))

    def _rows(self) -> Iterator[tuple[list[csr_array], slice]]:
        for begin in range(0, len(self.weights), _CHUNK):
            chosen = slice(begin, begin + _CHUNK)
            part = Points(self.points.patch[chosen], self.points.x[chosen])
            yield self.basis.jet_matrices(part, 0), chosen

    def _parts(self, order: int) -> Iterator[tuple[list[csr_array], Floats, Floats]]:
        for begin in range(0, len(self.weights), _CHUNK):
            chosen = slice(begin, begin + _CHUNK)
            part = Points(self.points.patch[chosen], self.points.x[chosen])
            yield self.basis.jet_matrices(part, order), self.weights[chosen], self.metric[chosen]

    def _sum(self, parts: Iterator[csr_array]) -> csr_array:
        return csr_array(sum(parts, start=csr_array((self.basis.size, self.basis.size))))


def _number(basis: Basis) -> int:
    return max(getattr(basis, "degree", 0) + 1, _LEAST)


def require_whole(surface: OrbifoldSurface) -> None:
    """Raise FitError for a surface with a boundary, where harmonic forms ask for conditions that are not built."""
    if surface.triangulation.inside is not None:
        raise FitError(
            "the surface has a boundary, and harmonic forms are those of closed surfaces; fit the mesh with its holes "
            "closed by faces, or ask for fields, integrals, `poisson`, `heat` and `spectrum`, which end at the boundary"
        )


def _raised(metric: Floats, covectors: Floats) -> Floats:
    """Covectors (n, 2) as vectors."""
    a, b, c = metric.T
    return np.stack([a * covectors[:, 0] + b * covectors[:, 1], b * covectors[:, 0] + c * covectors[:, 1]], axis=1)


def _gradients(first: csr_array, second: csr_array, metric: Floats) -> csr_array:
    """Sum of metric_ij d_i b d_j b over the points."""
    mixed = first.T @ (diags_array(metric[:, 1]) @ second)
    found = first.T @ (diags_array(metric[:, 0]) @ first) + second.T @ (diags_array(metric[:, 2]) @ second)
    return csr_array(found + mixed + mixed.T)
