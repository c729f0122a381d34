"""Skins: a surface as a fine triangle mesh whose vertices lie on it, with normals and curvature at the vertices."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array, eye_array

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

_NEIGHBOURS = 24


class Skin(NamedTuple):
    """Vertices (n, 3), triangles (m, 3), unit normals (n, 3) up to sign, Gaussian curvature (n,)."""

    vertices: Floats
    triangles: Ints
    normals: Floats
    gaussian: Floats


def measured_skin(vertices: Floats, triangles: Ints) -> Skin:
    """A skin with normals and curvature from cubic polynomials through the two rings about every vertex."""
    return Skin(vertices, triangles, *shapes_at_vertices(vertices, triangles))


def shapes_at_vertices(vertices: Floats, triangles: Ints) -> tuple[Floats, Floats]:
    """Normals and Gaussian curvature by least squares: a height of degree 3 over a plane that is nearly tangent."""
    near = _rings(len(vertices), triangles)
    frame = _frames(vertices, near)
    local = np.einsum("nki,nji->nkj", vertices[near] - vertices[:, None], frame)
    size = np.sqrt((local[..., :2] ** 2).sum(axis=2).mean(axis=1))
    size = np.where(size > 0, size, 1.0)
    p, q, xx, xy, yy = _cubic(local / size[:, None, None])[:, :5].T
    slope = 1 + p**2 + q**2
    normal = np.einsum("jn,nji->ni", np.stack([-p, -q, np.ones_like(p)]), frame) / np.sqrt(slope)[:, None]
    return normal, (4 * xx * yy - xy**2) / (slope * size) ** 2


def _rings(count: int, triangles: Ints) -> Ints:
    """The two rings of every vertex (n, 24), filled up with itself; of larger ones every second, third, ... vertex."""
    a, b = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]).T
    one = csr_array((np.ones(2 * len(a)), (np.r_[a, b], np.r_[b, a])), shape=(count, count))
    two = csr_array(one + one @ one + eye_array(count))
    size = np.diff(two.indptr)
    place = np.arange(_NEIGHBOURS)[None] * np.maximum(size[:, None] / _NEIGHBOURS, 1)
    inside = place < size[:, None]
    index = two.indptr[:-1, None] + np.where(inside, place, 0).astype(np.intp)
    return np.where(inside, two.indices[index], np.arange(count)[:, None])


def _frames(vertices: Floats, near: Ints) -> Floats:
    """Two tangents and a normal (n, 3, 3): the principal axes of the neighbours."""
    offset = vertices[near] - vertices[:, None]
    _, axes = np.linalg.eigh(np.einsum("nki,nkj->nij", offset, offset))
    return np.moveaxis(axes[..., ::-1], 2, 1)


def _cubic(local: Floats) -> Floats:
    """Coefficients (n, 9) of x, y, x^2, xy, y^2, x^3, x^2 y, x y^2, y^3."""
    x, y, z = np.moveaxis(local, 2, 0)
    rows = np.stack([x, y, x * x, x * y, y * y, x**3, x * x * y, x * y * y, y**3], axis=2)
    matrix = np.einsum("nka,nkb->nab", rows, rows) + 1e-10 * np.eye(9)
    return np.linalg.solve(matrix, np.einsum("nka,nk->na", rows, z)[..., None])[..., 0]
