"""Hodge decomposition: a 1-form as the differential of a function, the turned one of another, and a harmonic form."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_array, csr_array
from scipy.sparse.linalg import splu

from orbiframe.components.one_line import one_line
from orbiframe.errors import FitError
from orbiframe.orbifolds.atlas import Points
from orbiframe.splines.element_basis import ElementBasis
from orbiframe.surfaces.harmonic_forms import HarmonicForms, continuous_functions
from orbiframe.surfaces.surface import OrbifoldSurface
from orbiframe.surfaces.surface_forms import SurfaceForms, require_whole
from orbiframe.triangulations.cocycles import orientations

Floats = NDArray[np.float64]

_DEGREE = 6


class Decomposition(NamedTuple):
    """The parts of a 1-form: d alpha + * d beta + a harmonic form + what the functions miss.

    exact: (size,), the coefficients of alpha, which is known up to a constant; coexact: those of beta, None on a
    nonorientable surface, where * needs an orientation and this part is in the rest; harmonic: (b,), the factors of the
    harmonic forms; squares: the squared norms of the parts, "exact", "coexact", "harmonic" and "rest", which add up to
    that of the form.
    """

    exact: Floats
    coexact: Floats | None
    harmonic: Floats
    squares: dict[str, float]


@dataclass(frozen=True, eq=False)
class Hodge:
    """Hodge's decomposition of 1-forms on a surface in space, or on X/H: parts that are orthogonal to one another.

    forms: the scalar products, whose points are those where a 1-form is given; harmonic: the harmonic forms. Both are
    of continuous polynomials on the triangles of the functions of the surface.

    >>> import numpy as np
    >>> from orbiframe import fit
    >>> from orbiframe.surfaces import Hodge
    >>> surface = fit("dataset:torus", size=200).surface
    >>> hodge = Hodge.of(surface)
    >>> wind = np.cross([0, 0, 1], surface.evaluate(hodge.points))  # vectors in space; their tangential part counts
    >>> parts = hodge.decompose(wind).squares
    >>> parts["harmonic"] > parts["coexact"] > parts["exact"]
    True
    """

    surface: OrbifoldSurface
    forms: SurfaceForms
    harmonic: HarmonicForms

    __repr__ = one_line

    @classmethod
    def of(cls, surface: OrbifoldSurface, degree: int = _DEGREE, *, on_x: bool = False) -> Hodge:
        """On the surface in space, or on X/H itself. Raises FitError for a surface without derivatives."""
        require_whole(surface)
        basis = continuous_functions(surface, degree)
        forms = SurfaceForms.of(surface, basis, on_x=on_x)
        return cls(surface, forms, HarmonicForms.with_forms(basis, surface, on_x=on_x))

    @property
    def points(self) -> Points:
        """Where 1-forms are given: the Gauss points."""
        return self.forms.points

    def decompose(self, values: Floats | Callable[[Points], Floats]) -> Decomposition:
        """The parts of a 1-form.

        values: at `points`, or a function of them: (n, 2), the components along the frames of X, or (n, 3), vectors in
        space, whose scalar products with tangent vectors are meant. Raises FitError for other shapes, and for values
        that are not finite.
        """
        form = self._components(values(self.points) if callable(values) else values)
        exact = self._solved(form)
        parts = {"exact": self._gradients(exact)}
        coexact = None
        if self.surface.orbifold.orientable:
            coexact = -self._solved(self.turned(form))
            parts["coexact"] = self.turned(self._gradients(coexact))
        products = [self.product(form, each) for each in self._harmonic]
        harmonic = np.asarray(np.linalg.solve(self.harmonic.gram, products), dtype=np.float64)
        parts["harmonic"] = np.einsum("b,bni->ni", harmonic, self._harmonic)
        squares = {"coexact": 0.0} | {name: self.product(part, part) for name, part in parts.items()}
        rest = form - sum(parts.values())
        return Decomposition(exact, coexact, harmonic, squares | {"rest": self.product(rest, rest)})

    def product(self, first: Floats, second: Floats) -> float:
        """The integral of <first, second> for 1-forms at the points, (n, 2) each."""
        return float(np.einsum("n,ni,ni->", self.forms.weights, self._raised(first), second))

    def turned(self, form: Floats) -> Floats:
        """* of a 1-form at the points, (n, 2): turned by a right angle, * dx = dy. Of an orientable surface."""
        across = self._raised(form)[:, ::-1] * [-1.0, 1.0]
        return np.asarray(self._element[:, None] * across)

    def _raised(self, form: Floats) -> Floats:
        a, b, c = self.forms.metric.T
        return np.stack([a * form[:, 0] + b * form[:, 1], b * form[:, 0] + c * form[:, 1]], axis=1)

    def _components(self, values: Floats) -> Floats:
        found = np.asarray(values, dtype=np.float64)
        if found.shape not in ((len(self.forms.weights), 2), (len(self.forms.weights), 3)):
            raise FitError(
                f"the 1-form has values of shape {found.shape}; give two components or a vector in space at each of "
                f"the {len(self.forms.weights)} points `hodge.points`"
            )
        if not np.isfinite(found).all():
            bad = np.flatnonzero(~np.isfinite(found).all(axis=1))[0]
            raise FitError(f"the 1-form is {found[bad].tolist()} at point {bad}; its values must be finite")
        if found.shape[1] == 2:
            return found
        return np.asarray(np.einsum("nki,ni->nk", self.surface.jet(self.points).first, found))

    def _solved(self, form: Floats) -> Floats:
        """The function whose differential is nearest to a 1-form."""
        raised = self.forms.weights[:, None] * self._raised(form)
        right = self._slopes[0].T @ raised[:, 0] + self._slopes[1].T @ raised[:, 1]
        return np.append(0.0, self._solve(right[1:]))

    def _gradients(self, coefficients: Floats) -> Floats:
        return np.stack([slope @ coefficients for slope in self._slopes], axis=1)

    @cached_property
    def _slopes(self) -> list[csr_array]:
        """The derivatives of all functions along the frames at the points."""
        return self.forms.basis.jet_matrices(self.points, 1)[1:]

    @cached_property
    def _solve(self) -> Callable[[Floats], Floats]:
        inner = csc_array(csr_array(self.forms.stiffness)[1:, 1:])
        found: Callable[[Floats], Floats] = splu(
            inner, permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True}
        ).solve
        return found

    @cached_property
    def _harmonic(self) -> Floats:
        return self.harmonic.evaluate(self.points)

    @cached_property
    def _element(self) -> Floats:
        """The area of the frames, with the sign of their orientation, (n,)."""
        basis = self.forms.basis
        assert isinstance(basis, ElementBasis)
        sign = orientations(basis.domain) * np.sign(np.linalg.det(basis.domain.placement))
        a, b, c = self.forms.metric.T
        return np.asarray(np.repeat(sign * sign[0], len(a) // len(sign)) / np.sqrt(a * c - b * b))
