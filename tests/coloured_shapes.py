"""Coloured shapes: the colours of faces as Open CASCADE's readers find them in files."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from OCP.BRepGProp import BRepGProp
from OCP.collections import Sequence_TDF_Label
from OCP.GProp import GProp_GProps
from OCP.IGESCAFControl import IGESCAFControl_Reader
from OCP.Quantity import Quantity_Color, Quantity_TOC_sRGB
from OCP.STEPCAFControl import STEPCAFControl_Reader
from OCP.TCollection import TCollection_ExtendedString
from OCP.TDocStd import TDocStd_Document
from OCP.TopAbs import TopAbs_FACE
from OCP.XCAFDoc import XCAFDoc_ColorGen, XCAFDoc_ColorSurf, XCAFDoc_DocumentTool, XCAFDoc_ShapeTool
from shared_edges import _explored

_READERS = {".step": STEPCAFControl_Reader, ".iges": IGESCAFControl_Reader}


def colours_of_faces(path: Path) -> list[tuple[np.ndarray, np.ndarray]]:
    """The centroid and the colour of every face of a file that has one."""
    document, reader = TDocStd_Document(TCollection_ExtendedString("BinXCAF")), _READERS[path.suffix]()
    reader.SetColorMode(True)
    reader.ReadFile(str(path))
    reader.Transfer(document)
    palette = XCAFDoc_DocumentTool.ColorTool_s(document.Main())
    shapes, found = Sequence_TDF_Label(), []
    XCAFDoc_DocumentTool.ShapeTool_s(document.Main()).GetFreeShapes(shapes)
    for shape in (XCAFDoc_ShapeTool.GetShape_s(shapes.Value(n + 1)) for n in range(shapes.Length())):
        for face in _explored(shape, TopAbs_FACE):
            colour = Quantity_Color()
            if any(palette.GetColor(face, kind, colour) for kind in (XCAFDoc_ColorSurf, XCAFDoc_ColorGen)):
                found.append((_centroid(face), np.array(colour.Values(Quantity_TOC_sRGB))))
    return found


def _centroid(face: Any) -> np.ndarray:
    properties = GProp_GProps()
    BRepGProp.SurfaceProperties_s(face, properties)
    return np.array(properties.CentreOfMass().Coord())
