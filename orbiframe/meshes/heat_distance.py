"""Heat distances: how far the vertices of a triangle mesh are from some of them, by the flow of heat."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csc_array, diags_array
from scipy.sparse.linalg import splu

from orbiframe.errors import GeometryError
from orbiframe.meshes.polyhedron import Polyhedron

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

# The mass that makes the Laplacian invertible, as a share: constants are taken away afterwards.
_ANCHOR = 1e-10
# Heat falls by e over the root of the time: no less than the extent over this, lest heat far away is rounding.
_SHARPEST = 150


def heat_distances(mesh: Polyhedron, start: Ints, time: float = 1.0) -> Floats:
    """The distance (V,) from the vertices `start`, whose mean is 0, on a connected triangle mesh.

    Heat that has flowed for a short time from the start falls in the direction away from it; the distance is the
    function whose gradient is nearest to unit vectors of that direction. time: in squares of the mean length of edges,
    and no less than makes heat far away a number.
    Smooth, and a few percent off, most beyond two ways of equal length; see `front_distances`. Raises GeometryError for
    triangles without area.

    Source: K. Crane, C. Weischedel and M. Wardetzky, Geodesics in heat, ACM Transactions on Graphics 32 (2013).
    """
    corners, count = mesh.triangles, len(mesh.vertices)
    ends = mesh.vertices[corners]
    # Edge k is opposite corner k.
    edges = np.roll(ends, 1, axis=1) - np.roll(ends, -1, axis=1)
    cross = np.cross(edges[:, 0], edges[:, 1])
    double = np.linalg.norm(cross, axis=1)
    flat = np.flatnonzero(~(double > 0))
    if len(flat):
        raise GeometryError(f"triangle {flat[0]} has no area; the flow of heat needs some: repair the mesh")
    slopes = np.cross((cross / double[:, None])[:, None], edges) / double[:, None, None]
    local = np.einsum("fai,fbi->fab", slopes, slopes) * double[:, None, None] / 2
    row, column = np.repeat(corners, 3, axis=1).ravel(), np.tile(corners, 3).ravel()
    stiff = csc_array(coo_array((local.ravel(), (row, column)), shape=(count, count)))
    mass = diags_array(np.bincount(corners.ravel(), np.repeat(double / 6, 3), count))
    least = float(np.linalg.norm(np.ptp(mesh.vertices, axis=0))) / _SHARPEST
    step = max(time * float(np.mean(np.linalg.norm(edges, axis=2))) ** 2, least**2)
    hot = np.zeros(count)
    hot[start] = 1.0
    warm = _solved(csc_array(mass + step * stiff), hot)
    fall = -np.einsum("fa,fai->fi", warm[corners], slopes)
    length = np.linalg.norm(fall, axis=1, keepdims=True)
    unit = fall / np.where(length > 0, length, 1.0)
    shares = np.einsum("fai,fi->fa", slopes, unit) * double[:, None] / 2
    right = np.bincount(corners.ravel(), shares.ravel(), count).astype(np.float64)
    scale = _ANCHOR * stiff.diagonal().mean() / mass.diagonal().mean()
    found = _solved(csc_array(stiff + scale * mass), right)
    return np.asarray(found - found[start].mean())


def _solved(matrix: csc_array, right: Floats) -> Floats:
    return np.asarray(
        splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}).solve(right)
    )
