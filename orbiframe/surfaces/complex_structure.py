"""Period matrices: the complex structure of an orientable surface, as a point of Siegel's upper half space."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from orbiframe.components.one_line import one_line
from orbiframe.errors import TopologyError
from orbiframe.surfaces.harmonic_forms import HarmonicForms
from orbiframe.triangulations.cocycles import intersections
from orbiframe.triangulations.symplectic_basis import standard_form, symplectic_basis

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]


@dataclass(frozen=True, eq=False)
class PeriodMatrix:
    """The periods of holomorphic 1-forms along b_1, ..., b_g whose periods along a_1, ..., a_g are 1 and 0.

    matrix: (g, g), symmetric with a positive definite imaginary part (Riemann); error: a bound of how far an entry is
    off, but for quadrature and rounding; forms: the 2 g harmonic forms whose periods along the cycles a_1, ..., b_g are
    1 and 0, in this order.
    """

    matrix: Complexes
    error: float
    forms: HarmonicForms

    __repr__ = one_line

    def holomorphic(self) -> Complexes:
        """The g holomorphic forms as combinations of the forms: (g, 2 g), those along a and those along b."""
        return np.concatenate([np.eye(len(self.matrix)), self.matrix], axis=1)


def period_matrix(forms: HarmonicForms) -> PeriodMatrix:
    """The period matrix of the surface of harmonic forms, in their own basis where that is symplectic, else in one.

    With the periods p along a and q along b, the energy of a harmonic form is p Y p + (X p - q) Y^-1 (X p - q) for the
    matrix X + i Y. So the scalar products tell it. Those in a space of functions are too large; J^T E^-1 J is too small
    for the same reason, J the intersection form, and in between lies their geometric mean, which alone meets Riemann's
    bilinear relations; the error is the distance of the two. Raises TopologyError for a nonorientable surface, and for
    a sphere, which has no harmonic forms.
    """
    if not forms.count:
        raise TopologyError("a sphere has no harmonic 1-forms, and so no period matrix; take a surface with handles")
    crossing = intersections(forms.basis.domain, forms.jumps)
    wanted = standard_form(forms.count // 2)
    if not np.array_equal(crossing, wanted):
        forms = forms.combined(symplectic_basis(crossing))
    turned = np.linalg.solve(wanted, forms.gram)
    upper, lower = forms.gram, wanted.T @ np.linalg.solve(forms.gram, wanted)
    # (-turned^2)^(1/2) is 1 for the exact form; dividing by it leaves what squares to -1.
    middle = np.real(wanted @ turned @ np.linalg.inv(scipy.linalg.sqrtm(-turned @ turned)))
    error = np.abs(_periods(upper) - _periods(lower)).max()
    found = _periods((middle + middle.T) / 2)
    return PeriodMatrix((found + found.T) / 2, float(error), forms)


def _periods(energy: Floats) -> Complexes:
    """X + i Y from the energies (A, B; B^T, D): Y = D^-1 and X = -B Y."""
    half = len(energy) // 2
    imaginary = np.linalg.inv(energy[half:, half:])
    return np.asarray(-energy[:half, half:] @ imaginary + 1j * imaginary)
