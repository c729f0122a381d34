"""Data and their feet on a surface, and what a step of a sliding fit asks of each: distances, to second order."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import scipy.sparse
from numpy.typing import NDArray
from scipy.sparse import csr_array

from orbiframe import Points, Samples
from orbiframe.workers import in_threads

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]

# The entries of a symmetric form that are kept.
PAIRS = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))


class Schedule(NamedTuple):
    """How steps weigh against each other: fairing, damping of tangential motion, and least pull along the surface.

    bent: how much the curvature counts in the pull on data that are away from the surface.
    """

    fairing: float
    damping: float
    pull: float
    bent: float = 1.0


@dataclass(frozen=True, eq=False)
class Feet:
    """Data and their feet on the surface: the points, the matrices of their jets, and the jets, (6, n, 3)."""

    points: Points
    matrices: list[csr_array]
    jets: Floats
    gap: Floats

    @property
    def distance(self) -> Floats:
        """Of each datum from its foot, (n,)."""
        return np.asarray(np.linalg.norm(self.gap, axis=1))

    def under(self, coefficients: Floats, targets: Floats) -> Feet:
        """The same points on another surface."""
        jets = products(self.matrices, coefficients)
        return Feet(self.points, self.matrices, jets, targets - jets[0])

    def replaced(self, rows: Ints, other: Feet) -> Feet:
        """With the rows of another one, (k,) of them, in place of its own."""
        patch, x, jets, gap = self.points.patch.copy(), self.points.x.copy(), self.jets.copy(), self.gap.copy()
        patch[rows], x[rows], jets[:, rows], gap[rows] = other.points.patch, other.points.x, other.jets, other.gap
        order = np.arange(len(gap))
        order[rows] = len(gap) + np.arange(len(rows))
        pairs = zip(self.matrices, other.matrices, strict=True)
        return Feet(Points(patch, x), [_stacked(a, b)[order] for a, b in pairs], jets, gap)

    def take(self, rows: Ints) -> Feet:
        """Some of them."""
        points = Points(self.points.patch[rows], self.points.x[rows])
        return Feet(points, [matrix[rows] for matrix in self.matrices], self.jets[:, rows], self.gap[rows])


def away_from(feet: Feet, part: Samples) -> Floats:
    """The distances of data from the surface, of those that keep their parameters from its tangent planes."""
    if part.still is None:
        return feet.distance
    height = np.abs(np.einsum("ni,ni->n", feet.gap, _known_normals(feet, part)[0]))
    return np.where(_planes(part), height, feet.distance)


def _planes(part: Samples) -> Bools:
    """The data that keep their parameters, and of which distances from planes count."""
    assert part.still is not None
    return part.still if part.held is None else part.still & ~part.held


def _known_normals(feet: Feet, part: Samples) -> tuple[Floats, Floats]:
    """The unit normals (n, 3) of what the data lie on, where it is known, else of the surface; and its curvatures."""
    normal, curvature = normals_of(feet.jets)
    if part.normals is None:
        return normal, curvature
    unknown = np.isnan(part.normals)
    return np.where(unknown, normal, part.normals), curvature


def linearised(feet: Feet, part: Samples, schedule: Schedule) -> tuple[Floats, Floats]:
    """For each datum the six entries of its quadratic form, (n, 6), and its right side, (n, 3)."""
    weights, (normal, curvature) = part.weights, _known_normals(feet, part)
    away = schedule.bent * np.linalg.norm(feet.gap, axis=1) * curvature
    pull = np.maximum(schedule.pull, away / (1 + away))
    pull = pull if part.still is None else np.where(_planes(part), schedule.pull, pull)
    pull = pull if part.held is None else np.where(part.held, 1.0, pull)
    along = pull + schedule.damping
    form = np.stack([normal[:, a] * normal[:, b] for a, b in PAIRS], axis=1) * np.maximum(1 - along, 0)[:, None]
    form[:, [0, 3, 5]] += along[:, None]
    height = np.einsum("ni,ni->n", feet.gap, normal)
    wanted = normal * ((1 - pull) * height)[:, None] + pull[:, None] * feet.gap
    return weights[:, None] * form, weights[:, None] * wanted


def normals_of(jets: Floats) -> tuple[Floats, Floats]:
    """The unit normals (n, 3) and the larger principal curvatures (n,) of jets."""
    cross = np.cross(jets[1], jets[2])
    element = np.maximum(np.linalg.norm(cross, axis=1), np.finfo(float).tiny)
    normal = cross / element[:, None]
    e, f, g = (np.einsum("ni,ni->n", jets[a], jets[b]) for a, b in ((1, 1), (1, 2), (2, 2)))
    bend, twist, other = (np.einsum("ni,ni->n", jets[k], normal) for k in (3, 4, 5))
    with np.errstate(over="ignore"):
        mean = (e * other - 2 * f * twist + g * bend) / (2 * element**2)
        gaussian = (bend * other - twist**2) / element**2
        curvature = np.abs(mean) + np.sqrt(np.maximum(mean**2 - gaussian, 0))
    return normal, np.nan_to_num(curvature, posinf=np.finfo(float).max)


def products(matrices: list[csr_array], coefficients: Floats) -> Floats:
    """Matrices times coefficients, (m, n, d)."""
    return np.stack(list(in_threads(lambda matrix: np.asarray(matrix @ coefficients), matrices)))


def _stacked(a: csr_array, b: csr_array) -> csr_array:
    return csr_array(scipy.sparse.vstack([a, b], format="csr"))
