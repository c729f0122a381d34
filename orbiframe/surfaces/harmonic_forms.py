"""Harmonic 1-forms: one in every class of cohomology, on X/H or on a surface in space."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from orbiframe.components.one_line import one_line
from orbiframe.components.registry import Registry
from orbiframe.errors import FitError
from orbiframe.functions.basis import Basis
from orbiframe.orbifolds.atlas import Points
from orbiframe.splines.condensation import least_energy
from orbiframe.splines.element_basis import ElementBasis
from orbiframe.splines.galerkin import stiffness
from orbiframe.splines.multivalued import branches, jumping
from orbiframe.surfaces.surface import OrbifoldSurface
from orbiframe.surfaces.surface_forms import SurfaceForms, require_whole
from orbiframe.triangulations.cocycles import cohomology, require_cocycles

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

_DEGREE = 6
FUNCTIONS = "bernstein"


@dataclass(frozen=True, eq=False)
class HarmonicForms:
    """b harmonic 1-forms du, each that of a multivalued function u of least energy among those of its class.

    basis: the continuous functions that were added; branches: polynomials on every triangle for itself; coefficients:
    (F n, b), the multivalued functions in `branches`; jumps: (b, 3 F), how far their branches are apart across the
    edges of the triangles, the periods of the forms along what crosses these; gram: (b, b), the scalar products of the
    forms.

    >>> from orbiframe import fit
    >>> from orbiframe.surfaces import HarmonicForms
    >>> forms = HarmonicForms.on_surface(fit("dataset:torus", size=200).surface)
    >>> forms.gram.shape  # a torus has two classes
    (2, 2)
    """

    basis: ElementBasis
    branches: ElementBasis
    coefficients: Floats
    jumps: Ints
    gram: Floats

    __repr__ = one_line

    @classmethod
    def on_x(cls, basis: ElementBasis, jumps: Ints | None = None) -> HarmonicForms:
        """Those of X/H. basis: continuous polynomials of even degree; jumps: (b, 3 F), by default those of all classes.

        Their energy is too large by a term like h^(2 degree). Raises FitError for other functions, TopologyError for
        jumps of no multivalued function.
        """
        space = branches(basis)
        return cls._least(basis, space, stiffness(space), jumps)

    @classmethod
    def on_surface(cls, surface: OrbifoldSurface, degree: int = _DEGREE, jumps: Ints | None = None) -> HarmonicForms:
        """Those of a surface in space, on the triangles of its functions, or of as many functions where it has none."""
        return cls.with_forms(continuous_functions(surface, degree), surface, jumps=jumps)

    @classmethod
    def with_forms(
        cls, basis: ElementBasis, surface: OrbifoldSurface, *, on_x: bool = False, jumps: Ints | None = None
    ) -> HarmonicForms:
        """Those of a surface in space, or of X/H, by the scalar products of `SurfaceForms`."""
        require_whole(surface)
        space = branches(basis)
        return cls._least(basis, space, SurfaceForms.of(surface, space, on_x=on_x).stiffness, jumps)

    @classmethod
    def _least(cls, basis: ElementBasis, space: ElementBasis, energy: csr_array, jumps: Ints | None) -> HarmonicForms:
        """The multivalued functions of least energy, which is given on all branches."""
        chosen = cohomology(basis.domain) if jumps is None else np.asarray(jumps, dtype=np.intp)
        require_cocycles(basis.domain, chosen)
        found = least_energy(basis, energy, jumping(basis, chosen))
        gram = found.T @ (energy @ found)
        return cls(basis, space, found, chosen, (gram + gram.T) / 2)

    @property
    def count(self) -> int:
        """How many there are."""
        return len(self.jumps)

    def evaluate(self, points: Points) -> Floats:
        """Their components along the frames of X at points, (b, n, 2)."""
        return np.moveaxis(self.branches.jets(points, self.coefficients, 1)[1:3], (0, 2), (2, 0))

    def potentials(self, points: Points) -> Floats:
        """The multivalued functions at points, (n, b); each is known up to a whole number alone."""
        return self.branches.values(points, self.coefficients)

    def combined(self, factors: Ints) -> HarmonicForms:
        """Sums of them with whole factors (k, b)."""
        both = self.coefficients @ factors.T, factors @ self.jumps, factors @ self.gram @ factors.T
        return HarmonicForms(self.basis, self.branches, *both)


def continuous_functions(surface: OrbifoldSurface, degree: int) -> ElementBasis:
    """Continuous polynomials on the triangles of the functions of a surface, or of its map where these have none."""
    basis: Basis = surface.basis
    # Continuous functions need not know where the surface has creases.
    domain = replace(basis.domain, crease=None) if isinstance(basis, ElementBasis) else surface.triangulation
    size = basis.size * degree**2 // 2
    made = Registry.discover().load("basis", FUNCTIONS)(surface.orbifold, domain, degree=degree, size=size)
    if not isinstance(made, ElementBasis):
        raise FitError(f"the functions '{FUNCTIONS}' are no piecewise polynomials; remove the plugin that hides them")
    return made
