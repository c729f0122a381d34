"""Topology: which closed surface a polyhedron is, and where it fails to be one."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from orbiframe.errors import TopologyError
from orbiframe.polyhedron import Polyhedron

Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class SurfaceType:
    """What a polyhedron is as an abstract surface.

    genus: handles of a closed connected orientable surface, crosscaps of a nonorientable one, None for anything else.
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


@dataclass(frozen=True, slots=True)
class Defect:
    """One kind of flaw of a polyhedron: how often, where first, and whether it stops the map to X/H."""

    kind: str
    count: int
    where: str
    fatal: bool

    def __str__(self) -> str:
        """Count and kind, such as "4 open edges" or "1 duplicate face"."""
        kind = self.kind
        if self.count == 1:
            for many, one in (("vertices", "vertex"), ("faces", "face"), ("edges", "edge")):
                kind = kind.replace(many, one)
        return f"{self.count} {kind}"


def surface_type(polyhedron: Polyhedron) -> SurfaceType:
    """The surface that the faces make: Euler characteristic, orientability, components and genus.

    Vertices in no face do not count. Linear in the number of halfedges, up to one sort.
    """
    components, sheets, _ = _face_sheets(polyhedron)
    used = int(_used_vertices(polyhedron).sum())
    chi = used - polyhedron.edge_count + polyhedron.face_count
    closed = polyhedron.face_count > 0 and bool((polyhedron.face_sizes > 0).all() and (polyhedron.twin >= 0).all())
    orientable = sheets == 2 * components
    is_surface = closed and components == 1 and not len(_pinched_vertices(polyhedron))
    genus = (2 - chi) // (2 if orientable else 1) if is_surface else None
    return SurfaceType(chi, orientable, closed, components, genus)


def defects(polyhedron: Polyhedron) -> list[Defect]:
    """Everything that keeps a polyhedron from being one closed connected surface, or that a user should know of."""
    found = [
        _not_finite(polyhedron),
        _few_corners(polyhedron),
        _repeated_vertices(polyhedron),
        _duplicate_faces(polyhedron),
        *_broken_edges(polyhedron),
        _several_fans(polyhedron),
        _several_components(polyhedron),
        _orientation(polyhedron),
        _unused(polyhedron),
        _coincident(polyhedron),
        _zero_area(polyhedron),
    ]
    return [defect for defect in found if defect is not None]


def require_closed_surface(polyhedron: Polyhedron) -> SurfaceType:
    """The surface type of a polyhedron that is one closed connected surface; raises TopologyError otherwise."""
    if polyhedron.face_count == 0:
        raise TopologyError("the mesh has no faces; give a closed polyhedron")
    fatal = [defect for defect in defects(polyhedron) if defect.fatal]
    if fatal:
        reasons = "; ".join(f"{defect} ({defect.where})" for defect in fatal)
        raise TopologyError(
            f"the mesh is not one closed connected surface: {reasons}; "
            "`orbiframe info` lists all defects, mend them in a mesh editor and try again"
        )
    return surface_type(polyhedron)


def oriented(polyhedron: Polyhedron) -> Polyhedron:
    """The same polyhedron with coherently oriented faces, if it is orientable; else unchanged.

    In every component the majority of the faces keeps its orientation.
    """
    components, sheets, label = _face_sheets(polyhedron)
    if sheets != 2 * components:
        return polyhedron
    count = polyhedron.face_count
    share = np.bincount(label, weights=np.arange(2 * count) < count, minlength=sheets)
    flip = share[label[:count]] < share[label[count:]]
    tie = share[label[:count]] == share[label[count:]]
    flip |= tie & (label[:count] > label[count:])
    return reversed_faces(polyhedron, flip) if flip.any() else polyhedron


def reversed_faces(polyhedron: Polyhedron, flip: Bools) -> Polyhedron:
    """The polyhedron with the marked faces (F,) run through the other way, from the same first corner."""
    index = np.arange(len(polyhedron.tail))
    start = polyhedron.offsets[:-1][polyhedron.face]
    size = polyhedron.face_sizes[polyhedron.face]
    flipped = flip[polyhedron.face]
    mirrored_corner = start + (size - (index - start)) % size
    mirrored_edge = start + (size - 1 - (index - start))
    corner = np.where(flipped, mirrored_corner, index)
    edge = np.where(flipped, mirrored_edge, index)
    moved = np.append(edge, -1)
    twin = moved[polyhedron.twin[edge]]
    other = flip[polyhedron.face[np.maximum(polyhedron.twin, 0)]]
    same = (polyhedron.same ^ flipped ^ other) & (polyhedron.twin >= 0)
    return replace(polyhedron, tail=polyhedron.tail[corner], twin=twin, same=same[edge])


def without_unused_vertices(polyhedron: Polyhedron) -> Polyhedron:
    """The polyhedron without the vertices that lie in no face; the others keep their order."""
    used = _used_vertices(polyhedron)
    if used.all():
        return polyhedron
    number = np.cumsum(used) - 1
    normals, colors = (None if a is None else a[used] for a in (polyhedron.normals, polyhedron.colors))
    tail = number[polyhedron.tail]
    return replace(polyhedron, vertices=polyhedron.vertices[used], tail=tail, normals=normals, colors=colors)


def _used_vertices(polyhedron: Polyhedron) -> Bools:
    return np.bincount(polyhedron.tail, minlength=len(polyhedron.vertices)) > 0


def _face_sheets(polyhedron: Polyhedron) -> tuple[int, int, Ints]:
    """Components of the faces, and of the two-sheeted orientation cover (nodes f and F + f), with its labels."""
    count = polyhedron.face_count
    glued = np.flatnonzero(polyhedron.twin >= 0)
    a, b = polyhedron.face[glued], polyhedron.face[polyhedron.twin[glued]]
    shift = np.where(polyhedron.same[glued], count, 0)
    rows = np.concatenate([a, a + count])
    columns = np.concatenate([b + shift, b + count - shift])
    plain = coo_array((np.ones(len(a)), (a, b)), shape=(count, count)).tocsr()
    cover = coo_array((np.ones(len(rows)), (rows, columns)), shape=(2 * count, 2 * count)).tocsr()
    components, _ = connected_components(plain, directed=False)
    sheets, label = connected_components(cover, directed=False)
    return components, sheets, label.astype(np.intp)


def fan_labels(polyhedron: Polyhedron) -> tuple[int, Ints]:
    """The number of fans (runs of faces round a vertex) and the fan of every corner, (H,)."""
    glued = np.flatnonzero(polyhedron.twin >= 0)
    twin = polyhedron.twin[glued]
    same = polyhedron.same[glued]
    start = np.where(same, twin, polyhedron.next[twin])
    size = len(polyhedron.tail)
    graph = coo_array((np.ones(len(glued)), (glued, start)), shape=(size, size)).tocsr()
    ends = np.where(same, polyhedron.next[twin], twin)
    graph = graph + coo_array((np.ones(len(glued)), (polyhedron.next[glued], ends)), shape=(size, size)).tocsr()
    count, label = connected_components(graph, directed=False)
    return int(count), label.astype(np.intp)


def _pinched_vertices(polyhedron: Polyhedron) -> Ints:
    count, label = fan_labels(polyhedron)
    owner = np.empty(count, dtype=np.intp)
    owner[label] = polyhedron.tail
    fans = np.bincount(owner, minlength=len(polyhedron.vertices))
    return np.flatnonzero(fans > 1)


def _listed(items: Iterable[object], limit: int = 5) -> str:
    shown = [str(item) for item in items]
    return ", ".join(shown[:limit]) + (", …" if len(shown) > limit else "")


def _not_finite(polyhedron: Polyhedron) -> Defect | None:
    bad = np.flatnonzero(~np.isfinite(polyhedron.vertices).all(axis=1))
    return (
        Defect("vertices without finite coordinates", len(bad), f"vertices {_listed(bad)}", True) if len(bad) else None
    )


def _few_corners(polyhedron: Polyhedron) -> Defect | None:
    bad = np.flatnonzero(polyhedron.face_sizes < 3)
    return Defect("faces of fewer than 3 corners", len(bad), f"faces {_listed(bad)}", True) if len(bad) else None


def _repeated_vertices(polyhedron: Polyhedron) -> Defect | None:
    order = np.lexsort((polyhedron.tail, polyhedron.face))
    face, tail = polyhedron.face[order], polyhedron.tail[order]
    bad = np.unique(face[1:][(face[1:] == face[:-1]) & (tail[1:] == tail[:-1])])
    return Defect("faces with a repeated vertex", len(bad), f"faces {_listed(bad)}", True) if len(bad) else None


def _duplicate_faces(polyhedron: Polyhedron) -> Defect | None:
    pairs: list[tuple[int, int]] = []
    order = np.lexsort((polyhedron.tail, polyhedron.face))
    tail = polyhedron.tail[order]
    for size in np.unique(polyhedron.face_sizes):
        faces = np.flatnonzero(polyhedron.face_sizes == size)
        if size == 0 or len(faces) < 2:
            continue
        rows = tail[polyhedron.offsets[faces][:, None] + np.arange(size)]
        by_row = np.lexsort(rows.T[::-1])
        equal = (rows[by_row][1:] == rows[by_row][:-1]).all(axis=1)
        pairs += [(int(faces[a]), int(faces[b])) for a, b in zip(by_row[:-1][equal], by_row[1:][equal], strict=True)]
    where = "faces " + _listed(f"{min(p)} and {max(p)}" for p in sorted(pairs))
    # Two triangles on the same corners may close up to a sphere: only the edges tell whether that is a flaw.
    closed = bool((polyhedron.twin >= 0).all())
    return Defect("duplicate faces", len(pairs), where, not closed) if pairs else None


def _broken_edges(polyhedron: Polyhedron) -> list[Defect]:
    alone = np.flatnonzero(polyhedron.twin < 0)
    if not len(alone):
        return []
    low = np.minimum(polyhedron.tail[alone], polyhedron.head[alone])
    high = np.maximum(polyhedron.tail[alone], polyhedron.head[alone])
    ends, first, inverse, count = np.unique(
        np.stack([low, high], axis=1), axis=0, return_index=True, return_inverse=True, return_counts=True
    )
    found = []
    open_edges = np.flatnonzero(count == 1)
    if len(open_edges):
        loops = _boundary_loops(ends[open_edges])
        i, j = ends[open_edges[0]]
        face = polyhedron.face[alone[first[open_edges[0]]]]
        where = f"{loops}; first edge {i}-{j} of face {face}"
        found.append(Defect("open edges", len(open_edges), where, True))
    crowded = np.flatnonzero(count > 2)
    if len(crowded):
        i, j = ends[crowded[0]]
        faces = polyhedron.face[alone[inverse.ravel() == crowded[0]]]
        where = f"edge {i}-{j} lies in faces {_listed(faces)}"
        found.append(Defect("non-manifold edges", len(crowded), where, True))
    return found


def _boundary_loops(ends: Ints) -> str:
    size = int(ends.max()) + 1
    graph = coo_array((np.ones(len(ends)), (ends[:, 0], ends[:, 1])), shape=(size, size)).tocsr()
    _, label = connected_components(graph, directed=False)
    lengths = np.sort(np.unique(label[ends[:, 0]], return_counts=True)[1])[::-1]
    loops = "1 boundary loop" if len(lengths) == 1 else f"{len(lengths)} boundary loops"
    return f"{loops} of {_listed(lengths)} edges"


def _several_fans(polyhedron: Polyhedron) -> Defect | None:
    bad = _pinched_vertices(polyhedron)
    return Defect("vertices of several fans", len(bad), f"vertices {_listed(bad)}", True) if len(bad) else None


def _several_components(polyhedron: Polyhedron) -> Defect | None:
    components, _, label = _face_sheets(polyhedron)
    if components <= 1:
        return None
    merged = np.minimum(label[: polyhedron.face_count], label[polyhedron.face_count :])
    sizes = np.sort(np.unique(merged, return_counts=True)[1])[::-1]
    return Defect("components", components, f"of {_listed(sizes)} faces", True)


def _orientation(polyhedron: Polyhedron) -> Defect | None:
    components, sheets, _ = _face_sheets(polyhedron)
    turned = np.flatnonzero(polyhedron.same & polyhedron.representative)
    if sheets != 2 * components or not len(turned):
        return None
    where = f"first edge {polyhedron.tail[turned[0]]}-{polyhedron.head[turned[0]]}; orientation is mended when mapped"
    return Defect("inconsistently oriented edges", len(turned), where, False)


def _unused(polyhedron: Polyhedron) -> Defect | None:
    bad = np.flatnonzero(~_used_vertices(polyhedron))
    return Defect("vertices in no face", len(bad), f"vertices {_listed(bad)}", False) if len(bad) else None


def _coincident(polyhedron: Polyhedron) -> Defect | None:
    used = np.flatnonzero(_used_vertices(polyhedron))
    _, inverse, count = np.unique(polyhedron.vertices[used], axis=0, return_inverse=True, return_counts=True)
    bad = used[count[inverse.ravel()] > 1]
    return Defect("coincident vertices", len(bad), f"vertices {_listed(bad)}", False) if len(bad) else None


def _zero_area(polyhedron: Polyhedron) -> Defect | None:
    largest = np.abs(polyhedron.vertices).max(initial=0.0)
    if not np.isfinite(largest):
        return None
    # By a power of two, so that no digit changes: the squares of very large and very small numbers are none.
    unit = polyhedron.with_vertices(np.ldexp(polyhedron.vertices, -np.frexp(largest)[1]))
    bad = np.flatnonzero(np.linalg.norm(vector_areas(unit), axis=1) <= 1e-14 * unit.diagonal**2)
    return Defect("faces without area", len(bad), f"faces {_listed(bad)}", False) if len(bad) else None


def vector_areas(polyhedron: Polyhedron) -> NDArray[np.float64]:
    """The area of every face times its normal, (F, 3): half the sum of the cross products round the face."""
    origin = polyhedron.vertices[polyhedron.tail[polyhedron.offsets[polyhedron.face]]]
    a = polyhedron.vertices[polyhedron.tail] - origin
    b = polyhedron.vertices[polyhedron.head] - origin
    cross = np.cross(a, b) / 2
    total = np.zeros((polyhedron.face_count, 3))
    for axis in range(3):
        total[:, axis] = np.bincount(polyhedron.face, weights=cross[:, axis], minlength=polyhedron.face_count)
    return total
