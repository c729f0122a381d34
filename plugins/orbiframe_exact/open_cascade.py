"""STEP and IGES files with exact rational patches, through Open CASCADE."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from OCP.BRep import BRep_Tool
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace, BRepBuilderAPI_MakeSolid, BRepBuilderAPI_Sewing
from OCP.BRepLib import BRepLib
from OCP.Geom import Geom_BezierSurface
from OCP.gp import gp_Pnt
from OCP.IFSelect import IFSelect_RetDone
from OCP.IGESControl import IGESControl_Writer
from OCP.Interface import Interface_Static
from OCP.Message import Message
from OCP.STEPControl import STEPControl_AsIs, STEPControl_Writer
from OCP.TopAbs import TopAbs_SHELL
from OCP.TopoDS import TopoDS
from OCP.collections import Array2_double, Array2_gp_Pnt

from orbiframe import FitError, OrbifoldSurface, QuadrilateralPatches, triangle_patches

_SEWING = 1e-7  # of the size of the surface: patches share their edges to rounding


def write_step(path: Path, surface: OrbifoldSurface) -> None:
    """The surface as a shell of exact rational patches in a STEP file, three for each micro triangle.

    Raises FitError for a surface without exact patches, or where Open CASCADE fails.
    """
    _silence()
    writer = STEPControl_Writer()
    Interface_Static.SetCVal_s("write.step.unit", "MM")
    _require(writer.Transfer(shape(surface), STEPControl_AsIs) == IFSelect_RetDone, "convert the shape to STEP")
    _require(writer.Write(str(path)) == IFSelect_RetDone, "write the STEP file")


def write_iges(path: Path, surface: OrbifoldSurface) -> None:
    """The surface as exact rational patches in an IGES file; see `write_step`."""
    _silence()
    writer = IGESControl_Writer()
    _require(bool(writer.AddShape(shape(surface))), "convert the shape to IGES")
    writer.ComputeModel()
    _require(bool(writer.Write(str(path))), "write the IGES file")


def shape(surface: OrbifoldSurface) -> Any:
    """The surface as a shape of Open CASCADE: faces on rational Bezier surfaces, sewn together.

    A solid where they make a closed shell with an inside and an outside, else the shell.
    """
    patches = triangle_patches(surface).quadrilaterals()
    sewing = BRepBuilderAPI_Sewing(_SEWING * float(np.ptp(patches.points.reshape(-1, 3), axis=0).max()))
    for face in _faces(patches):
        sewing.Add(face)
    sewing.Perform()
    sewn = sewing.SewedShape()
    if not (surface.orbifold.orientable and sewn.ShapeType() == TopAbs_SHELL and BRep_Tool.IsClosed_s(sewn)):
        return sewn
    solid = BRepBuilderAPI_MakeSolid(TopoDS.Shell(sewn)).Solid()
    BRepLib.OrientClosedSolid_s(solid)
    return solid


def _silence() -> None:
    """Open CASCADE reports its progress on the standard output; the command line has its own."""
    messenger = Message.DefaultMessenger_s()
    for printer in list(messenger.Printers()):
        messenger.RemovePrinter(printer)


def _faces(patches: QuadrilateralPatches) -> list[Any]:
    return [_face(points, weights) for points, weights in zip(patches.points, patches.weights, strict=True)]


def _face(points: Any, weights: Any) -> Any:
    side = len(weights)
    poles, numbers = Array2_gp_Pnt(1, side, 1, side), Array2_double(1, side, 1, side)
    for i in range(side):
        for j in range(side):
            poles.SetValue(i + 1, j + 1, gp_Pnt(*(float(v) for v in points[i, j])))
            numbers.SetValue(i + 1, j + 1, float(weights[i, j]))
    return BRepBuilderAPI_MakeFace(Geom_BezierSurface(poles, numbers), 1e-12).Face()


def _require(done: bool, what: str) -> None:
    if not done:
        raise FitError(f"Open CASCADE could not {what}; try fewer functions, or write a mesh instead")
