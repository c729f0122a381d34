"""Orientation: the sheets of the orientation cover, and faces that are turned to agree."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from orbiframe.meshes.polyhedron import Polyhedron

Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]


def oriented(polyhedron: Polyhedron) -> Polyhedron:
    """The same polyhedron with coherently oriented faces, if it is orientable; else unchanged.

    In every component the majority of the faces keeps its orientation.
    """
    components, sheets, label = polyhedron.sheets
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
    uv = None if polyhedron.corner_uv is None else polyhedron.corner_uv[corner]
    return replace(polyhedron, tail=polyhedron.tail[corner], twin=twin, same=same[edge], corner_uv=uv)


def face_components(polyhedron: Polyhedron) -> tuple[int, Ints]:
    """The number of components (faces joined by edges), and the component of every face, (F,).

    Components are numbered from the one with the most faces down; of two alike, the one with the first face leads.
    """
    components, _, label = polyhedron.sheets
    count = polyhedron.face_count
    _, first, merged, size = np.unique(
        np.minimum(label[:count], label[count:]), return_index=True, return_inverse=True, return_counts=True
    )
    rank = np.empty(components, dtype=np.intp)
    rank[np.lexsort((first, -size))] = np.arange(components)
    return components, rank[merged.ravel()]


def face_sheets(polyhedron: Polyhedron) -> tuple[int, int, Ints]:
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
