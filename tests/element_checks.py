"""What families of splines have in common: reproduction, smoothness seen from outside, eigenvalues, orders."""

from __future__ import annotations

import numpy as np
import spline_checks
from orbiframe_geometries.h2 import H2
from scipy.sparse import csc_array, diags_array
from scipy.sparse.linalg import eigsh, splu

from orbiframe import Basis, DifferentiableBasis, Orbifold, Points
from orbiframe.functions import OrbitSumBasis
from orbiframe.groups import PolygonGroup, regular_polygon
from orbiframe.splines import ElementBasis, coefficient_count, symmetric_power
from orbiframe.splines.galerkin import mass, stiffness
from orbiframe.triangulations import GeodesicTriangulation
from orbiframe.words.word import Word

# The first eigenvalue of the Bolza surface (Strohmaier and Uski, 2013).
BOLZA = 3.8388872588421995


def bolza(refinements: int) -> GeodesicTriangulation:
    """The regular octagon in 16 triangles through centre, corners and midpoints of sides, each in 4^refinements."""
    geometry, word = H2(), Word.parse("abcdABCD")
    sides = regular_polygon(geometry, word)
    orbifold = Orbifold(PolygonGroup(sides).atlas(), word.euler_characteristic, word.orientable, sides.area)
    v, w = sides.vertices, sides.heads
    middle, origin = geometry.project(v + w), np.broadcast_to(geometry.origin, v.shape)
    corners = np.concatenate([np.stack([origin, v, middle], axis=1), np.stack([origin, middle, w], axis=1)])
    domain = spline_checks.glued(orbifold, corners, np.concatenate([np.eye(3)[None], sides.pairings]))
    for _ in range(refinements):
        domain = domain.refined()
    return domain


def first_eigenvalue(basis: ElementBasis) -> float:
    """The smallest positive eigenvalue of -Delta in the span of the functions."""
    return float(np.sort(eigsh(stiffness(basis), 3, mass(basis), sigma=1.0)[0])[1])


def condition(basis: ElementBasis) -> float:
    """The condition of the mass matrix with ones on its diagonal."""
    matrix = mass(basis).toarray()
    scale = 1 / np.sqrt(np.diag(matrix))
    values = np.linalg.eigvalsh(scale[:, None] * matrix * scale)
    return float(values[-1] / values[0])


def residual_on_the_sphere(basis: ElementBasis, degree: int) -> float:
    """How far homogeneous polynomials on R^3 of this degree are from being numerators on the whole sphere."""
    d = basis.domain
    corners = d.placement[:, None] @ np.swapaxes(basis.micro_triangles, 2, 3)
    wanted = symmetric_power(corners, degree).reshape(-1, coefficient_count(degree))
    return _residual(basis.matrix.toarray(), wanted)


def residual_on_one_triangle(basis: ElementBasis) -> float:
    """How far all polynomials of the degree are from being the numerators of some function on one triangle."""
    rows = basis.matrix[: basis.micro_triangles.shape[1] * coefficient_count(basis.degree)].toarray()
    cells = np.swapaxes(basis.micro_triangles[0], 1, 2)
    return _residual(rows, symmetric_power(cells, basis.degree).reshape(len(rows), -1))


def _residual(matrix: np.ndarray, wanted: np.ndarray) -> float:
    found = np.linalg.lstsq(matrix, wanted, rcond=1e-13)[0]
    return float(np.abs(matrix @ found - wanted).max() / np.abs(wanted).max())


class _Bump(OrbitSumBasis):
    """exp(-30 t), as good as zero where it ends."""

    smoothness = 100

    def profile(self, t: np.ndarray) -> tuple[np.ndarray, ...]:
        f = np.where(t < 1, np.exp(-30 * t), 0)
        return f, -30 * f, 900 * f


def bumps(domain: GeodesicTriangulation) -> Basis:
    """Three smooth functions about three triangles of a coarse triangulation, with sum 1."""
    middle = domain.geometry.project(domain.corners[:3].mean(axis=1))
    centres = Points(domain.patch[:3], domain.geometry.act(domain.placement[:3], middle))
    return _Bump(domain.orbifold, centres, np.full(3, 3 * domain.orbifold.area))


def spread_points(domain: GeodesicTriangulation, count: int) -> Points:
    """So many random points in every triangle."""
    face = np.repeat(np.arange(domain.face_count), count)
    share = np.random.default_rng(1).dirichlet(np.ones(3), len(face))
    x = domain.geometry.project(np.einsum("nc,nci->ni", share, domain.corners[face]))
    return Points(domain.patch[face], domain.geometry.settle(domain.geometry.act(domain.placement[face], x)))


def error_of_fit(basis: Basis, domain: GeodesicTriangulation, wanted: Basis, count: int) -> float:
    """The root mean square error of the least squares fit to a bump, relative to its size."""
    points = spread_points(domain, count)
    matrix, values = basis.design_matrix(points), wanted.design_matrix(points).toarray()[:, 0]
    scale = 1 / np.sqrt(np.maximum(matrix.power(2).sum(axis=0), 1e-300))
    scaled = csc_array(matrix @ diags_array(scale))
    solve = splu(csc_array(scaled.T @ scaled)).solve
    residual = values
    for _ in range(2):
        residual = residual - scaled @ solve(scaled.T @ residual)
    return float(np.sqrt((residual**2).mean() / (values**2).mean()))


def jumps_of_jets(basis: DifferentiableBasis, domain: GeodesicTriangulation, order: int, step: float = 1e-7) -> float:
    """The largest jump of the derivatives of order 0, 1 or 2 across edges, relative to their size, by jets.

    At points on both sides in the frame of the triangle of the halfedge, so that the basis itself has to find the way
    across; as tensors in R^3, since the frames of neighbouring points need not be near.
    """
    geometry = domain.geometry
    x, y, z = (np.roll(domain.corners, -k, axis=1).reshape(-1, 3) for k in range(3))
    face = np.arange(len(x)) // 3
    found = []
    for side in (step, -step):
        inside = geometry.act(domain.placement[face], geometry.project(0.58 * x + 0.42 * y + side * (z - (x + y) / 2)))
        points = Points(domain.patch[face], geometry.settle(inside))
        found.append(_tensors(basis, points, order))
    return float(np.abs(found[0] - found[1]).max() / np.abs(found[0]).max())


def _tensors(basis: DifferentiableBasis, points: Points, order: int) -> np.ndarray:
    jets = [m.toarray() for m in basis.jet_matrices(points, order)]
    frame = basis.orbifold.geometry.frame(points.x)
    if order == 0:
        return np.asarray(jets[0])
    if order == 1:
        return np.asarray(np.einsum("nik,knf->nif", frame, np.stack(jets[1:])))
    hessian = np.stack([jets[3], jets[4], jets[4], jets[5]]).reshape(2, 2, *jets[3].shape)
    return np.asarray(np.einsum("nik,njl,klnf->nijf", frame, frame, hessian))
