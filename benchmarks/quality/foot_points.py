"""Foot points: the nearest points of a skin, to the fourth order in the size of its triangles where it is smooth."""

from __future__ import annotations

from typing import NamedTuple

import igl
import numpy as np
from numpy.typing import NDArray

from quality.skins import Skin

Floats = NDArray[np.float64]


class FootPoints(NamedTuple):
    """The triangle (n,), barycentric coordinates (n, 3), and the points (n, 3) of the surface that belong to them."""

    face: NDArray[np.intp]
    barycentric: Floats
    points: Floats


def foot_points(skin: Skin, x: Floats) -> FootPoints:
    """The nearest points of the triangles, lifted by half of what the planes at the corners lie above them.

    On a quadric the half is what the surface itself bulges over its triangles (compare Phong tessellation, Boubekeur
    and Alexa 2008).
    """
    _, face, flat = igl.point_mesh_squared_distance(x, skin.vertices, skin.triangles.astype(np.int64))
    corners = skin.triangles[face]
    vertices, normals = skin.vertices[corners], skin.normals[corners]
    barycentric = _barycentric(flat, vertices)
    height = np.einsum("nci,nci->nc", flat[:, None] - vertices, normals)
    lift = np.einsum("nc,nc,nci->ni", barycentric, height, normals) / 2
    return FootPoints(face, barycentric, flat - lift)


def _barycentric(points: Floats, corners: Floats) -> Floats:
    a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    p = points - corners[:, 0]
    aa, ab, bb, pa, pb = ((s * t).sum(axis=1) for s, t in ((a, a), (a, b), (b, b), (p, a), (p, b)))
    det = aa * bb - ab**2
    det = np.where(det > 0, det, 1.0)
    s, t = (bb * pa - ab * pb) / det, (aa * pb - ab * pa) / det
    weights = np.clip(np.stack([1 - s - t, s, t], axis=1), 0, 1)
    return weights / weights.sum(axis=1, keepdims=True)
