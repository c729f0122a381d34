"""Hairs and seams from both sides: where a surface that is smooth between its creases may still have a kink."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from orbiframe.orbifolds.atlas import Points
from orbiframe.splines.sectors import Sectors
from orbiframe.splines.shared_edges import edge_normals
from orbiframe.triangulations.geodesic_triangulation import GeodesicTriangulation

Floats = NDArray[np.float64]

_SHARES = (0.05, 0.35, 0.65, 0.95)
_BESIDE = 1e-7


class HairPoints(NamedTuple):
    """Points of X/H on both sides of hairs and seams, and unit vectors across, (n, 2), in their frames."""

    inside: Points
    outside: Points
    across: Floats


def hair_points(domain: GeodesicTriangulation) -> HairPoints:
    """Some points of every hair and every seam of a triangulation with creases (see `Sectors`)."""
    geometry, share = domain.geometry, np.array(_SHARES)[:, None]
    smooth = Sectors(domain).hair
    smooth = smooth if domain.seam is None else smooth | domain.seam
    halfedge = np.flatnonzero(smooth & domain.reference)
    face, c = np.divmod(halfedge, 3)
    start, end, opposite = (domain.corners[face, (c + k) % 3][:, None] for k in range(3))
    on_edge = (1 - share) * start + share * end
    place = np.repeat(domain.placement[face], len(share), axis=0)
    patch = np.repeat(domain.patch[face], len(share))
    x = [
        geometry.settle(geometry.act(place, geometry.project(on_edge + way * (opposite - on_edge)).reshape(-1, 3)))
        for way in (0.0, _BESIDE, -_BESIDE)
    ]
    normal = np.repeat(edge_normals(domain)[face, c], len(share), axis=0)
    way = np.einsum("nij,nj->ni", place, normal)
    frame = geometry.frame(x[0])
    across = np.stack([geometry.inner(x[0], way, frame[..., k]) for k in range(2)], axis=1)
    across /= np.maximum(np.linalg.norm(across, axis=1), np.finfo(float).tiny)[:, None]
    return HairPoints(Points(patch, x[1]), Points(patch, x[2]), across)
