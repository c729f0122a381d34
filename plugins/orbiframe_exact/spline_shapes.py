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
    place = Place(surface, np.concatenate(list(found.edge_poles.values())))
    edges = spline_edges(found, place, {})
    faces = [spline_face(found, q, place, edges) for q in range(found.domain.count)]
    solid = found.domain.orientable and found.domain.closed
    if solid and _volume(found) < 0:
        faces = [face.Reversed() for face in faces]
    return joined(faces, closed=found.domain.closed, solid=solid)


class Place:
    """Points in space, rounded, and the tolerance of Open CASCADE for them; box: points of a surface, (n, 3)."""

    def __init__(self, surface: OrbifoldSurface, box: Floats) -> None:
        self._origin, self._scale = surface.origin, surface.scale
        placed = self.exactly(box)
        self._decimals = round(_DIGITS - math.log10(float(np.ptp(placed, axis=0).max())))
        self.tolerance = max(TOLERANCE, ROUNDING * float(np.abs(placed).max()), 2 * 10.0**-self._decimals)

    def __call__(self, points: Floats) -> Floats:
        """The points in space, rounded."""
        return np.asarray(np.round(self.exactly(points), self._decimals))

    def exactly(self, points: Floats) -> Floats:
        """The points, not rounded."""
        return np.asarray(self._origin + self._scale * points)


def vertex_at(vertices: dict[int, Any], number: int, point: Floats, place: Place) -> Any:
    """The vertex of this number, made at a point of the surface if it is not there yet."""
    if number not in vertices:
        vertices[number] = TopoDS_Vertex()
        BRep_Builder().MakeVertex(vertices[number], point_of(place(point)), place.tolerance)
    return vertices[number]


def edge_between(curve: Any, ends: tuple[Any, Any], length: float, tolerance: float) -> Any:
    """An edge on a curve from parameter 0 to its length, between two vertices."""
    builder, edge = BRep_Builder(), TopoDS_Edge()
    builder.MakeEdge(edge, curve, tolerance)
    builder.Add(edge, ends[0].Oriented(TopAbs_FORWARD))
    builder.Add(edge, ends[1].Oriented(TopAbs_REVERSED))
    builder.Range(edge, 0.0, length)
    return edge


def spline_edges(found: FewFaces, place: Place, vertices: dict[int, Any]) -> list[Any]:
    """The edges of B-spline faces, between vertices that are made where they are not there yet."""
    made = []
    for e, numbers in enumerate(found.domain.ends.tolist()):
        poles, breaks = found.edge_poles[e], found.edge_breaks[e]
        start, end = (vertex_at(vertices, v, pole, place) for v, pole in zip(numbers, poles[[0, -1]], strict=True))
        curve = Geom_BSplineCurve(pole_row(place(poles)), number_row(breaks), integer_row(_times(breaks)), DEGREE)
        made.append(edge_between(curve, (start, end), 1.0, place.tolerance))
    return made


def spline_face(found: FewFaces, quad: int, place: Place, edges: list[Any]) -> Any:
    """A B-spline face between its four edges."""
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


def _volume(found: FewFaces) -> float:
    """About the volume within, of which the sign matters: of two triangles in each cell of a grid on every face."""
    even, total = np.linspace(0, 1, 9), 0.0
    for breaks, poles in found.faces.values():
        x = evaluate_grid(breaks, poles, even, even, (0, 0))
        a, b, c, d = x[:-1, :-1], x[1:, :-1], x[1:, 1:], x[:-1, 1:]
        total += float(np.einsum("ijk,ijk->", a, np.cross(b, c) + np.cross(c, d)))
    return total / 6
