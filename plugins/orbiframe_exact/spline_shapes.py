"""Spline shapes: B-spline faces of Open CASCADE with the edges that they are known to share."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray
from OCP.BRep import BRep_Builder
from OCP.Geom import Geom_BSplineCurve, Geom_BSplineSurface
from OCP.TopAbs import TopAbs_FORWARD, TopAbs_REVERSED
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS_Edge, TopoDS_Face, TopoDS_Vertex, TopoDS_Wire

from orbiframe import OrbifoldSurface
from orbiframe_exact.complete_spline import DEGREE, evaluate_grid
from orbiframe_exact.few_faces import FewFaces
from orbiframe_exact.shapes import (
    ROUNDING,
    TOLERANCE,
    border_line,
    integer_row,
    joined,
    number_row,
    point_of,
    pole_row,
    pole_table,
)

Floats = NDArray[np.float64]

# Digits of a coordinate, counted from the size of the box: far below any tolerance, and a third less of a file.
_DIGITS = 9


def spline_shape(found: FewFaces, surface: OrbifoldSurface) -> Any:
    """A shell of B-spline faces in their place in space; a solid that looks outward where there is an inside."""
    place = _Place(found, surface)
    edges = _edges(found, place)
    faces = [_face(found, q, place, edges) for q in range(found.domain.count)]
    solid = found.domain.orientable and found.domain.closed
    if solid and _volume(found) < 0:
        faces = [face.Reversed() for face in faces]
    return joined(faces, closed=found.domain.closed, solid=solid)


class _Place:
    """Control points in space, rounded, and the tolerance of Open CASCADE for them."""

    def __init__(self, found: FewFaces, surface: OrbifoldSurface) -> None:
        self._origin, self._scale = surface.origin, surface.scale
        box = np.concatenate([self._placed(poles) for poles in found.edge_poles.values()])
        self._decimals = _DIGITS - math.floor(math.log10(float(np.ptp(box, axis=0).max())))
        self.tolerance = max(TOLERANCE, ROUNDING * float(np.abs(box).max()))

    def __call__(self, poles: Floats) -> Floats:
        return np.asarray(np.round(self._placed(poles), self._decimals))

    def _placed(self, poles: Floats) -> Floats:
        return np.asarray(self._origin + self._scale * poles)


def _edges(found: FewFaces, place: _Place) -> list[Any]:
    builder, vertices = BRep_Builder(), {}
    for ends, poles in zip(found.domain.ends.tolist(), _in_order(found.edge_poles), strict=True):
        for vertex, pole in zip(ends, (poles[0], poles[-1]), strict=True):
            if vertex not in vertices:
                vertices[vertex] = TopoDS_Vertex()
                builder.MakeVertex(vertices[vertex], point_of(place(pole)), place.tolerance)
    made = []
    for e, (start, end) in enumerate(found.domain.ends.tolist()):
        points, breaks, edge = place(found.edge_poles[e]), found.edge_breaks[e], TopoDS_Edge()
        curve = Geom_BSplineCurve(pole_row(points), number_row(breaks), integer_row(_times(breaks)), DEGREE)
        builder.MakeEdge(edge, curve, place.tolerance)
        builder.Add(edge, vertices[start].Oriented(TopAbs_FORWARD))
        builder.Add(edge, vertices[end].Oriented(TopAbs_REVERSED))
        builder.Range(edge, 0.0, 1.0)
        made.append(edge)
    return made


def _face(found: FewFaces, quad: int, place: _Place, edges: list[Any]) -> Any:
    builder, face, wire = BRep_Builder(), TopoDS_Face(), TopoDS_Wire()
    breaks, poles = found.faces[quad]
    rows = [number_row(b) for b in breaks] + [integer_row(_times(b)) for b in breaks]
    surface = Geom_BSplineSurface(pole_table(place(poles)), *rows, DEGREE, DEGREE, False, False)
    builder.MakeFace(face, surface, TopLoc_Location(), place.tolerance)
    builder.MakeWire(wire)
    for k in range(4):
        edge = edges[found.domain.edge[quad, k]]
        forward = bool(found.domain.rising[quad, k]) == (k < 2)
        builder.UpdateEdge(edge, border_line(k, forward), face, place.tolerance)
        builder.Add(wire, edge.Oriented(TopAbs_FORWARD if forward else TopAbs_REVERSED))
    wire.Closed(True)
    builder.Add(face, wire)
    return face


def _times(breaks: Floats) -> NDArray[np.intp]:
    times = np.ones(len(breaks), dtype=np.intp)
    times[[0, -1]] = DEGREE + 1
    return times


def _in_order(poles: dict[int, Floats]) -> list[Floats]:
    return [poles[e] for e in range(len(poles))]


def _volume(found: FewFaces) -> float:
    """About the volume within, of which the sign matters: of two triangles in each cell of a grid on every face."""
    even, total = np.linspace(0, 1, 9), 0.0
    for breaks, poles in found.faces.values():
        x = evaluate_grid(breaks, poles, even, even, (0, 0))
        a, b, c, d = x[:-1, :-1], x[1:, :-1], x[1:, 1:], x[:-1, 1:]
        total += float(np.einsum("ijk,ijk->", a, np.cross(b, c) + np.cross(c, d)))
    return total / 6
