"""Curved mesh: Lagrange triangles of any order on a surface, for finite elements."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from orbiframe.components.one_line import one_line
from orbiframe.errors import UsageError
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.meshes.subdivision import refine
from orbiframe.surfaces.geodesic_faces import GeodesicFaces
from orbiframe.surfaces.surface import OrbifoldSurface

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

LARGEST_ORDER = 6
_ENDS = ((0, 1), (1, 2), (2, 0))


@dataclass(frozen=True, eq=False)
class CurvedMesh:
    """Triangles that are polynomials of degree `order` in their barycentric coordinates, by their nodes.

    nodes: (N, 3), points in space, each once. elements: (E, (order + 1)(order + 2) / 2), the nodes of every triangle:
    its corners, those inside of its sides 01, 12 and 20 from end to end, and those within in the same way, as of a
    triangle of order - 3. That is the order of Gmsh and of VTK. Corners run counterclockwise seen from outside.
    """

    order: int
    nodes: Floats
    elements: Ints

    __repr__ = one_line

    @property
    def corners(self) -> Ints:
        """The nodes at the corners of the triangles, (E, 3)."""
        return self.elements[:, :3]


def curved_mesh(surface: OrbifoldSurface, faces: GeodesicFaces, order: int, density: int = 1) -> CurvedMesh:
    """The elements of one order that interpolate a surface; every geodesic triangle in density^2 of them.

    Nodes are the images of points with barycentric coordinates that are multiples of 1 / (order density), so that
    neighbours share those on their common side; each is evaluated once. On smooth functions the distance to the surface
    is O(h^(order + 1)) for elements of size h. Raises UsageError for an order that is not 1 to 6.
    """
    if not 1 <= order <= LARGEST_ORDER:
        raise UsageError(f"elements of order {order} are not made; give 1 to {LARGEST_ORDER}")
    fine = refine(faces.gluing, order * density)
    nodes = surface.evaluate(faces.locate(fine.face, fine.barycentric))
    places, triangles = _grid(order * density)
    # The node at every point of the grid of every face, from the corners of the small triangles.
    node = np.empty((faces.gluing.face_count, len(places)), dtype=np.intp)
    node[:, triangles.ravel()] = fine.polyhedron.triangles.reshape(faces.gluing.face_count, -1)
    elements = node[:, _element_places(order, density)]
    return CurvedMesh(order, nodes, elements.reshape(-1, elements.shape[2]))


def joined_meshes(meshes: Sequence[CurvedMesh]) -> CurvedMesh:
    """Several meshes of one order as one, side by side."""
    first = np.cumsum([0, *(len(mesh.nodes) for mesh in meshes)])
    elements = [mesh.elements + start for mesh, start in zip(meshes, first, strict=False)]
    return CurvedMesh(meshes[0].order, np.concatenate([mesh.nodes for mesh in meshes]), np.concatenate(elements))


@lru_cache(maxsize=32)
def node_exponents(order: int) -> Ints:
    """The barycentric coordinates of the nodes of an element, times the order, (n, 3), in the order of its nodes."""
    return np.array(_ring(order, 0), dtype=np.intp)


def _ring(order: int, inset: int) -> list[tuple[int, int, int]]:
    """Corners, sides and inside of the triangle that is `inset` steps inside."""
    side = order - 3 * inset
    if side < 0:
        return []
    if side == 0:
        return [(inset, inset, inset)]
    places = [_place(inset, {c: side + inset}) for c in range(3)]
    for start, end in _ENDS:
        places += [_place(inset, {start: side + inset - k, end: inset + k}) for k in range(1, side)]
    return places + _ring(order, inset + 1)


def _place(inset: int, entries: dict[int, int]) -> tuple[int, int, int]:
    first, second, third = (entries.get(c, inset) for c in range(3))
    return first, second, third


@lru_cache(maxsize=32)
def _grid(density: int) -> tuple[Ints, Ints]:
    """The points of one triangle that is cut in density^2, as multiples of 1 / density, and the small triangles."""
    one = refine(Polyhedron.from_faces(np.eye(3), np.array([[0, 1, 2]])), density)
    return np.rint(one.barycentric * density).astype(np.intp), one.polyhedron.triangles


@lru_cache(maxsize=32)
def _element_places(order: int, density: int) -> Ints:
    """Which points of the grid of one triangle are the nodes of its elements, (density^2, n)."""
    places, _ = _grid(order * density)
    number = {tuple(place): n for n, place in enumerate(places.tolist())}
    corners, small = _grid(density)
    wanted = np.einsum("nc,eci->eni", node_exponents(order), corners[small])
    return np.array([[number[tuple(place)] for place in element] for element in wanted.tolist()], dtype=np.intp)
