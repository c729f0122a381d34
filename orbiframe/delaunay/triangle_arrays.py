"""Cells: the triangles of X/H as arrays that change in place, and the surgery on them: flip, split, merge.

Compiled by numba. Every operation works on the gluings alone, so it holds in the three geometries, for triangles that
share several edges or are glued to themselves, and for gluings that reverse orientation.
"""

from __future__ import annotations

from typing import NamedTuple, TypeVar

import numpy as np
from numba import njit
from numpy.typing import NDArray

from orbiframe.triangulations.geodesic_triangulation import GeodesicTriangulation

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]
Number = TypeVar("Number", bound=np.generic)

# A triangle of H^2 keeps its frame while tanh^2 of the distance of its centre from the origin is below this, and its
# patch while cosh of the distance of its frame is.
_NEAR = 0.36
_NEAR_PATCH = 1.5


# For functions that make no array: they need not count who refers to the arrays they are given, which takes longer than
# what they do with them.
bare = njit(cache=True, _nrt=False)  # type: ignore[call-overload]


class Cells(NamedTuple):
    """A geodesic triangulation that changes in place, with room for more triangles and vertices.

    curvature, corners, twin, same, gluing, patch and placement as in `GeodesicTriangulation`; twin is -1 in a slot
    without a triangle. vertex: (3 F,), the vertex at every corner; seat: (V,), some corner 3 f + c of every vertex;
    route: (F, 3, 3), the isometry from the frame that a slot had at first (or when the
    insertion of sites began) to its frame now. stack and queued: edges
    that wait to be looked at; work: matrices for use within one operation.
    """

    curvature: int
    corners: Floats
    twin: Ints
    same: Bools
    gluing: Floats
    vertex: Ints
    seat: Ints
    patch: Ints
    placement: Floats
    route: Floats
    stack: Ints
    queued: Bools
    work: Floats


def cells_of(triangulation: GeodesicTriangulation, more: int = 0) -> Cells:
    """The cells of a triangulation, with room for `more` vertices."""
    count = triangulation.face_count
    room = count + 2 * more
    return Cells(
        curvature=triangulation.geometry.curvature,
        corners=_longer(triangulation.corners, room),
        twin=_longer(triangulation.twin, 3 * room, -1),
        same=_longer(triangulation.same, 3 * room),
        gluing=_longer(triangulation.gluing, 3 * room),
        vertex=_longer(triangulation.vertex.ravel(), 3 * room, -1),
        seat=_longer(triangulation.vertex_corner, triangulation.vertex_count + more, -1),
        patch=_longer(triangulation.patch, room),
        placement=_longer(triangulation.placement, room),
        route=np.tile(np.eye(3), (count, 1, 1)),
        stack=np.empty(3 * room, dtype=np.intp),
        queued=np.zeros(3 * room, dtype=np.bool_),
        work=np.empty((8, 3, 3)),
    )


def _longer(values: NDArray[Number], size: int, fill: int = 0) -> NDArray[Number]:
    extended = np.full((size, *values.shape[1:]), fill, dtype=values.dtype)
    extended[: len(values)] = values
    return extended


# ---- matrices -------------------------------------------------------------------------------------------------------


@bare
def multiply(a, b, out):  # type: ignore[no-untyped-def]
    """out = a b; out is another array than a and b."""
    for i in range(3):
        for j in range(3):
            out[i, j] = a[i, 0] * b[0, j] + a[i, 1] * b[1, j] + a[i, 2] * b[2, j]


@bare
def invert(curvature, g, out):  # type: ignore[no-untyped-def]
    """out = the inverse of the isometry g; out is another array than g."""
    for i in range(3):
        for j in range(3):
            out[i, j] = g[j, i]
    if curvature < 0:
        for i in range(1, 3):
            out[0, i], out[i, 0] = -out[0, i], -out[i, 0]
    if curvature == 0:
        out[0, 1] = out[0, 2] = 0.0
        for i in range(1, 3):
            out[i, 0] = -(g[1, i] * g[1, 0] + g[2, i] * g[2, 0])


@bare
def move(curvature, g, x):  # type: ignore[no-untyped-def]
    """g x for a point x of X, put back on X, as three numbers."""
    a = g[0, 0] * x[0] + g[0, 1] * x[1] + g[0, 2] * x[2]
    b = g[1, 0] * x[0] + g[1, 1] * x[1] + g[1, 2] * x[2]
    c = g[2, 0] * x[0] + g[2, 1] * x[1] + g[2, 2] * x[2]
    if curvature > 0:
        length = np.sqrt(a * a + b * b + c * c)
        return a / length, b / length, c / length
    return (np.sqrt(1 + b * b + c * c) if curvature < 0 else 1.0), b, c


@bare
def copy(a, out):  # type: ignore[no-untyped-def]
    """out = a, entry by entry: quicker than an assignment of slices."""
    for i in range(3):
        for j in range(3):
            out[i, j] = a[i, j]


@bare
def _set_identity(g):  # type: ignore[no-untyped-def]
    for i in range(3):
        for j in range(3):
            g[i, j] = 1.0 if i == j else 0.0


@bare
def is_identity(g):  # type: ignore[no-untyped-def]
    """Whether g is the identity, to the bit."""
    for i in range(3):
        for j in range(3):
            if g[i, j] != (1.0 if i == j else 0.0):
                return False
    return True


@bare
def carry(curvature, p, out):  # type: ignore[no-untyped-def]
    """out = the isometry that takes the origin to a point p of X along the geodesic; on S^2 p0 > -1."""
    share = curvature / (1 + p[0])
    out[0, 0], out[0, 1], out[0, 2] = p[0], -curvature * p[1], -curvature * p[2]
    out[1, 0], out[1, 1], out[1, 2] = p[1], 1 - share * p[1] * p[1], -share * p[1] * p[2]
    out[2, 0], out[2, 1], out[2, 2] = p[2], -share * p[1] * p[2], 1 - share * p[2] * p[2]


# ---- going round ----------------------------------------------------------------------------------------------------


@bare
def after(e):  # type: ignore[no-untyped-def]
    """The next halfedge round the triangle."""
    return e - 2 if e % 3 == 2 else e + 1


@bare
def before(e):  # type: ignore[no-untyped-def]
    """The previous halfedge round the triangle."""
    return e + 2 if e % 3 == 0 else e - 1


# ---- surgery --------------------------------------------------------------------------------------------------------


@bare
def place(cells, slot, vertex, x):  # type: ignore[no-untyped-def]
    """Put a vertex at the point x into a corner."""
    face, c = slot // 3, slot % 3
    cells.corners[face, c, 0], cells.corners[face, c, 1], cells.corners[face, c, 2] = x
    cells.vertex[slot] = vertex
    cells.seat[vertex] = slot


@bare
def corner(cells, slot):  # type: ignore[no-untyped-def]
    """The point at a corner, as three numbers."""
    x = cells.corners[slot // 3, slot % 3]
    return x[0], x[1], x[2]


@bare
def reframe(cells, face, g):  # type: ignore[no-untyped-def]
    """See a triangle from another frame; g is the isometry from its old frame to the new one, in no array of cells.

    A frame that is a mirror image makes the corners run clockwise: `_mirror` mends that.
    """
    moved, back = cells.work[4], cells.work[5]
    invert(cells.curvature, g, back)
    for c in range(3):
        x = cells.corners[face, c]
        x[0], x[1], x[2] = move(cells.curvature, g, x)
        e = 3 * face + c
        t = cells.twin[e]
        multiply(g, cells.gluing[e], moved)
        if t // 3 == face:
            multiply(moved, back, cells.gluing[e])
        else:
            copy(moved, cells.gluing[e])
            invert(cells.curvature, moved, cells.gluing[t])
    if face < len(cells.route):
        multiply(g, cells.route[face], moved)
        copy(moved, cells.route[face])


@bare
def _rewire(cells, old, new, turned):  # type: ignore[no-untyped-def]
    """Move outer halfedges of some triangles in one frame to other slots; turned: they run the other way there."""
    count = len(old)
    twins, flags = (0, 0, 0, 0), (False, False, False, False)
    t0, t1, t2 = cells.twin[old[0]], cells.twin[old[1]], cells.twin[old[2]]
    t3 = cells.twin[old[count - 1]]
    s0, s1, s2 = cells.same[old[0]], cells.same[old[1]], cells.same[old[2]]
    s3 = cells.same[old[count - 1]]
    twins, flags = (t0, t1, t2, t3), (s0, s1, s2, s3)
    for k in range(count):
        copy(cells.gluing[old[k]], cells.work[k])
    for k in range(count):
        e, t = new[k], twins[k]
        inside = -1
        for j in range(count):
            if old[j] == t:
                inside = new[j]
        copy(cells.work[k], cells.gluing[e])
        if inside >= 0:
            cells.twin[e], cells.same[e] = inside, flags[k]
        else:
            cells.twin[e], cells.same[e] = t, flags[k] != turned
            cells.twin[t], cells.same[t] = e, flags[k] != turned


@bare
def _join_inside(cells, a, b):  # type: ignore[no-untyped-def]
    """Glue two halfedges of triangles in one frame."""
    cells.twin[a], cells.twin[b] = b, a
    cells.same[a] = cells.same[b] = False
    _set_identity(cells.gluing[a])
    _set_identity(cells.gluing[b])


@bare
def _mirror(cells, face):  # type: ignore[no-untyped-def]
    """See a triangle from the mirror image of its frame; its corners 1 and 2 change places."""
    mirror = cells.work[6]
    _set_identity(mirror)
    mirror[2, 2] = -1.0
    reframe(cells, face, mirror)
    e = 3 * face
    _rewire(cells, (e, e + 1, e + 2), (e + 2, e + 1, e), True)
    one, two = corner(cells, e + 1), corner(cells, e + 2)
    first, second = cells.vertex[e + 1], cells.vertex[e + 2]
    place(cells, e + 1, second, two)
    place(cells, e + 2, first, one)
    for i in range(3):
        cells.placement[face, i, 2] = -cells.placement[face, i, 2]


@bare
def recentre(cells, face):  # type: ignore[no-untyped-def]
    """Give a triangle of H^2 that is far from the origin of its frame a frame at its centre: digits are lost far out.

    In E^2 and S^2 nothing is lost. Returns whether the frame has changed; the isometry from the old frame to the new
    one then stands in work[7].
    """
    if cells.curvature >= 0:
        return False
    x = cells.corners[face]
    a, b, c = x[0, 0] + x[1, 0] + x[2, 0], x[0, 1] + x[1, 1] + x[2, 1], x[0, 2] + x[1, 2] + x[2, 2]
    if b * b + c * c < _NEAR * a * a:
        return False
    length = np.sqrt(a * a - b * b - c * c)
    there, back, moved = cells.work[6], cells.work[7], cells.work[4]
    carry(cells.curvature, (a / length, b / length, c / length), there)
    invert(cells.curvature, there, back)
    multiply(cells.placement[face], there, moved)
    copy(moved, cells.placement[face])
    reframe(cells, face, back)
    return True


@bare
def _attach_alike(cells, face, other, across):  # type: ignore[no-untyped-def]
    """Attach two triangles in one frame to the nearer of their patches; the other came by the isometry `across`."""
    if cells.curvature < 0 and cells.placement[face, 0, 0] > _NEAR_PATCH:
        back, moved = cells.work[4], cells.work[5]
        invert(cells.curvature, across, back)
        multiply(cells.placement[other], back, moved)
        if moved[0, 0] < cells.placement[face, 0, 0]:
            copy(moved, cells.placement[face])
            cells.patch[face] = cells.patch[other]
    cells.patch[other] = cells.patch[face]
    copy(cells.placement[face], cells.placement[other])


@bare
def adopt(cells, e):  # type: ignore[no-untyped-def]
    """Bring the triangle across halfedge e, another one, into the frame of the triangle of e; returns the twin of e."""
    face = e // 3
    if cells.same[e]:
        _mirror(cells, cells.twin[e] // 3)
    t = cells.twin[e]
    other = t // 3
    if not is_identity(cells.gluing[e]):
        across = cells.work[7]
        copy(cells.gluing[e], across)
        reframe(cells, other, across)
        _attach_alike(cells, face, other, across)
    return t


@bare
def flip(cells, e):  # type: ignore[no-untyped-def]
    """Replace an edge between two different triangles by the other diagonal of their quadrilateral.

    e = 3 f runs afterwards from the old apex of f to that of the other triangle g, whose halfedge 3 g runs back; the
    outer halfedges are the others of f and g, and both lie in the frame of f.
    """
    recentre(cells, e // 3)
    t = adopt(cells, e)
    f, g = 3 * (e // 3), 3 * (t // 3)
    e1, e2, t1, t2 = after(e), before(e), after(t), before(t)
    a, b, c, d = corner(cells, e), corner(cells, t), corner(cells, e2), corner(cells, t2)
    va, vb, vc, vd = cells.vertex[e], cells.vertex[t], cells.vertex[e2], cells.vertex[t2]
    _rewire(cells, (t2, e1, e2, t1), (f + 1, f + 2, g + 1, g + 2), False)
    _join_inside(cells, f, g)
    place(cells, f, vc, c)
    place(cells, f + 1, vd, d)
    place(cells, f + 2, vb, b)
    place(cells, g, vd, d)
    place(cells, g + 1, vc, c)
    place(cells, g + 2, va, a)


@bare
def split(cells, face, x, vertex, second, third):  # type: ignore[no-untyped-def]
    """A new vertex at x in a triangle: three triangles, with x at corner 2, in this slot and two free ones."""
    f, g, h = 3 * face, 3 * second, 3 * third
    a, b, c = corner(cells, f), corner(cells, f + 1), corner(cells, f + 2)
    va, vb, vc = cells.vertex[f], cells.vertex[f + 1], cells.vertex[f + 2]
    _rewire(cells, (f, f + 1, f + 2), (f, g, h), False)
    _join_inside(cells, f + 1, g + 2)
    _join_inside(cells, g + 1, h + 2)
    _join_inside(cells, h + 1, f + 2)
    for slot in (second, third):
        cells.patch[slot] = cells.patch[face]
        copy(cells.placement[face], cells.placement[slot])
    place(cells, f, va, a)
    place(cells, f + 1, vb, b)
    place(cells, g, vb, b)
    place(cells, g + 1, vc, c)
    place(cells, h, vc, c)
    place(cells, h + 1, va, a)
    for slot in (f, g, h):
        place(cells, slot + 2, vertex, x)


@bare
def merge(cells, e):  # type: ignore[no-untyped-def]
    """Remove the vertex where e starts, a corner of three triangles: they become one, in the slot of the first."""
    f = 3 * (e // 3)
    t = adopt(cells, before(e))
    u = adopt(cells, before(t))
    # The triangles are (v, p, q), (v, q, r) and (v, r, p); e, t and u start at v.
    p, q, r = corner(cells, after(e)), corner(cells, after(t)), corner(cells, after(u))
    vp, vq, vr = cells.vertex[after(e)], cells.vertex[after(t)], cells.vertex[after(u)]
    gone = cells.vertex[e]
    _rewire(cells, (after(e), after(t), after(u)), (f, f + 1, f + 2), False)
    for slot in (t, u):
        first = 3 * (slot // 3)
        cells.twin[first], cells.twin[first + 1], cells.twin[first + 2] = -1, -1, -1
    place(cells, f, vp, p)
    place(cells, f + 1, vq, q)
    place(cells, f + 2, vr, r)
    cells.seat[gone] = -1
