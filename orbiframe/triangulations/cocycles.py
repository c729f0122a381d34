"""Cocycles: the jumps of multivalued functions on X/H across the edges of its triangles, class by class."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csc_array, csr_array
from scipy.sparse.linalg import splu

from orbiframe.errors import TopologyError
from orbiframe.meshes.edge_paths import joining_edges
from orbiframe.triangulations.geodesic_triangulation import GeodesicTriangulation
from orbiframe.triangulations.potentials import potentials

Ints = NDArray[np.intp]


def cohomology(domain: GeodesicTriangulation) -> Ints:
    """Jumps of multivalued functions, one for each class of a basis of the first cohomology of X/H: (b, 3 F) integers.

    A multivalued function has one branch on every triangle, and u = u' + jump[e] on halfedge e, with the branch u' of
    the triangle of its twin. Jumps are 0 across a tree of edges that joins all triangles, and add up to 0 round every
    vertex. b is 2 g for g handles, and g - 1 for g crosscaps. Raises TopologyError for an orbifold with mirrors.
    """
    if (domain.twin == np.arange(len(domain.twin))).any():
        raise TopologyError("an orbifold with mirrors is no closed surface; classes of 1-forms are for closed ones")
    first = np.flatnonzero(domain.reference)
    cotree = joining_edges(domain.face_count, first // 3, domain.twin[first] // 3)
    ends = domain.vertex.ravel()[np.stack([first, first - first % 3 + (first + 1) % 3])]
    rest = np.flatnonzero(~cotree)
    tree = joining_edges(domain.vertex_count, ends[0, rest], ends[1, rest])
    closed = _closed(domain, rest[tree], rest[~tree])
    return np.asarray(np.where(domain.reference, 1, -1) * closed[:, domain.edge])


def _closed(domain: GeodesicTriangulation, tree: Ints, free: Ints) -> Ints:
    """Jumps of edges, (b, E), of which those of the tree are found from the free ones, vertex by vertex."""
    sums = csc_array(vertex_sums(domain))
    upper = sums[1:]
    found = np.zeros((len(free), domain.edge_count), dtype=np.intp)
    found[np.arange(len(free)), free] = 1
    if len(tree) and len(free):
        solved = splu(csc_array(upper[:, tree])).solve(upper[:, free].toarray())
        found[:, tree] = -np.rint(solved.T).astype(np.intp)
    # On nonorientable surfaces the equation of the last vertex is one of its own.
    left = (sums[[0]] @ found.T).ravel()
    if not left.any():
        return np.asarray(found)
    pivot = np.flatnonzero(np.abs(left) == np.abs(left[left != 0]).min())[0]
    others = np.delete(np.arange(len(free)), pivot)
    return np.asarray(found[others] - (left[others] // left[pivot])[:, None] * found[pivot])


def vertex_sums(domain: GeodesicTriangulation) -> csr_array:
    """What jumps of edges add up to round every vertex, (V, E): zero for a multivalued function."""
    corner = np.arange(3 * domain.face_count)
    before = corner - corner % 3 + (corner + 2) % 3
    # A walk round the vertex leaves a triangle by the edge before the corner, or after it where that is turned over.
    alike = np.linalg.det(domain.corner_frame.reshape(-1, 3, 3)) > 0
    left = np.where(alike, before, corner)
    sign = np.where(domain.reference[left], 1, -1)
    shape = domain.vertex_count, domain.edge_count
    return csr_array(coo_array((sign, (domain.vertex.ravel(), domain.edge[left])), shape=shape))


def require_cocycles(domain: GeodesicTriangulation, jumps: Ints) -> None:
    """Raise TopologyError unless jumps (k, 3 F) are opposite at twins and add up to zero round every vertex."""
    wrong = np.argwhere(jumps[:, domain.twin] != -jumps)
    if len(wrong):
        raise TopologyError(
            f"the jumps across halfedge {wrong[0][1]} and its twin are {jumps[tuple(wrong[0])]} and "
            f"{jumps[wrong[0][0], domain.twin[wrong[0][1]]]}; they must be opposite"
        )
    left = np.argwhere((vertex_sums(domain) @ jumps[:, domain.reference].T).T != 0)
    if len(left):
        raise TopologyError(
            f"the jumps of function {left[0][0]} do not add up to 0 round vertex {left[0][1]}, so that there is none"
        )


def corner_values(domain: GeodesicTriangulation, jumps: Ints) -> Ints:
    """Multivalued functions with these jumps (k, 3 F) and whole values at the vertices: (k, F, 3).

    At the reference corner of every vertex they are 0.
    """
    here = np.arange(3 * domain.face_count)
    after = here - here % 3 + (here + 1) % 3
    roots = np.zeros(len(here), dtype=np.bool_)
    roots[domain.vertex_corner] = True
    tail, head = np.concatenate([here, after]), np.concatenate([domain.start, domain.end])
    found = potentials(roots, tail, head, np.concatenate([jumps.T, jumps.T]))
    return np.ascontiguousarray(found.T).reshape(len(jumps), domain.face_count, 3)


def orientations(domain: GeodesicTriangulation) -> Ints:
    """1 for every triangle that runs the same way as triangle 0 on X/H, -1 for the others, (F,).

    Raises TopologyError for a nonorientable surface.
    """
    root = np.arange(domain.face_count) == 0
    here = np.arange(3 * domain.face_count)
    turns = potentials(root, here // 3, domain.twin // 3, domain.same.astype(np.intp)[:, None])[:, 0] % 2
    if ((turns[here // 3] + turns[domain.twin // 3]) % 2 != domain.same).any():
        raise TopologyError("a nonorientable surface has no orientation, and with it no period matrix")
    return 1 - 2 * turns


def intersections(domain: GeodesicTriangulation, jumps: Ints) -> Ints:
    """The integrals of du_i ^ du_j over X/H for multivalued functions with these jumps: (k, k) integers, skew.

    They depend on the classes alone. Raises TopologyError for a nonorientable surface.
    """
    value, sign = corner_values(domain, jumps), orientations(domain)
    first, second = value[..., 1] - value[..., 0], value[..., 2] - value[..., 0]
    twice = (first * sign) @ second.T - (second * sign) @ first.T
    return np.asarray(twice // 2)


def refined_jumps(jumps: Ints) -> Ints:
    """The jumps (k, 12 F) on the triangulation that is refined once: across the halves of edges, and none inside."""
    whole = jumps.reshape(len(jumps), jumps.shape[1] // 3, 3)
    fine = np.zeros((*whole.shape[:2], 4, 3), dtype=np.intp)
    for c in range(3):
        fine[:, :, c, c] = fine[:, :, (c + 1) % 3, c] = whole[:, :, c]
    return fine.reshape(len(jumps), 4 * jumps.shape[1])
