"""TriangleArrays: the triangles of X/H as arrays that change in place, and the surgery on them: flip, split, merge.

Compiled. Every operation works on the gluings alone, so it holds in the three geometries, for triangles that
share several edges or are glued to themselves, and for gluings that reverse orientation.
"""

from __future__ import annotations

from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from orbiframe.compiled.decorator import compiled
from orbiframe.compiled.matrices import copy, is_identity, multiply, set_identity
from orbiframe.triangulations.geodesic_triangulation import GeodesicTriangulation

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]
Number = TypeVar("Number", bound=np.generic)

# A triangle of H^2 keeps its frame while tanh^2 of the distance of its centre from the origin is below this, and its
# patch while cosh of the distance of its frame is.
_NEAR = 0.36
_NEAR_PATCH = 1.5


class TriangleArrays(NamedTuple):
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


def arrays_of(triangulation: GeodesicTriangulation, more: int = 0) -> TriangleArrays:
    """The arrays of a triangulation, with room for `more` vertices."""
    count = triangulation.face_count
    room = count + 2 * more
    return TriangleArrays(
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


@compiled(arrays=False)
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


@compiled(arrays=False)
def move(curvature, g, x):  # type: ignore[no-untyped-def]
    """g x for a point x of X, put back on X, as three numbers."""
    a = g[0, 0] * x[0] + g[0, 1] * x[1] + g[0, 2] * x[2]
    b = g[1, 0] * x[0] + g[1, 1] * x[1] + g[1, 2] * x[2]
    c = g[2, 0] * x[0] + g[2, 1] * x[1] + g[2, 2] * x[2]
    if curvature > 0:
        length = np.sqrt(a * a + b * b + c * c)
        return a / length, b / length, c / length
    return (np.sqrt(1 + b * b + c * c) if curvature < 0 else 1.0), b, c


@compiled(arrays=False)
def carry(curvature, p, out):  # type: ignore[no-untyped-def]
    """out = the isometry that takes the origin to a point p of X along the geodesic; on S^2 p0 > -1."""
    share = curvature / (1 + p[0])
    out[0, 0], out[0, 1], out[0, 2] = p[0], -curvature * p[1], -curvature * p[2]
    out[1, 0], out[1, 1], out[1, 2] = p[1], 1 - share * p[1] * p[1], -share * p[1] * p[2]
    out[2, 0], out[2, 1], out[2, 2] = p[2], -share * p[1] * p[2], 1 - share * p[2] * p[2]


# ---- going round ----------------------------------------------------------------------------------------------------


@compiled(arrays=False)
def after(e):  # type: ignore[no-untyped-def]
    """The next halfedge round the triangle."""
    return e - 2 if e % 3 == 2 else e + 1


@compiled(arrays=False)
def before(e):  # type: ignore[no-untyped-def]
    """The previous halfedge round the triangle."""
    return e + 2 if e % 3 == 0 else e - 1


# ---- surgery --------------------------------------------------------------------------------------------------------


@compiled(arrays=False)
def place(triangles, slot, vertex, x):  # type: ignore[no-untyped-def]
    """Put a vertex at the point x into a corner."""
    face, c = slot // 3, slot % 3
    triangles.corners[face, c, 0], triangles.corners[face, c, 1], triangles.corners[face, c, 2] = x
    triangles.vertex[slot] = vertex
    triangles.seat[vertex] = slot


@compiled(arrays=False)
def corner(triangles, slot):  # type: ignore[no-untyped-def]
    """The point at a corner, as three numbers."""
    x = triangles.corners[slot // 3, slot % 3]
    return x[0], x[1], x[2]


@compiled(arrays=False)
def reframe(triangles, face, g):  # type: ignore[no-untyped-def]
    """See a triangle from another frame; g is the isometry from its old frame to the new one, in no array of triangles.

    A frame that is a mirror image makes the corners run clockwise: `_mirror` mends that.
    """
    moved, back = triangles.work[4], triangles.work[5]
    invert(triangles.curvature, g, back)
    for c in range(3):
        x = triangles.corners[face, c]
        x[0], x[1], x[2] = move(triangles.curvature, g, x)
        e = 3 * face + c
        t = triangles.twin[e]
        multiply(g, triangles.gluing[e], moved)
        if t // 3 == face:
            multiply(moved, back, triangles.gluing[e])
        else:
            copy(moved, triangles.gluing[e])
            invert(triangles.curvature, moved, triangles.gluing[t])
    if face < len(triangles.route):
        multiply(g, triangles.route[face], moved)
        copy(moved, triangles.route[face])


@compiled(arrays=False)
def _rewire(triangles, old, new, turned):  # type: ignore[no-untyped-def]
    """Move outer halfedges of some triangles in one frame to other slots; turned: they run the other way there."""
    count = len(old)
    twins, flags = (0, 0, 0, 0), (False, False, False, False)
    t0, t1, t2 = triangles.twin[old[0]], triangles.twin[old[1]], triangles.twin[old[2]]
    t3 = triangles.twin[old[count - 1]]
    s0, s1, s2 = triangles.same[old[0]], triangles.same[old[1]], triangles.same[old[2]]
    s3 = triangles.same[old[count - 1]]
    twins, flags = (t0, t1, t2, t3), (s0, s1, s2, s3)
    for k in range(count):
        copy(triangles.gluing[old[k]], triangles.work[k])
    for k in range(count):
        e, t = new[k], twins[k]
        inside = -1
        for j in range(count):
            if old[j] == t:
                inside = new[j]
        copy(triangles.work[k], triangles.gluing[e])
        if inside >= 0:
            triangles.twin[e], triangles.same[e] = inside, flags[k]
        else:
            triangles.twin[e], triangles.same[e] = t, flags[k] != turned
            triangles.twin[t], triangles.same[t] = e, flags[k] != turned


@compiled(arrays=False)
def _join_inside(triangles, a, b):  # type: ignore[no-untyped-def]
    """Glue two halfedges of triangles in one frame."""
    triangles.twin[a], triangles.twin[b] = b, a
    triangles.same[a] = triangles.same[b] = False
    set_identity(triangles.gluing[a])
    set_identity(triangles.gluing[b])


@compiled(arrays=False)
def _mirror(triangles, face):  # type: ignore[no-untyped-def]
    """See a triangle from the mirror image of its frame; its corners 1 and 2 change places."""
    mirror = triangles.work[6]
    set_identity(mirror)
    mirror[2, 2] = -1.0
    reframe(triangles, face, mirror)
    e = 3 * face
    _rewire(triangles, (e, e + 1, e + 2), (e + 2, e + 1, e), True)
    one, two = corner(triangles, e + 1), corner(triangles, e + 2)
    first, second = triangles.vertex[e + 1], triangles.vertex[e + 2]
    place(triangles, e + 1, second, two)
    place(triangles, e + 2, first, one)
    for i in range(3):
        triangles.placement[face, i, 2] = -triangles.placement[face, i, 2]


@compiled(arrays=False)
def recentre(triangles, face):  # type: ignore[no-untyped-def]
    """Give a triangle of H^2 that is far from the origin of its frame a frame at its centre: digits are lost far out.

    In E^2 and S^2 nothing is lost. Returns whether the frame has changed; the isometry from the old frame to the new
    one then stands in work[7].
    """
    if triangles.curvature >= 0:
        return False
    x = triangles.corners[face]
    a, b, c = x[0, 0] + x[1, 0] + x[2, 0], x[0, 1] + x[1, 1] + x[2, 1], x[0, 2] + x[1, 2] + x[2, 2]
    if b * b + c * c < _NEAR * a * a:
        return False
    length = np.sqrt(a * a - b * b - c * c)
    there, back, moved = triangles.work[6], triangles.work[7], triangles.work[4]
    carry(triangles.curvature, (a / length, b / length, c / length), there)
    invert(triangles.curvature, there, back)
    multiply(triangles.placement[face], there, moved)
    copy(moved, triangles.placement[face])
    reframe(triangles, face, back)
    return True


@compiled(arrays=False)
def _attach_alike(triangles, face, other, across):  # type: ignore[no-untyped-def]
    """Attach two triangles in one frame to the nearer of their patches; the other came by the isometry `across`."""
    if triangles.curvature < 0 and triangles.placement[face, 0, 0] > _NEAR_PATCH:
        back, moved = triangles.work[4], triangles.work[5]
        invert(triangles.curvature, across, back)
        multiply(triangles.placement[other], back, moved)
        if moved[0, 0] < triangles.placement[face, 0, 0]:
            copy(moved, triangles.placement[face])
            triangles.patch[face] = triangles.patch[other]
    triangles.patch[other] = triangles.patch[face]
    copy(triangles.placement[face], triangles.placement[other])


@compiled(arrays=False)
def adopt(triangles, e):  # type: ignore[no-untyped-def]
    """Bring the triangle across halfedge e, another one, into the frame of the triangle of e; returns the twin of e."""
    face = e // 3
    if triangles.same[e]:
        _mirror(triangles, triangles.twin[e] // 3)
    t = triangles.twin[e]
    other = t // 3
    if not is_identity(triangles.gluing[e]):
        across = triangles.work[7]
        copy(triangles.gluing[e], across)
        reframe(triangles, other, across)
        _attach_alike(triangles, face, other, across)
    return t


@compiled(arrays=False)
def flip(triangles, e):  # type: ignore[no-untyped-def]
    """Replace an edge between two different triangles by the other diagonal of their quadrilateral.

    e = 3 f runs afterwards from the old apex of f to that of the other triangle g, whose halfedge 3 g runs back; the
    outer halfedges are the others of f and g, and both lie in the frame of f.
    """
    recentre(triangles, e // 3)
    t = adopt(triangles, e)
    f, g = 3 * (e // 3), 3 * (t // 3)
    e1, e2, t1, t2 = after(e), before(e), after(t), before(t)
    a, b, c, d = corner(triangles, e), corner(triangles, t), corner(triangles, e2), corner(triangles, t2)
    va, vb, vc, vd = triangles.vertex[e], triangles.vertex[t], triangles.vertex[e2], triangles.vertex[t2]
    _rewire(triangles, (t2, e1, e2, t1), (f + 1, f + 2, g + 1, g + 2), False)
    _join_inside(triangles, f, g)
    place(triangles, f, vc, c)
    place(triangles, f + 1, vd, d)
    place(triangles, f + 2, vb, b)
    place(triangles, g, vd, d)
    place(triangles, g + 1, vc, c)
    place(triangles, g + 2, va, a)


@compiled(arrays=False)
def split(triangles, face, x, vertex, second, third):  # type: ignore[no-untyped-def]
    """A new vertex at x in a triangle: three triangles, with x at corner 2, in this slot and two free ones."""
    f, g, h = 3 * face, 3 * second, 3 * third
    a, b, c = corner(triangles, f), corner(triangles, f + 1), corner(triangles, f + 2)
    va, vb, vc = triangles.vertex[f], triangles.vertex[f + 1], triangles.vertex[f + 2]
    _rewire(triangles, (f, f + 1, f + 2), (f, g, h), False)
    _join_inside(triangles, f + 1, g + 2)
    _join_inside(triangles, g + 1, h + 2)
    _join_inside(triangles, h + 1, f + 2)
    for slot in (second, third):
        triangles.patch[slot] = triangles.patch[face]
        copy(triangles.placement[face], triangles.placement[slot])
    place(triangles, f, va, a)
    place(triangles, f + 1, vb, b)
    place(triangles, g, vb, b)
    place(triangles, g + 1, vc, c)
    place(triangles, h, vc, c)
    place(triangles, h + 1, va, a)
    for slot in (f, g, h):
        place(triangles, slot + 2, vertex, x)


@compiled(arrays=False)
def merge(triangles, e):  # type: ignore[no-untyped-def]
    """Remove the vertex where e starts, a corner of three triangles: they become one, in the slot of the first."""
    f = 3 * (e // 3)
    t = adopt(triangles, before(e))
    u = adopt(triangles, before(t))
    # The triangles are (v, p, q), (v, q, r) and (v, r, p); e, t and u start at v.
    p, q, r = corner(triangles, after(e)), corner(triangles, after(t)), corner(triangles, after(u))
    vp, vq, vr = triangles.vertex[after(e)], triangles.vertex[after(t)], triangles.vertex[after(u)]
    gone = triangles.vertex[e]
    _rewire(triangles, (after(e), after(t), after(u)), (f, f + 1, f + 2), False)
    for slot in (t, u):
        first = 3 * (slot // 3)
        triangles.twin[first], triangles.twin[first + 1], triangles.twin[first + 2] = -1, -1, -1
    place(triangles, f, vp, p)
    place(triangles, f + 1, vq, q)
    place(triangles, f + 2, vr, r)
    triangles.seat[gone] = -1
