"""Face colours: each face of a file for CAD gets the colour of the input faces of which it covers most."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from orbiframe import OrbifoldSurface
from orbiframe.meshes import grid_of
from orbiframe.triangulations import Locator
from orbiframe_exact.quad_domain import QuadDomain

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

# About so many places are looked at for every face, in each triangle of the input between one and so many squared.
_LOOKS, _MOST_ASIDE = 400, 12
# A face of which so much has another colour than it gets is divided.
_DIVIDED = 0.02


@dataclass(frozen=True, eq=False)
class FaceColours:
    """rgb: (G, 3), the colour of every group of triangles (`QuadDomain.pair`), from 0 to 1; share: (G,), the part of
    its area that has this colour.
    """

    rgb: Floats
    share: Floats

    @property
    def divided(self) -> int:
        """How many faces have another colour on more than 2 % of their area."""
        return int((self.share < 1 - _DIVIDED).sum())


def face_colours(surface: OrbifoldSurface, domain: QuadDomain) -> FaceColours | None:
    """The colours of the faces over quadrilaterals; None where the input has none.

    Those of vertices count for a face of the input as their mean. Places all over the triangles of the input are found
    in the quadrilaterals, each with its part of the area of the input.
    """
    table = _of_triangles(surface)
    if table is None:
        return None
    colours, which = np.unique(table, axis=0, return_inverse=True)
    groups = int(domain.pair.max()) + 1
    face, barycentric, area = _places(surface, groups)
    found = Locator(domain.triangles).locate(surface.points(face, barycentric))
    votes = np.zeros((groups, len(colours)))
    group = domain.pair[found.face]
    own = group >= 0
    np.add.at(votes, (group[own], which.ravel()[face[found.order[own]]]), area[found.order[own]])
    return FaceColours(colours[votes.argmax(axis=1)], votes.max(axis=1) / np.maximum(votes.sum(axis=1), _tiny()))


def _of_triangles(surface: OrbifoldSurface) -> Floats | None:
    """The colour of every triangle of the input, (F, 3)."""
    mesh = surface.refinement.coarse
    if mesh.face_colors is not None:
        return mesh.face_colors[:, :3]
    return None if mesh.colors is None else np.asarray(mesh.colors[mesh.triangles, :3].mean(axis=1))


def _places(surface: OrbifoldSurface, quads: int) -> tuple[Ints, Floats, Floats]:
    """Triangles of the input, barycentric coordinates of places within them, even all over, and the area of each."""
    mesh = surface.refinement.coarse
    aside = int(np.clip(np.ceil(np.sqrt(_LOOKS * quads / mesh.face_count)), 1, _MOST_ASIDE))
    there = grid_of(aside).mean(axis=1)
    corners = mesh.vertices[mesh.triangles]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    count, each = mesh.face_count, len(there)
    return np.repeat(np.arange(count), each), np.tile(there, (count, 1)), np.repeat(area / each, each)


def _tiny() -> float:
    return float(np.finfo(float).tiny)
