"""Fields: functions on a surface in space, from values at points of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csr_array

from orbiframe.components.one_line import one_line
from orbiframe.components.registry import Registry
from orbiframe.errors import FitError
from orbiframe.functions.basis import Basis, chunks_of
from orbiframe.functions.fitter import Fitter, ValidatedFitter
from orbiframe.functions.samples import Samples
from orbiframe.orbifolds.atlas import Points
from orbiframe.surfaces.border import inside
from orbiframe.surfaces.nearest import nearest_points
from orbiframe.surfaces.surface import OrbifoldSurface
from orbiframe.surfaces.surface_integrals import integration, within

Floats = NDArray[np.float64]

_BEYOND = 1e-2
# Gauss points of integrals along each direction of a triangle.
_GAUSS = 6
FITTER = "smoothing"


@dataclass(frozen=True, eq=False)
class Field:
    """q smooth functions on a surface.

    basis and coefficients (size, q): the functions, but for shift (q,) and scale (q,): a value v is shift + scale * v.
    points: where the data lie on X/H; distance: (n,), how far from the surface in space they are; left_out: (n, q),
    what each datum is beyond the field of all others, None where the fitter does not tell; fairing and freedom: how
    much was smoothed and how many numbers were taken from the data; noise: (q,), the standard deviation of the data;
    trust: (n,), how far each datum was believed, from 1 to 0; outliers: the numbers of data that are far off;
    deviation: see `standard_error`; None likewise.
    """

    surface: OrbifoldSurface
    basis: Basis
    coefficients: Floats
    shift: Floats
    scale: Floats
    points: Points
    distance: Floats
    left_out: Floats | None = None
    fairing: float | None = None
    freedom: float | None = None
    noise: Floats | None = None
    trust: Floats | None = None
    outliers: NDArray[np.intp] | None = None
    deviation: Callable[[csr_array], Floats] | None = None

    __repr__ = one_line

    def evaluate(self, points: Points) -> Floats:
        """The values (n, q) over points of X/H."""
        return np.asarray(self.shift + self.scale * self.basis.values(points, self.coefficients))

    def standard_error(self, points: Points) -> Floats:
        """The standard errors (n, q) of the values over points of X/H.

        The posterior standard deviation of the smoothing spline (Wahba, 1983), whose scale is what the data are beyond
        the fields of all others: so bars of 1.96 of them hold the function itself, not the next datum, at about 95 % of
        the places. Raises FitError for a fitter that does not tell.
        """
        if self.deviation is None:
            raise FitError("this fitter tells no standard errors; take the fitter 'smoothing' or 'robust'")
        parts = [self.deviation(self.basis.design_matrix(part)) for part in chunks_of(points)]
        return np.asarray(self.scale * np.concatenate(parts))

    def integral(self) -> Floats:
        """The integrals (q,) of the functions over the surface, by its area in space."""
        over = within(self.surface, self.basis, _GAUSS)
        return np.asarray(over.area @ self.evaluate(over.points) * self.surface.scale**2)

    def mean(self) -> Floats:
        """The means (q,) of the functions over the surface, by its area in space."""
        over = within(self.surface, self.basis, _GAUSS)
        return np.asarray(over.area @ self.evaluate(over.points) / over.area.sum())

    @property
    def error(self) -> Floats | None:
        """The root mean square (q,) of what is wrong at a datum that the field does not know: leave-one-out.

        Outliers, and data that are met exactly, do not count.
        """
        if self.left_out is None:
            return None
        counted = np.isfinite(self.left_out[:, 0])
        if self.outliers is not None:
            counted[self.outliers] = False
        return np.asarray(np.sqrt(np.mean(self.left_out[counted] ** 2, axis=0)))


def fit_field(
    surface: OrbifoldSurface,
    points: Points | ArrayLike,
    values: ArrayLike,
    *,
    fitter: Fitter | None = None,
    basis: Basis | None = None,
    gradients: ArrayLike | None = None,
    fixed: ArrayLike | None = None,
) -> Field:
    """The smooth functions on a surface that have about these values at these points.

    points: n points of X/H, or (n, 3) points in space, whose nearest points on the surface are meant; values: (n,) or
    (n, q). fitter: by default the installed one called "smoothing", which finds from the data how much they are to be
    smoothed; basis: functions on the same X/H, by default those of the surface. Fairness is asked for all over the
    surface and in its metric, so that few data are joined without ripples.

    gradients: vectors in space at the points, (n, 3) or (n, 3, q), whose tangential part is the gradient of the
    function there, nan where it is not known: data as well (Hermite). fixed: (n,), true for data that are met exactly,
    with their gradients. To meet all, take `smoothing` with the option interpolate. Raises FitError for shapes that do
    not fit, for values that are not finite, and where the fitter does.

    >>> import numpy as np
    >>> from orbiframe import fit
    >>> surface = fit("dataset:torus", size=100).surface
    >>> t = np.linspace(0, 20, 60)
    >>> places = np.column_stack([np.cos(t) + 0.4 * np.cos(t), np.sin(t) + 0.4 * np.sin(t), 0 * t])
    >>> field = surface.fit_field(places, np.full(60, 3.0))  # few data are joined calmly
    >>> points = surface.points([0, 5], [[1, 0, 0], [0, 1, 0]])
    >>> print(field.evaluate(points).ravel().round(6))
    [3. 3.]
    """
    basis = surface.basis if basis is None else basis
    if isinstance(points, Points):
        places, distance = points, np.zeros(len(points.patch))
    else:
        places, distance = nearest_points(surface, np.asarray(points, dtype=np.float64))
    wanted = _columns(values, len(places.patch))
    shift, spread = wanted.mean(axis=0), wanted.std(axis=0)
    scale = np.where(spread > 1e-14 * np.abs(shift), spread, 1.0)
    samples = _samples(surface, basis, places, (wanted - shift) / scale)
    if gradients is not None:
        samples = replace(samples, slopes=_slopes(surface, places, gradients, scale, len(samples.weights)))
    if fixed is not None:
        samples = replace(samples, fixed=_marks(fixed, len(wanted), len(samples.weights)))
    chosen: Fitter = Registry.discover().load("fitter", FITTER)() if fitter is None else fitter
    if not isinstance(chosen, ValidatedFitter):
        return Field(surface, basis, chosen.fit(basis, samples), shift, scale, places, distance)
    found = chosen.fit_validated(basis, samples)
    own = slice(0, len(wanted))
    return Field(
        surface,
        basis,
        found.coefficients,
        shift,
        scale,
        places,
        distance,
        found.left_out[own] * scale,
        found.fairing,
        found.freedom,
        None if found.noise is None else found.noise * scale,
        None if found.trust is None else found.trust[own],
        None if found.outliers is None else np.flatnonzero(found.outliers[own]),
        found.deviation,
    )


def _slopes(surface: OrbifoldSurface, places: Points, gradients: ArrayLike, scale: Floats, count: int) -> Floats:
    """Derivatives along the frames of X, (count, q, 2), from gradients in space; nan where there are none."""
    given = np.asarray(gradients, dtype=np.float64)
    vectors = given[:, :, None] if given.ndim == 2 else given
    if vectors.shape != (len(places.patch), 3, len(scale)):
        raise FitError(
            f"the gradients have the shape {given.shape}; {len(places.patch)} points with {len(scale)} values need "
            "(n, 3) or (n, 3, q), nan where a gradient is not known"
        )
    found = np.full((count, len(scale), 2), np.nan)
    found[: len(vectors)] = np.einsum("nki,niq->nqk", surface.jet(places).first, vectors) / scale[:, None]
    return found


def _marks(fixed: ArrayLike, own: int, count: int) -> NDArray[np.bool_]:
    """Which samples are fixed, (count,)."""
    given = np.asarray(fixed)
    if given.shape != (own,) or given.dtype != np.bool_:
        raise FitError(
            f"fixed has the shape {given.shape} and the type {given.dtype}; it must be {own} times true or false"
        )
    return np.concatenate([given, np.zeros(count - own, dtype=np.bool_)])


def _columns(values: ArrayLike, count: int) -> Floats:
    """The values as columns, (n, q)."""
    found = np.asarray(values, dtype=np.float64)
    columns = found[:, None] if found.ndim == 1 else found
    if columns.ndim != 2 or len(columns) != count or not columns.size:
        raise FitError(f"{count} points have values of shape {found.shape}; they must be (n,) or (n, q), n at least 1")
    bad = np.flatnonzero(~np.isfinite(columns).all(axis=1))
    if len(bad):
        raise FitError(f"the value of point {bad[0]} is {columns[bad[0]].tolist()}; it must be finite: leave it out")
    return columns


def _samples(surface: OrbifoldSurface, basis: Basis, places: Points, values: Floats) -> Samples:
    """The data, which stand for the area in equal shares, and places all over the surface where fairness counts."""
    over, count = integration(surface, basis), len(values)
    # Beyond a boundary there are no data, and fairness is asked for only as far as the functions need it.
    fair = np.where(inside(surface, over.points), 1.0, _BEYOND)
    added, columns = len(over.area), values.shape[1]
    return Samples(
        Points(np.concatenate([places.patch, over.points.patch]), np.concatenate([places.x, over.points.x])),
        np.concatenate([values, np.zeros((added, columns))]),
        np.concatenate([np.full(count, fair @ over.area / count), np.zeros(added)]),
        np.concatenate([np.ones(count), over.stretch]),
        np.concatenate([np.zeros(count), fair * over.area]),
        order=3,
    )
