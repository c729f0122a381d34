"""Repair: changes to a polyhedron that a user asks for, each with a sentence that says what it did.

Every function is pure and returns a `Repair`. Where faces or vertices change, halfedges find their twins as in a file:
by their ends.
"""

from __future__ import annotations

from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from orbiframe.errors import TopologyError, UsageError
from orbiframe.meshes.coincident_points import clusters, first_of_each, unit_scale
from orbiframe.meshes.defects import duplicate_faces, faces_with_repeated_vertices
from orbiframe.meshes.face_diagonals import triangulated
from orbiframe.meshes.fans import fan_labels
from orbiframe.meshes.flat_faces import FlatFaces, simple_loops, with_faces, without_flat_faces
from orbiframe.meshes.open_edges import open_halfedges
from orbiframe.meshes.orientation import face_components, oriented, reversed_faces
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.meshes.sizes import signed_volume
from orbiframe.meshes.surface_type import surface_type, without_unused_vertices
from orbiframe.meshes.told_by_ends import as_in_a_file, require_told_by_ends

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]

NOTHING = "nothing to change"


class Repair(NamedTuple):
    """A repaired polyhedron, and what was changed in it, in words; the same object where that is nothing."""

    polyhedron: Polyhedron
    said: str


def weld(polyhedron: Polyhedron, tolerance: float) -> Repair:
    """One vertex for all that are at a distance of at most the tolerance, and for chains of such; 0: for equal ones.

    The first vertex of each cluster stays where it is; normals and colours become the mean of the cluster's. A face
    that folds up is taken apart into simple ones, see `drop_degenerate`; of two corners nothing is left, and the faces
    on both sides meet. Raises UsageError for a negative or infinite tolerance, TopologyError where it is so large that
    no face is left, or vertices have more than a hundred neighbours on average.
    """
    if not 0 <= tolerance < np.inf:
        raise UsageError(f"the tolerance of a weld is {tolerance}, but a finite number from 0 on is required")
    label = clusters(polyhedron.vertices, tolerance)
    first = first_of_each(label)
    if len(first) == len(label):
        return Repair(polyhedron, f"no two vertices within {tolerance:g} of each other; {NOTHING}")
    merged = Polyhedron.from_corners(
        polyhedron.vertices[first],
        polyhedron.offsets,
        label[polyhedron.tail],
        normals=_mean_normals(polyhedron.normals, label),
        colors=_means(polyhedron.colors, label),
        face_colors=polyhedron.face_colors,
        unit=polyhedron.unit,
    )
    simple, folded = _simple(merged)
    if polyhedron.face_count and not simple.face_count:
        raise TopologyError(f"a weld of {tolerance:g} folds up every face; take a smaller tolerance")
    moved = _largest_move(polyhedron.vertices, label)
    chains = ", in chains of near vertices" if moved > tolerance else ""
    parts = [
        f"{_counted(len(label), 'vertices')} became {len(first)}, moved by at most {moved:.2g}{chains}",
        *folded,
        _openness(polyhedron, simple),
    ]
    return Repair(simple, "; ".join(filter(None, parts)))


def drop_degenerate(polyhedron: Polyhedron) -> Repair:
    """Without what is no proper face, and without holes in their places as far as that can be.

    A face that meets a vertex twice falls apart into simple faces; parts of one or two edges vanish, and the faces on
    both sides meet. Of faces on the same vertices the first stays, unless they close up to a sphere. A face without
    area becomes a part of its neighbour across its longest edge; it is dropped where that edge is open, and kept
    where the neighbour would meet a vertex twice. Vertices in no face go.
    """
    simple, folded = _simple(polyhedron)
    single, dropped = _without_duplicates(simple)
    whole, flat = without_flat_faces(single)
    used = without_unused_vertices(whole)
    unused = len(whole.vertices) - len(used.vertices)
    parts = [
        *folded,
        *dropped,
        *_changes(flat),
        *([f"{_counted(unused, 'vertices')} in no face dropped"] * (unused > 0)),
    ]
    kept = [f"{_counted(flat.kept, 'faces')} without area kept, as no neighbour can take them"] * (flat.kept > 0)
    if not parts:
        return Repair(polyhedron, "; ".join([*kept, NOTHING]) if kept else f"no degenerate faces; {NOTHING}")
    if not used.face_count:
        raise TopologyError("all faces are degenerate and nothing is left without them; is the mesh all in one line?")
    return Repair(used, "; ".join(filter(None, [*parts, *kept, _openness(polyhedron, used)])))


def split_nonmanifold_vertices(polyhedron: Polyhedron) -> Repair:
    """A vertex of its own for every fan: every run of faces round a vertex, from edge to edge.

    Solids that touch in vertices or edges come apart. The first fan keeps the vertex; the new ones come last, in the
    same places. An edge in three or more faces stays where its ends have one fan only.
    """
    count, label = fan_labels(polyhedron)
    first = np.empty(count, dtype=np.intp)
    first[label[::-1]] = np.arange(len(label))[::-1]
    order = np.argsort(first)
    owner = polyhedron.tail[first[order]]
    extra = np.ones(count, dtype=np.bool_)
    extra[np.unique(owner, return_index=True)[1]] = False
    if not extra.any():
        return Repair(polyhedron, f"no vertex of several fans; {NOTHING}")
    number = np.empty(count, dtype=np.intp)
    number[order] = np.where(extra, len(polyhedron.vertices) + np.cumsum(extra) - 1, owner)
    source = np.concatenate([np.arange(len(polyhedron.vertices)), owner[extra]])
    split = _relabelled(polyhedron, source, number[label])
    said = f"{_counted(len(np.unique(owner[extra])), 'vertices')} of several fans split, {int(extra.sum())} added"
    return Repair(split, "; ".join(filter(None, [said, _crowded(split), _openness(polyhedron, split)])))


def component(polyhedron: Polyhedron, which: int | Literal["largest"] = "largest") -> Repair:
    """One component: the largest, or a number, where 1 has the most faces; faces joined by edges make a component.

    Raises UsageError for a number that there is not.
    """
    count, label = face_components(polyhedron)
    number = 1 if which == "largest" else which
    if not 1 <= number <= count:
        sizes = ", ".join(map(str, np.bincount(label)[:10]))
        raise UsageError(f"there is no component {number}; there are 1 to {count}, of {sizes} faces")
    if count == 1:
        return Repair(polyhedron, f"there is one component; {NOTHING}")
    kept = without_unused_vertices(_kept(polyhedron, label == number - 1))
    said = f"component {number} of {count} kept, with {kept.face_count} of {_counted(polyhedron.face_count, 'faces')}"
    return Repair(kept, said)


def orient(polyhedron: Polyhedron) -> Repair:
    """Faces that run alike, and outward: the volume within a closed surface is positive.

    In every component the majority of faces leads; if the volume of all together is negative then, all are reversed.
    A nonorientable surface is left as it is.
    """
    surface = surface_type(polyhedron)
    if not surface.orientable:
        return Repair(polyhedron, f"the surface is nonorientable; {NOTHING}")
    alike = oriented(polyhedron)
    outward = alike
    if (signed_volume(alike) or 0.0) < 0:
        outward = reversed_faces(alike, np.ones(alike.face_count, dtype=np.bool_))
    turned = _reversed_count(polyhedron, outward)
    if not turned:
        return Repair(polyhedron, f"the faces run alike{' and outward' * surface.closed}; {NOTHING}")
    why = "" if outward is alike else ", as most looked inward"
    return Repair(outward, f"{turned} of {_counted(polyhedron.face_count, 'faces')} reversed{why}")


def triangulate(polyhedron: Polyhedron) -> Repair:
    """Every face cut into triangles by diagonals, see `face_diagonals.triangulated`.

    Raises TopologyError where the triangles would be another surface once they are in a file.
    """
    larger = int((polyhedron.face_sizes > 3).sum())
    triangles = triangulated(polyhedron)
    if not larger:
        return Repair(polyhedron, f"all faces are triangles; {NOTHING}")
    require_told_by_ends(triangles, surface_type(as_in_a_file(polyhedron)))
    cut = triangles.face_count - polyhedron.face_count + larger
    fresh = len(triangles.vertices) - len(polyhedron.vertices)
    points = f", with {_counted(fresh, 'vertices')} more on diagonals" if fresh else ""
    return Repair(triangles, f"{_counted(larger, 'faces')} of more than 3 corners cut into {cut} triangles{points}")


# ---- faces --------------------------------------------------------------------------------------------------------


def _simple(polyhedron: Polyhedron) -> tuple[Polyhedron, list[str]]:
    """Faces that meet no vertex twice and have three corners at least; and what was changed."""
    small = np.flatnonzero(polyhedron.face_sizes < 3)
    bad = np.union1d(faces_with_repeated_vertices(polyhedron), small)
    if not len(bad):
        return polyhedron, []
    parts = [(face, part) for face in bad.tolist() for part in simple_loops(polyhedron.face_corners(face).tolist())]
    good = np.setdiff1d(np.arange(polyhedron.face_count), bad)
    owner = np.concatenate([good, np.array([face for face, _ in parts], dtype=np.intp)])
    size = np.concatenate([polyhedron.face_sizes[good], np.array([len(part) for _, part in parts], dtype=np.intp)])
    pieces = np.array([corner for _, part in parts for corner in part], dtype=np.intp)
    start = np.concatenate([polyhedron.offsets[good], len(polyhedron.tail) + _starts(size[len(good) :])])
    order = np.argsort(owner, kind="stable")
    corners = np.concatenate([polyhedron.tail, pieces])
    simple = with_faces(polyhedron, corners, start[order], size[order], owner[order])
    return simple, [
        f"{_counted(len(bad), 'faces')} with a repeated vertex became {_counted(len(parts), 'simple faces')}"
    ]


def _without_duplicates(polyhedron: Polyhedron) -> tuple[Polyhedron, list[str]]:
    pairs = duplicate_faces(polyhedron)
    if not pairs or (polyhedron.twin >= 0).all():
        return polyhedron, []
    again = np.unique([later for _, later in pairs])
    keep = np.ones(polyhedron.face_count, dtype=np.bool_)
    keep[again] = False
    return _kept(polyhedron, keep), [f"{_counted(len(again), 'duplicate faces')} dropped"]


def _kept(polyhedron: Polyhedron, keep: Bools) -> Polyhedron:
    faces = np.flatnonzero(keep)
    return with_faces(polyhedron, polyhedron.tail, polyhedron.offsets[faces], polyhedron.face_sizes[faces], faces)


def _relabelled(polyhedron: Polyhedron, source: Ints, tail: Ints) -> Polyhedron:
    """The same faces on vertices that are copies of others."""
    normals, colors = (None if table is None else table[source] for table in (polyhedron.normals, polyhedron.colors))
    return Polyhedron.from_corners(
        polyhedron.vertices[source],
        polyhedron.offsets,
        tail,
        normals=normals,
        colors=colors,
        face_colors=polyhedron.face_colors,
        unit=polyhedron.unit,
    )


def _starts(sizes: Ints) -> Ints:
    return np.cumsum(sizes) - sizes


# ---- vertices -----------------------------------------------------------------------------------------------------


def _means(table: Floats | None, label: Ints) -> Floats | None:
    """The mean of a table's rows in every cluster; a cluster of one keeps its row to the bit."""
    if table is None:
        return None
    sums = np.stack([np.bincount(label, weights=column) for column in table.T], axis=1)
    return np.asarray(sums / np.bincount(label)[:, None], dtype=np.float64)


def _mean_normals(normals: Floats | None, label: Ints) -> Floats | None:
    """Means of unit length, as long as they are not zero; a cluster of one keeps its normal."""
    mean = _means(normals, label)
    if normals is None or mean is None:
        return None
    many = np.bincount(label) > 1
    length = np.linalg.norm(mean, axis=1, keepdims=True)
    first = normals[first_of_each(label)]
    return np.where(many[:, None] & (length > 0), mean / np.where(length > 0, length, 1.0), first)


def _largest_move(points: Floats, label: Ints) -> float:
    unit, scale = unit_scale(points, 1.0)
    distance = np.linalg.norm(unit - unit[first_of_each(label)][label], axis=1)
    return float(distance.max() / scale)


# ---- words --------------------------------------------------------------------------------------------------------


def _counted(count: int, noun: str) -> str:
    return f"{count} {noun if count != 1 else noun.replace('vertices', 'vertex').replace('faces', 'face')}"


def _openness(before: Polyhedron, after: Polyhedron) -> str:
    """How many edges are open before and after, where that is not the same."""
    was, now = (len(open_halfedges(mesh)) for mesh in (before, after))
    return f"open edges: {was} before, {now} after" if was != now else ""


def _crowded(polyhedron: Polyhedron) -> str:
    left = int((polyhedron.twin < 0).sum()) - len(open_halfedges(polyhedron))
    return f"{left} sides of edges in three or more faces remain" if left else ""


def _reversed_count(before: Polyhedron, after: Polyhedron) -> int:
    """How many faces run the other way; a first corner stays, so the second one tells."""
    second = before.offsets[:-1][before.face_sizes > 1] + 1
    return int((before.tail[second] != after.tail[second]).sum())


def _changes(flat: FlatFaces) -> list[str]:
    joined = [f"{_counted(flat.joined, 'faces')} without area joined to a neighbour"] if flat.joined else []
    return joined + ([f"{_counted(flat.dropped, 'faces')} without area dropped"] if flat.dropped else [])
