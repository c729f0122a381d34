"""Defects: where a polyhedron fails to be one closed surface, and what helps."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import islice

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from orbiframe.errors import TopologyError
from orbiframe.meshes.coincident_points import clusters
from orbiframe.meshes.fans import fans_at_vertices
from orbiframe.meshes.open_edges import Seams, seams
from orbiframe.meshes.orientation import face_components
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.meshes.sizes import faces_without_area
from orbiframe.meshes.surface_type import SurfaceType, _used_vertices, surface_type

Ints = NDArray[np.intp]

_OPEN, _BOUNDARY = "open edges", "--boundary auto"
_SPLIT = "--split-nonmanifold-vertices"
_SHARED_ENDS = (
    "; if several edges are meant to join the same two vertices, faces as lists of vertices cannot tell them apart: "
    "put a vertex on each of these edges, or give their twins to orbiframe.Polyhedron"
)
_SINGULAR = {"vertices": "vertex", "faces": "face", "edges": "edge", "junctions": "junction", "seams": "a seam"}


@dataclass(frozen=True, slots=True)
class Defect:
    """One kind of flaw of a polyhedron: how often, where first, and whether it stops the map to X/H.

    remedy: the option of `orbiframe convert` and `orbiframe fit` that helps, empty where none does.
    """

    kind: str
    count: int
    where: str
    fatal: bool
    remedy: str = ""

    def __str__(self) -> str:
        """Count and kind, such as "4 open edges" or "1 duplicate face"."""
        kind = self.kind
        if self.count == 1:
            for many, one in _SINGULAR.items():
                kind = kind.replace(many, one)
        return f"{self.count} {kind}"


def defects_of(polyhedron: Polyhedron) -> list[Defect]:
    """Everything that keeps a polyhedron from being one closed connected surface, or that a user should know of."""
    joints = seams(polyhedron)
    found = [
        _not_finite(polyhedron),
        _few_corners(polyhedron),
        _repeated_vertices(polyhedron),
        _duplicate_faces(polyhedron),
        *_broken_edges(polyhedron, joints),
        *_missing_joints(joints),
        _several_fans(polyhedron),
        _several_components(polyhedron, joints),
        _orientation(polyhedron),
        _unused(polyhedron),
        _coincident(polyhedron, joints),
        _zero_area(polyhedron),
    ]
    return [defect for defect in found if defect is not None]


def require_closed_surface(polyhedron: Polyhedron, *, several: bool = False, boundary: bool = False) -> SurfaceType:
    """The surface type of a polyhedron that is one closed connected surface; raises TopologyError otherwise.

    several: any number of closed surfaces will do; boundary: they may have one, and then are not closed.
    """
    if polyhedron.face_count == 0:
        raise TopologyError("the mesh has no faces; give a closed polyhedron")
    fatal = [defect for defect in defects_of(polyhedron) if defect.fatal and not (boundary and defect.kind == _OPEN)]
    if fatal and not (several and all(defect.kind == "components" for defect in fatal)):
        reasons = "; ".join(f"{defect} ({defect.where})" for defect in fatal)
        advice = _advice(fatal) + (_SHARED_ENDS if _may_share_ends(polyhedron) else "")
        wanted = "connected" if boundary else "closed connected"
        raise TopologyError(f"the mesh is not one {wanted} surface: {reasons}; {advice}")
    return surface_type(polyhedron)


def _advice(fatal: list[Defect]) -> str:
    """What to do next, in words."""
    helpful = " ".join(dict.fromkeys(defect.remedy for defect in fatal if defect.remedy))
    if not helpful:
        return "`orbiframe info` lists all defects, mend them in a mesh editor and try again"
    return f"try again with {helpful}, or mend it in a mesh editor; `orbiframe info` lists all defects"


def _listed(items: Iterable[object], limit: int = 5) -> str:
    shown = [str(item) for item in islice(items, limit + 1)]
    return ", ".join(shown[:limit]) + (", …" if len(shown) > limit else "")


def _not_finite(polyhedron: Polyhedron) -> Defect | None:
    bad = np.flatnonzero(~np.isfinite(polyhedron.vertices).all(axis=1))
    return (
        Defect("vertices without finite coordinates", len(bad), f"vertices {_listed(bad)}", True) if len(bad) else None
    )


def _few_corners(polyhedron: Polyhedron) -> Defect | None:
    bad = np.flatnonzero(polyhedron.face_sizes < 3)
    where = f"faces {_listed(bad)}"
    return Defect("faces of fewer than 3 corners", len(bad), where, True, "--drop-degenerate") if len(bad) else None


def faces_with_repeated_vertices(polyhedron: Polyhedron) -> Ints:
    """The faces that meet one of their vertices twice or more often."""
    order = np.lexsort((polyhedron.tail, polyhedron.face))
    face, tail = polyhedron.face[order], polyhedron.tail[order]
    return np.unique(face[1:][(face[1:] == face[:-1]) & (tail[1:] == tail[:-1])])


def _repeated_vertices(polyhedron: Polyhedron) -> Defect | None:
    bad = faces_with_repeated_vertices(polyhedron)
    if not len(bad):
        return None
    fatal = not _has_twins_of_its_own(polyhedron)
    remedy = "--drop-degenerate" if fatal else ""
    return Defect("faces with a repeated vertex", len(bad), f"faces {_listed(bad)}", fatal, remedy)


def _has_twins_of_its_own(polyhedron: Polyhedron) -> bool:
    """Whether all halfedges have twins, and such as the ends of the edges do not tell: then a face may meet itself."""
    by_ends = Polyhedron.from_corners(polyhedron.vertices, polyhedron.offsets, polyhedron.tail)
    return bool((polyhedron.twin >= 0).all()) and not np.array_equal(by_ends.twin, polyhedron.twin)


def duplicate_faces(polyhedron: Polyhedron) -> list[tuple[int, int]]:
    """Pairs of faces with the same vertices in any order and direction: each face with the one before that is alike."""
    pairs: list[tuple[int, int]] = []
    order = np.lexsort((polyhedron.tail, polyhedron.face))
    tail = polyhedron.tail[order]
    for size in np.flatnonzero(np.bincount(polyhedron.face_sizes)):
        faces = np.flatnonzero(polyhedron.face_sizes == size)
        if size == 0 or len(faces) < 2:
            continue
        rows = tail[polyhedron.offsets[faces][:, None] + np.arange(size)]
        by_row = np.lexsort(rows.T[::-1])
        equal = (rows[by_row][1:] == rows[by_row][:-1]).all(axis=1)
        pairs += [(int(faces[a]), int(faces[b])) for a, b in zip(by_row[:-1][equal], by_row[1:][equal], strict=True)]
    return sorted(pairs)


def _duplicate_faces(polyhedron: Polyhedron) -> Defect | None:
    pairs = duplicate_faces(polyhedron)
    # Two triangles on the same corners may close up to a sphere: only the edges tell whether that is a flaw.
    closed = bool((polyhedron.twin >= 0).all())
    where = "faces " + _listed(f"{a} and {b}" for a, b in pairs)
    remedy = "" if closed else "--drop-degenerate"
    return Defect("duplicate faces", len(pairs), where, not closed, remedy) if pairs else None


def _broken_edges(polyhedron: Polyhedron, joints: Seams) -> list[Defect]:
    alone = np.flatnonzero(polyhedron.twin < 0)
    if not len(alone):
        return []
    low = np.minimum(polyhedron.tail[alone], polyhedron.head[alone])
    high = np.maximum(polyhedron.tail[alone], polyhedron.head[alone])
    _, first, inverse, count = np.unique(
        low * np.intp(len(polyhedron.vertices)) + high, return_index=True, return_inverse=True, return_counts=True
    )
    ends = np.stack([low, high], axis=1)[first]
    found = []
    open_edges = np.flatnonzero(count == 1)
    if len(open_edges):
        loops = _boundary_loops(ends[open_edges])
        i, j = ends[open_edges[0]]
        face = polyhedron.face[alone[first[open_edges[0]]]]
        where = f"{loops}; first edge {i}-{j} of face {face}"
        found.append(Defect(_OPEN, len(open_edges), where, True, _weld(joints) or _BOUNDARY))
    crowded = np.flatnonzero(count > 2)
    if len(crowded):
        shown = [(ends[k], polyhedron.face[alone[inverse.ravel() == k]]) for k in crowded[:3]]
        where = "; ".join(f"edge {i}-{j} lies in faces {_listed(faces)}" for (i, j), faces in shown)
        more = "; …" if len(crowded) > len(shown) else ""
        found.append(Defect("non-manifold edges", len(crowded), where + more, True, _SPLIT))
    return found


def _may_share_ends(polyhedron: Polyhedron) -> bool:
    """Whether all edges that join more than two faces join an even number, or a face meets a vertex twice."""
    alone = np.flatnonzero(polyhedron.twin < 0)
    ends = np.sort(np.stack([polyhedron.tail[alone], polyhedron.head[alone]]), axis=0)
    _, count = np.unique(ends, axis=1, return_counts=True)
    crowded = count[count > 2]
    return bool((crowded % 2 == 0).all() if len(crowded) else len(faces_with_repeated_vertices(polyhedron)))


def _weld(found: Seams) -> str:
    return f"--weld {found.tolerance:g}" if found.closed else ""


def _missing_joints(found: Seams) -> list[Defect]:
    """Open edges that lie upon one another: ends that coincide, and ends of one inside of another."""
    missing = []
    if found.closed:
        where = f"vertices {_listed(found.vertices)}; a weld closes {found.closed} open edges"
        missing.append(Defect("vertices on unwelded seams", len(found.vertices), where, False, _weld(found)))
    if len(found.junctions):
        where = _listed(f"vertex {v} inside edge {i}-{j}" for v, i, j in found.junctions.tolist())
        some = "" if found.complete else "; not all open edges were searched"
        missing.append(Defect("T-junctions", len(found.junctions), where + some, False))
    return missing


def _boundary_loops(ends: Ints) -> str:
    size = int(ends.max()) + 1
    graph = coo_array((np.ones(len(ends)), (ends[:, 0], ends[:, 1])), shape=(size, size)).tocsr()
    _, label = connected_components(graph, directed=False)
    lengths = np.sort(np.unique(label[ends[:, 0]], return_counts=True)[1])[::-1]
    loops = "1 boundary loop" if len(lengths) == 1 else f"{len(lengths)} boundary loops"
    return f"{loops} of {_listed(lengths)} edges"


def _several_fans(polyhedron: Polyhedron) -> Defect | None:
    fans = fans_at_vertices(polyhedron)
    bad = np.flatnonzero(fans > 1)
    where = "vertices " + _listed(f"{v} ({fans[v]} fans)" for v in bad)
    return Defect("vertices of several fans", len(bad), where, True, _SPLIT) if len(bad) else None


def _several_components(polyhedron: Polyhedron, found: Seams) -> Defect | None:
    components, label = face_components(polyhedron)
    if components <= 1:
        return None
    # Parts that a weld joins are no components of their own.
    remedy = "" if found.closed else "--component largest"
    return Defect("components", components, f"of {_listed(np.bincount(label))} faces", True, remedy)


def _orientation(polyhedron: Polyhedron) -> Defect | None:
    components, sheets, _ = polyhedron.sheets
    turned = np.flatnonzero(polyhedron.same & polyhedron.representative)
    if sheets != 2 * components or not len(turned):
        return None
    where = f"first edge {polyhedron.tail[turned[0]]}-{polyhedron.head[turned[0]]}; orientation is mended when mapped"
    return Defect("inconsistently oriented edges", len(turned), where, False, "--orient")


def _unused(polyhedron: Polyhedron) -> Defect | None:
    bad = np.flatnonzero(~_used_vertices(polyhedron))
    where = f"vertices {_listed(bad)}"
    return Defect("vertices in no face", len(bad), where, False, "--drop-degenerate") if len(bad) else None


def _coincident(polyhedron: Polyhedron, found: Seams) -> Defect | None:
    """Different vertices in one place, but for those that a weld of open edges joins."""
    looked_at = _used_vertices(polyhedron)
    looked_at[found.vertices] &= not found.closed
    used = np.flatnonzero(looked_at)
    label = clusters(polyhedron.vertices[used])
    bad = used[np.bincount(label)[label] > 1]
    return Defect("coincident vertices", len(bad), f"vertices {_listed(bad)}", False) if len(bad) else None


def _zero_area(polyhedron: Polyhedron) -> Defect | None:
    bad = faces_without_area(polyhedron)
    where = f"faces {_listed(bad)}"
    return Defect("faces without area", len(bad), where, False, "--drop-degenerate") if len(bad) else None
