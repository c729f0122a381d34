"""What Open CASCADE says of the edges of a shape: in how many faces they are, and how these meet there."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from OCP.BRep import BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Curve
from OCP.GeomLProp import GeomLProp_SLProps
from OCP.ShapeAnalysis import ShapeAnalysis_Surface
from OCP.TopAbs import TopAbs_EDGE, TopAbs_FACE
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS


class Meeting(NamedTuple):
    """faces: at each edge; gap: the largest distance of points of edges from their faces; angle: between the tangent
    planes of two faces at an edge, in degrees, the largest.
    """

    faces: list[int]
    gap: float
    angle: float


def meeting(shape: Any, points: int = 23) -> Meeting:
    """By projection of points of every edge to the surfaces of both faces."""
    edges: list[tuple[Any, list[Any]]] = []
    for face in _explored(shape, TopAbs_FACE):
        for edge in _explored(face, TopAbs_EDGE):
            known = next((faces for other, faces in edges if other.IsSame(edge)), None)
            if known is None:
                edges.append((edge, [face]))
            else:
                known.append(face)
    gap = angle = 0.0
    for edge, faces in edges:
        curve = BRepAdaptor_Curve(TopoDS.Edge(edge))
        surfaces = [BRep_Tool.Surface_s(TopoDS.Face(face)) for face in faces]
        # No fractions of two: at the sites of the splines the planes agree anyway.
        first, last = curve.FirstParameter(), curve.LastParameter()
        for u in first + (last - first) * (np.arange(points) + 1 / np.sqrt(7)) / points:
            found = [_projected(surface, curve.Value(float(u))) for surface in surfaces]
            gap = max([gap, *(distance for distance, _ in found)])
            one, other = found[0][1], found[-1][1]
            sine = float(np.linalg.norm(np.cross(one, other)))
            angle = max(angle, math.degrees(math.atan2(sine, abs(float(one @ other)))))
    return Meeting([len(faces) for _, faces in edges], gap, angle)


def _projected(surface: Any, point: Any) -> tuple[float, np.ndarray]:
    foot = ShapeAnalysis_Surface(surface)
    place = foot.ValueOfUV(point, 1e-9)
    normal = GeomLProp_SLProps(surface, place.X(), place.Y(), 1, 1e-9).Normal()
    return foot.Gap(), np.array([normal.X(), normal.Y(), normal.Z()])


def _explored(shape: Any, kind: Any) -> list[Any]:
    explorer, found = TopExp_Explorer(shape, kind), []
    while explorer.More():
        found.append(explorer.Current())
        explorer.Next()
    return found
