"""Surface type: which closed surface a polyhedron is."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from orbiframe.meshes.fans import fans_at_vertices
from orbiframe.meshes.polyhedron import Polyhedron

Bools = NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class SurfaceType:
    """What a polyhedron is as an abstract surface.

    genus: handles of a closed connected orientable surface, crosscaps of a nonorientable one, None for anything else.

    >>> from orbiframe import read, surface_type
    >>> surface_type(read("dataset:three_crosscaps"))
    SurfaceType(euler_characteristic=-1, orientable=False, closed=True, components=1, genus=3)
    """

    euler_characteristic: int
    orientable: bool
    closed: bool
    components: int
    genus: int | None

    @property
    def name(self) -> str:
        """The surface in words, such as "closed, orientable, genus 3, 1 component"."""
        words = ["closed" if self.closed else "not closed", "orientable" if self.orientable else "nonorientable"]
        if self.genus is not None:
            crosscaps = "1 crosscap" if self.genus == 1 else f"{self.genus} crosscaps"
            words.append(f"genus {self.genus}" if self.orientable else crosscaps)
        words.append("1 component" if self.components == 1 else f"{self.components} components")
        return ", ".join(words)


def surface_type(polyhedron: object) -> SurfaceType:
    """The surface that the faces make: Euler characteristic, orientability, components and genus.

    Vertices in no face do not count. Linear in the number of halfedges, up to one sort. polyhedron: or what
    `Polyhedron.of` takes.

    >>> from orbiframe import read, surface_type
    >>> surface_type(read("dataset:plate_genus2")).genus
    2
    >>> surface_type(read("dataset:klein_bottle")).orientable
    False
    """
    polyhedron = Polyhedron.of(polyhedron)
    components, sheets, _ = polyhedron.sheets
    used = int(_used_vertices(polyhedron).sum())
    chi = used - polyhedron.edge_count + polyhedron.face_count
    closed = polyhedron.face_count > 0 and bool((polyhedron.face_sizes > 0).all() and (polyhedron.twin >= 0).all())
    orientable = sheets == 2 * components
    is_surface = closed and components == 1 and bool((fans_at_vertices(polyhedron) <= 1).all())
    genus = (2 - chi) // (2 if orientable else 1) if is_surface else None
    return SurfaceType(chi, orientable, closed, components, genus)


def without_unused_vertices(polyhedron: Polyhedron) -> Polyhedron:
    """The polyhedron without the vertices that lie in no face; the others keep their order."""
    used = _used_vertices(polyhedron)
    if used.all():
        return polyhedron
    number = np.cumsum(used) - 1
    normals, colors = (None if a is None else a[used] for a in (polyhedron.normals, polyhedron.colors))
    marked = None if polyhedron.marked is None else polyhedron.marked.renumbered(np.where(used, number, -1))
    found = replace(polyhedron, vertices=polyhedron.vertices[used], tail=number[polyhedron.tail], marked=marked)
    return replace(found, normals=normals, colors=colors)


def _used_vertices(polyhedron: Polyhedron) -> Bools:
    return np.bincount(polyhedron.tail, minlength=len(polyhedron.vertices)) > 0


def doubled_edges(polyhedron: Polyhedron) -> Bools:
    """The halfedges (H,) of edges that are loops or share both ends with another edge.

    A triangle mesh without such edges is a simplicial complex, up to the sphere of two triangles. In a surface of
    constant curvature two points are joined by one geodesic in each homotopy class, so that a mesh with two edges of
    one class, or with a loop that bounds a disc, has no map that is linear on each triangle.
    """
    low = np.minimum(polyhedron.tail, polyhedron.head)[polyhedron.representative]
    high = np.maximum(polyhedron.tail, polyhedron.head)[polyhedron.representative]
    _, place, count = np.unique(low * np.intp(len(polyhedron.vertices)) + high, return_inverse=True, return_counts=True)
    return np.asarray(((low == high) | (count[place.ravel()] > 1))[polyhedron.edge])
