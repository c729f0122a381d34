"""Creased shapes: planes and B-spline faces of Open CASCADE that meet at the creases of a surface."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray
from OCP.BRep import BRep_Builder
from OCP.Geom import Geom_Line, Geom_Plane
from OCP.gp import gp_Dir, gp_Pln
from OCP.TopAbs import TopAbs_FORWARD, TopAbs_REVERSED
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS_Face, TopoDS_Wire

from orbiframe import OrbifoldSurface
from orbiframe_exact.creased_domain import CreasedDomain
from orbiframe_exact.creased_faces import CreasedFaces
from orbiframe_exact.plane_borders import PlaneBorders
from orbiframe_exact.shapes import joined, point_of
from orbiframe_exact.spline_shapes import Place, edge_between, spline_edges, spline_face, vertex_at

Floats = NDArray[np.float64]


def creased_shape(found: CreasedFaces, surface: OrbifoldSurface) -> Any:
    """A closed shell of planes, then B-spline faces, in their place in space; a solid where there is an inside."""
    domain = found.domain
    place = Place(surface, domain.places)
    vertices: dict[int, Any] = {}
    splines = spline_edges(found, place, vertices)
    lines: dict[int, tuple[Any, int]] = {}
    borders = PlaneBorders(domain)
    faces = []
    for plane in range(domain.planes.number):
        loops = [
            [_edge(piece, domain, place, vertices, splines, lines) for piece in pieces]
            for pieces in borders.loops(plane)
        ]
        faces.append(_plane_face(domain, plane, place, loops))
    faces += [spline_face(found, q, place, splines) for q in range(domain.count)]
    if domain.orientable and _volume(domain) < 0:
        faces = [face.Reversed() for face in faces]
    return joined(faces, closed=True, solid=domain.orientable)


def _edge(
    piece: tuple[int, int, int],
    domain: CreasedDomain,
    place: Place,
    vertices: dict[int, Any],
    splines: list[Any],
    lines: dict[int, tuple[Any, int]],
) -> Any:
    """The edge of a piece of a border, as the border runs."""
    number, start, end = piece
    if number >= 0:
        forward = bool(domain.ends[number, 0] == start)
        return splines[number].Oriented(TopAbs_FORWARD if forward else TopAbs_REVERSED)
    if number not in lines:
        a, b = place(domain.places[start]), place(domain.places[end])
        ends = tuple(vertex_at(vertices, v, domain.places[v], place) for v in (start, end))
        line = Geom_Line(point_of(a), gp_Dir(*(b - a).tolist()))
        lines[number] = edge_between(line, ends, float(np.linalg.norm(b - a)), place.tolerance), start
    edge, first = lines[number]
    return edge.Oriented(TopAbs_FORWARD if first == start else TopAbs_REVERSED)


def _plane_face(domain: CreasedDomain, plane: int, place: Place, loops: list[list[Any]]) -> Any:
    builder, face = BRep_Builder(), TopoDS_Face()
    normal = domain.planes.normal[plane]
    origin = place.exactly(domain.planes.offset[plane] * normal)
    builder.MakeFace(
        face, Geom_Plane(gp_Pln(point_of(origin), gp_Dir(*normal.tolist()))), TopLoc_Location(), place.tolerance
    )
    for loop in loops:
        wire = TopoDS_Wire()
        builder.MakeWire(wire)
        for edge in loop:
            builder.Add(wire, edge)
        wire.Closed(True)
        builder.Add(face, wire)
    return face


def _volume(domain: CreasedDomain) -> float:
    """About the volume within, of which the sign matters: of six triangles for each one of the triangulation."""
    return sum(float(np.linalg.det(domain.places[rows]).sum()) for rows in _small_triangles(domain)) / 6


def _small_triangles(domain: CreasedDomain) -> Iterator[NDArray[np.intp]]:
    d = domain.triangles
    here = np.arange(3 * d.face_count)
    start, end = d.vertex.ravel(), d.vertex.ravel()[here - here % 3 + (here + 1) % 3]
    middle, centre = d.vertex_count + d.edge, d.vertex_count + d.edge_count + here // 3
    yield np.stack([start, middle, centre], axis=1)
    yield np.stack([middle, end, centre], axis=1)
