"""Edit scene: the picture of a surface that follows its mesh: what stays while the map does, and what moves.

All places are about the middle of the first mesh, in its diagonals, so that a camera keeps its view.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from orbiframe import OrbifoldSurface, Points, Polyhedron
from orbiframe_viewer.scene import packed, xh_scene

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

POINTS = 16_000
_STEPS, _MOST_CURVES = 8, 1500


@dataclass(frozen=True, eq=False)
class Display:
    """Points of X/H that are shown: the first `count` are the vertices of triangles (F, 3), then points on edges.

    signs: (n,), of normals; curves: (k, 2), pairs of points that are joined by lines.
    """

    points: Points
    count: int
    triangles: Ints
    signs: Floats
    curves: Ints
    xh: dict[str, Any] | None

    @classmethod
    def of(cls, surface: OrbifoldSurface, mesh: Polyhedron) -> Display:
        """At least 16,000 points, and the images of the edges of the mesh."""
        flat = surface.triangulation
        density = max(1, math.ceil(math.sqrt(POINTS / len(flat.points))))
        fine = surface.tessellation(density, bisected=True)
        whole = fine.mesh.face_count == density**2 * len(flat.own_faces)
        edges, curves = _curves(surface, mesh, len(fine.points.patch))
        points = Points(*(np.concatenate(pair) for pair in zip(fine.points, edges, strict=True)))
        signs = np.ones(len(points.patch))
        if fine.mesh.normals is not None:
            facing = np.einsum("ni,ni->n", surface.normals(fine.points), fine.mesh.normals)
            signs[: len(facing)] = np.where(facing < 0, -1.0, 1.0)
        known = mesh if whole and (mesh.twin >= 0).all() else None
        xh = xh_scene(surface, known, density) if whole else None
        return cls(points, len(fine.points.patch), fine.mesh.triangles, signs, curves, xh)

    def scene(
        self, mesh: Polyhedron, name: str, origin: Floats, scale: float, controls: Ints, shape: int
    ) -> dict[str, Any]:
        """What stays, as plain data; controls: the points that are the handles of the functions."""
        ends = np.stack([mesh.tail, mesh.head], axis=1)[mesh.representative]
        return {
            "name": name,
            "shape": shape,
            "origin": [float(x) for x in origin],
            "scale": float(scale),
            "count": self.count,
            "points": len(self.points.patch),
            "index": packed(self.triangles, np.uint32),
            "curves": packed(self.curves, np.uint32),
            "vertices": len(mesh.vertices),
            "lines": packed(ends, np.uint32),
            "controls": packed(controls, np.uint32),
            "xh": self.xh,
        }


def _curves(surface: OrbifoldSurface, mesh: Polyhedron, first: int) -> tuple[Points, Ints]:
    """Points of X/H along the edges of a mesh, and the pairs of neighbours, numbered from `first` on."""
    from orbiframe.meshes import outline

    halfedges = outline(mesh)[mesh.representative]
    if len(halfedges) > _MOST_CURVES:
        halfedges = halfedges[:0]
    face, corner = np.divmod(np.repeat(halfedges, _STEPS + 1), 3)
    share = np.tile(np.linspace(0, 1, _STEPS + 1), len(halfedges))
    barycentric, rows = np.zeros((len(face), 3)), np.arange(len(face))
    barycentric[rows, corner], barycentric[rows, (corner + 1) % 3] = 1 - share, share
    number = first + rows.reshape(-1, _STEPS + 1)
    pairs = np.stack([number[:, :-1], number[:, 1:]], axis=-1).reshape(-1, 2)
    return surface.points(face, barycentric), pairs
