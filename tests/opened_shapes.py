"""Shapes of Open CASCADE as its own readers find them in files, and what it says of them."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from OCP.BRep import BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Curve, BRepAdaptor_Curve2d
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.BRepGProp import BRepGProp
from OCP.collections import IndexedDataMap_TopoDS_Shape_List_TopoDS_Shape_TopTools_ShapeMapHasher as FacesOfEdges
from OCP.GCPnts import GCPnts_AbscissaPoint
from OCP.gp import gp_Pnt, gp_Vec
from OCP.GProp import GProp_GProps
from OCP.IGESControl import IGESControl_Reader
from OCP.STEPControl import STEPControl_Reader
from OCP.TopAbs import TopAbs_EDGE, TopAbs_FACE, TopAbs_REVERSED, TopAbs_SHELL, TopAbs_SOLID, TopAbs_VERTEX
from OCP.TopExp import TopExp, TopExp_Explorer
from OCP.TopoDS import TopoDS
from orbiframe_exact.open_cascade import write_iges, write_step

from orbiframe import OrbifoldSurface
from orbiframe.surfaces import PeriodicPatch, QuadrilateralPatches, TrianglePatches

Floats = np.ndarray[Any, np.dtype[np.float64]]

WRITERS = {".step": write_step, ".iges": write_iges}
_READERS = {".step": STEPControl_Reader, ".iges": IGESControl_Reader}


def reopened(surface: OrbifoldSurface, path: Path) -> Any:
    """The shape of a file that a surface is written to."""
    WRITERS[path.suffix](path, surface)
    return read_back(path)


def read_back(path: Path) -> Any:
    """The shape of a file."""
    opened = _READERS[path.suffix]()
    opened.ReadFile(str(path))
    opened.TransferRoots()
    return opened.OneShape()


def is_valid(shape: Any) -> bool:
    return bool(BRepCheck_Analyzer(shape).IsValid())


def is_solid(shape: Any) -> bool:
    return bool(shape.ShapeType() == TopAbs_SOLID)


def is_shell(shape: Any) -> bool:
    return bool(shape.ShapeType() == TopAbs_SHELL)


def area(shape: Any) -> float:
    found = GProp_GProps()
    BRepGProp.SurfaceProperties_s(shape, found, 1e-12, False)
    return float(found.Mass())


def volume(shape: Any) -> float:
    found = GProp_GProps()
    BRepGProp.VolumeProperties_s(shape, found, 1e-12, False, False)
    return float(found.Mass())


def angles_at_edges(shape: Any) -> Floats:
    """Of every edge between two faces its length, and the angle of their outward normals at its middle, (E, 2)."""
    table = FacesOfEdges()
    TopExp.MapShapesAndAncestors_s(shape, TopAbs_EDGE, TopAbs_FACE, table)
    found = []
    for k in range(1, table.Extent() + 1):
        edge, faces = TopoDS.Edge(table.FindKey(k)), [TopoDS.Face(face) for face in table.FindFromIndex(k)]
        if len(faces) == 2 and not BRep_Tool.Degenerated_s(edge):
            one, other = (_normal_at_middle(edge, face) for face in faces)
            length = GCPnts_AbscissaPoint.Length_s(BRepAdaptor_Curve(edge))
            found.append((length, np.degrees(np.arctan2(np.linalg.norm(np.cross(one, other)), one @ other))))
    return np.array(found)


def _normal_at_middle(edge: Any, face: Any) -> Floats:
    curve = BRepAdaptor_Curve2d(edge, face)
    at = curve.Value((curve.FirstParameter() + curve.LastParameter()) / 2)
    place, first, second = gp_Pnt(), gp_Vec(), gp_Vec()
    BRep_Tool.Surface_s(face).D1(at.X(), at.Y(), place, first, second)
    normal = np.cross(first.Coord(), second.Coord())
    sign = -1.0 if face.Orientation() == TopAbs_REVERSED else 1.0
    return np.asarray(sign * normal / np.linalg.norm(normal))


def middles(shape: Any, patches: TrianglePatches | PeriodicPatch) -> Floats:
    """The point in space in the middle of each of the patches, by the surfaces of the faces, (N, 3)."""
    return np.array([BRep_Tool.Surface_s(face).Value(*at).Coord() for face, at in _middles(shape, patches)])


def own_middles(patches: QuadrilateralPatches) -> Floats:
    """The same by the patches themselves."""
    return patches.evaluate(np.array([0.5]), np.array([0.5]))[:, 0]


def _middles(shape: Any, patches: TrianglePatches | PeriodicPatch) -> Iterator[tuple[Any, tuple[float, float]]]:
    """Every face with parameters in the middle of each of its patches."""
    if not isinstance(patches, PeriodicPatch):
        yield from ((face, (0.5, 0.5)) for face in _faces(shape))
        return
    (face,) = _faces(shape)
    surface = BRep_Tool.Surface_s(face)
    u, v = (np.array(list(knots)) for knots in (surface.UKnots(), surface.VKnots()))
    for s in (u[1:] + u[:-1]) / 2:
        yield from ((face, (s, t)) for t in (v[1:] + v[:-1]) / 2)


def _faces(shape: Any) -> Iterator[Any]:
    explorer = TopExp_Explorer(shape, TopAbs_FACE)
    while explorer.More():
        yield TopoDS.Face(explorer.Current())
        explorer.Next()


def euler_characteristic(shape: Any) -> int:
    """Vertices less edges plus faces, each once."""
    kinds = (TopAbs_VERTEX, 1), (TopAbs_EDGE, -1), (TopAbs_FACE, 1)
    found = 0
    for kind, sign in kinds:
        table = FacesOfEdges()
        TopExp.MapShapesAndUniqueAncestors_s(shape, kind, TopAbs_SHELL, table)
        found += sign * table.Extent()
    return found


def _free_edges(shape: Any) -> list[Any]:
    """The edges at which one face ends alone."""
    table = FacesOfEdges()
    TopExp.MapShapesAndAncestors_s(shape, TopAbs_EDGE, TopAbs_FACE, table)
    edges = [(table.FindKey(k), table.FindFromIndex(k).Extent()) for k in range(1, table.Extent() + 1)]
    return [TopoDS.Edge(edge) for edge, count in edges if count == 1]


def free_length(shape: Any) -> float:
    """The length of the boundary of a shell."""
    return sum(float(GCPnts_AbscissaPoint.Length_s(BRepAdaptor_Curve(edge))) for edge in _free_edges(shape))


def free_points(shape: Any) -> Floats:
    """Points of the boundary of a shell, 21 of each edge."""
    curves = [BRepAdaptor_Curve(edge) for edge in _free_edges(shape)]
    places = [c.Value(u) for c in curves for u in np.linspace(c.FirstParameter(), c.LastParameter(), 21)]
    return np.array([[p.X(), p.Y(), p.Z()] for p in places])


def vertices(shape: Any) -> Floats:
    """The vertices of a shape, some of them more than once."""
    explorer, found = TopExp_Explorer(shape, TopAbs_VERTEX), []
    while explorer.More():
        p = BRep_Tool.Pnt_s(TopoDS.Vertex(explorer.Current()))
        found.append([p.X(), p.Y(), p.Z()])
        explorer.Next()
    return np.array(found)
