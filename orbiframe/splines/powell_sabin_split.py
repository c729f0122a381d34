"""The Powell-Sabin split: every triangle of a domain in six."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from orbiframe.triangulations.geodesic_triangulation import GeodesicTriangulation

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class PowellSabinSplit:
    """Every triangle in six, through its incentre Z and the points R where the segments Z Z' cross the edges.

    incentre: (F, 3), Z; edge_point: (F, 3, 3), R on every edge [triangle, edge, coordinate]; share: (F, 3, 2), mu and
    nu with R = mu v_c + nu v_(c + 1) and mu + nu = 1. Micro triangles 2 c and 2 c + 1 are (v_c, R_c, Z) and
    (v_(c + 1), R_c, Z).
    """

    domain: GeodesicTriangulation

    @cached_property
    def incentre(self) -> Floats:
        """The intersections of the bisectors: Z = (w1 - w2) x (w2 - w3) with edge covectors w of length 1."""
        x, k = self.domain.corners, self.domain.geometry.curvature
        covector = np.cross(x, np.roll(x, -1, axis=1))
        length = np.sqrt((covector**2 * np.array([k, 1.0, 1.0])).sum(axis=-1, keepdims=True))
        w = covector / length
        z = np.cross(w[:, 0] - w[:, 1], w[:, 1] - w[:, 2])
        return np.asarray(z / self.coordinates(z).sum(axis=1, keepdims=True))

    @cached_property
    def share(self) -> Floats:
        """Where the segments between neighbouring incentres cross their edge."""
        d = self.domain
        z = np.repeat(self.incentre, 3, axis=0)
        beyond = d.geometry.act(d.gluing, z[d.twin])
        plane = np.cross(z, beyond)
        start, end = d.corners.reshape(-1, 3), np.roll(d.corners, -1, axis=1).reshape(-1, 3)
        mu, nu = (plane * end).sum(axis=1), -(plane * start).sum(axis=1)
        return np.asarray(np.stack([mu, nu], axis=1) / (mu + nu)[:, None]).reshape(-1, 3, 2)

    @cached_property
    def edge_point(self) -> Floats:
        """R = mu v_c + nu v_(c + 1)."""
        x = self.domain.corners
        return np.asarray(self.share[..., :1] * x + self.share[..., 1:] * np.roll(x, -1, axis=1))

    @cached_property
    def micro_triangles(self) -> Floats:
        """The corners of the micro triangles, (F, 6, 3, 3)."""
        x, z = self.domain.corners, self.incentre
        micro_triangles = np.empty((self.domain.face_count, 6, 3, 3))
        for c in range(3):
            micro_triangles[:, 2 * c, 0], micro_triangles[:, 2 * c + 1, 0] = x[:, c], x[:, (c + 1) % 3]
            micro_triangles[:, 2 * c : 2 * c + 2, 1] = self.edge_point[:, c, None]
        micro_triangles[:, :, 2] = z[:, None]
        return micro_triangles

    @cached_property
    def around(self) -> Floats:
        """The split points in the star of every corner: R before, R after and Z, (F, 3, 3, 3)."""
        r = self.edge_point
        z = np.broadcast_to(self.incentre[:, None], r.shape)
        return np.stack([np.roll(r, 1, axis=1), r, z], axis=2)

    def coordinates(self, vectors: Floats) -> Floats:
        """The barycentric coordinates (F, 3) of one vector in every triangle, (F, 3)."""
        return np.asarray(np.linalg.solve(np.swapaxes(self.domain.corners, 1, 2), vectors[..., None])[..., 0])
