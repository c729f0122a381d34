"""Shapes of Open CASCADE: faces on exact patches, joined by the edges that they are known to share."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from OCP.BRep import BRep_Builder
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace
from OCP.collections import Array1_double, Array1_gp_Pnt, Array1_int, Array2_double, Array2_gp_Pnt
from OCP.Geom import Geom_BezierCurve, Geom_BezierSurface, Geom_BSplineSurface
from OCP.Geom2d import Geom2d_Line
from OCP.gp import gp_Dir2d, gp_Pnt, gp_Pnt2d
from OCP.TopAbs import TopAbs_FORWARD, TopAbs_REVERSED
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS_Edge, TopoDS_Face, TopoDS_Shell, TopoDS_Solid, TopoDS_Vertex, TopoDS_Wire

from orbiframe.surfaces import PeriodicPatch, QuadrilateralPatches, TrianglePatches

Floats = NDArray[np.float64]

# The least tolerance of Open CASCADE, and one for what is far from the origin.
TOLERANCE, ROUNDING = 1e-7, 1e-14
_CORNERS = ((0, 0), (1, 0), (1, 1), (0, 1))


def shape_of(patches: TrianglePatches | PeriodicPatch) -> Any:
    """A closed shell of faces on the patches; a solid with this shell where the surface has an inside."""
    if isinstance(patches, PeriodicPatch):
        return joined([_periodic_face(patches)], closed=not patches.glide, solid=not patches.glide)
    quadrilaterals = patches.quadrilaterals()
    return joined(_faces(quadrilaterals), closed=True, solid=not quadrilaterals.gluing.same.any())


def joined(faces: Iterable[Any], *, closed: bool, solid: bool) -> Any:
    """A shell of faces, or a solid with this shell."""
    builder, shell = BRep_Builder(), TopoDS_Shell()
    builder.MakeShell(shell)
    for face in faces:
        builder.Add(shell, face)
    shell.Closed(closed)
    if not solid:
        return shell
    body = TopoDS_Solid()
    builder.MakeSolid(body)
    builder.Add(body, shell)
    return body


# ---- patches --------------------------------------------------------------------------------------------------------


def _faces(patches: QuadrilateralPatches) -> list[Any]:
    """A face on every patch, with edges and vertices that are shared as the gluing says."""
    tolerance = max(TOLERANCE, ROUNDING * float(np.abs(patches.points).max()))
    edges = _edges(patches, tolerance)
    return [
        _face(points, weights, edges[4 * p : 4 * p + 4], tolerance)
        for p, (points, weights) in enumerate(zip(patches.points, patches.weights, strict=True))
    ]


def _edges(patches: QuadrilateralPatches, tolerance: float) -> list[tuple[Any, bool]]:
    """The edge at each side, with whether the side runs as the edge does."""
    gluing, builder = patches.gluing, BRep_Builder()
    vertices = _vertices(patches, tolerance)
    made: list[tuple[Any, bool]] = []
    for side, (twin, same) in enumerate(zip(gluing.twin.tolist(), gluing.same.tolist(), strict=True)):
        if twin < side:
            made.append((made[twin][0], same))
            continue
        edge, start = TopoDS_Edge(), vertices[side]
        builder.MakeEdge(edge, _curve(patches, side), tolerance)
        builder.Add(edge, start.Oriented(TopAbs_FORWARD))
        builder.Add(edge, vertices[side - side % 4 + (side + 1) % 4].Oriented(TopAbs_REVERSED))
        builder.Range(edge, 0.0, 1.0)
        made.append((edge, True))
    return made


def _vertices(patches: QuadrilateralPatches, tolerance: float) -> list[Any]:
    """The vertex at the start of each side."""
    classes, builder = patches.gluing.corner_classes(4), BRep_Builder()
    corners = np.stack([patches.points[:, -s, -t] for s, t in _CORNERS], axis=1).reshape(-1, 3)
    made = []
    for corner in np.unique(classes, return_index=True)[1]:
        vertex = TopoDS_Vertex()
        builder.MakeVertex(vertex, point_of(corners[corner]), tolerance)
        made.append(vertex)
    return [made[c] for c in classes]


def _curve(patches: QuadrilateralPatches, side: int) -> Any:
    """The border curve of a side, from 0 to 1."""
    patch, c = divmod(side, 4)
    along = (np.s_[:, 0], np.s_[-1, :], np.s_[::-1, -1], np.s_[0, ::-1])[c]
    return Geom_BezierCurve(pole_row(patches.points[patch][along]), number_row(patches.weights[patch][along]))


def _face(points: Floats, weights: Floats, sides: list[tuple[Any, bool]], tolerance: float) -> Any:
    builder, face, wire = BRep_Builder(), TopoDS_Face(), TopoDS_Wire()
    builder.MakeFace(face, Geom_BezierSurface(pole_table(points), _matrix(weights)), TopLoc_Location(), tolerance)
    builder.MakeWire(wire)
    for c, (edge, forward) in enumerate(sides):
        builder.UpdateEdge(edge, border_line(c, forward), face, tolerance)
        builder.Add(wire, edge.Oriented(TopAbs_FORWARD if forward else TopAbs_REVERSED))
    wire.Closed(True)
    builder.Add(face, wire)
    return face


def border_line(side: int, forward: bool) -> Any:
    """The border of the unit square as the edge runs, from 0 to 1."""
    start, end = _CORNERS[side], _CORNERS[(side + 1) % 4]
    if not forward:
        start, end = end, start
    return Geom2d_Line(gp_Pnt2d(*map(float, start)), gp_Dir2d(float(end[0] - start[0]), float(end[1] - start[1])))


# ---- one periodic surface -------------------------------------------------------------------------------------------


def _periodic_face(patch: PeriodicPatch) -> Any:
    """One face on a surface that is periodic in u and v; of a Klein bottle one period of its glide."""
    numbers = [np.unique(knots, return_counts=True) for knots in patch.knots]
    points = patch.points
    for axis, (_, first) in enumerate(numbers):
        # Here N_0 begins at the first knot; there the last of the first knots is knot `degree` of pole 1.
        points = np.roll(points, patch.degree + 1 - int(first[0]), axis=axis)
    knots = [number_row(np.append(k, k[0] + p)) for (k, _), p in zip(numbers, patch.periods, strict=True)]
    times = [integer_row(np.append(t, t[0])) for _, t in numbers]
    surface = Geom_BSplineSurface(pole_table(points), *knots, *times, patch.degree, patch.degree, True, True)
    if patch.glide:
        u, v = (float(k[0]) for k, _ in numbers)
        surface.Segment(u, u + 1, v, v + 1)
    return BRepBuilderAPI_MakeFace(surface, TOLERANCE).Face()


# ---- numbers --------------------------------------------------------------------------------------------------------


def point_of(point: Floats) -> Any:
    """A point (3,) of Open CASCADE."""
    return gp_Pnt(*point.tolist())


def pole_row(points: Floats) -> Any:
    """Control points (n, 3) of a curve."""
    made = Array1_gp_Pnt(1, len(points))
    for i, point in enumerate(points.tolist()):
        made.SetValue(i + 1, gp_Pnt(*point))
    return made


def pole_table(points: Floats) -> Any:
    """Control points (m, n, 3) of a surface."""
    rows, columns = points.shape[:2]
    made = Array2_gp_Pnt(1, rows, 1, columns)
    for i, row in enumerate(points.tolist()):
        for j, point in enumerate(row):
            made.SetValue(i + 1, j + 1, gp_Pnt(*point))
    return made


def _matrix(numbers: Floats) -> Any:
    made = Array2_double(1, numbers.shape[0], 1, numbers.shape[1])
    for i, row in enumerate(numbers.tolist()):
        for j, number in enumerate(row):
            made.SetValue(i + 1, j + 1, number)
    return made


def number_row(numbers: Floats) -> Any:
    """Numbers (n,) of Open CASCADE."""
    made = Array1_double(1, len(numbers))
    for i, number in enumerate(numbers.tolist()):
        made.SetValue(i + 1, number)
    return made


def integer_row(numbers: NDArray[np.intp]) -> Any:
    """Integers (n,) of Open CASCADE."""
    made = Array1_int(1, len(numbers))
    for i, number in enumerate(numbers.tolist()):
        made.SetValue(i + 1, number)
    return made
