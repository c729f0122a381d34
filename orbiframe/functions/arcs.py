"""Arcs: what bent facets of a refined mesh stand for between their vertices."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from orbiframe.meshes.bisection import Bisection
from orbiframe.meshes.curving import Curving

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]


class Arcs(NamedTuple):
    """Arcs over the facets of a refined mesh with creases.

    height: (F,), the largest over each facet, 0 where it is flat; facet: (G,), that of every fine triangle; corners:
    (G, 3, 3), the barycentric coordinates of its corners there.
    """

    curving: Curving
    height: Floats
    facet: Ints
    corners: Floats

    @classmethod
    def of(cls, refinement: Bisection, crease: Bools) -> Arcs:
        """Those of a mesh with creases on its facets, (H,)."""
        curving, count = Curving.of(refinement.facets, crease), refinement.facets.face_count
        own = np.concatenate([np.tile(np.eye(3), (count, 1, 1)), np.zeros((count, 3, 1))], axis=2)
        own[:, :, 3] = np.arange(count)[:, None]
        fine = refinement.spread(own)
        return cls(curving, curving.sagittas, fine[:, 0, 3].round().astype(np.intp), fine[:, :, :3])

    @property
    def over_corners(self) -> Floats:
        """The heights of the arcs over the corners of the fine triangles, (G, 3): none over vertices of facets."""
        lifts = self._lifts(self.corners.reshape(-1, 3), np.repeat(self.facet, 3))
        return np.asarray(np.linalg.norm(lifts, axis=1)).reshape(-1, 3)

    def lifts(self, face: Ints, barycentric: Floats) -> Floats:
        """From points of fine triangles (n,) to the arcs over them, (n, 3)."""
        inside = np.einsum("nc,nck->nk", barycentric, self.corners[face])
        return self._lifts(inside, self.facet[face])

    def _lifts(self, barycentric: Floats, facet: Ints) -> Floats:
        return self.curving.lifts(facet, barycentric)
