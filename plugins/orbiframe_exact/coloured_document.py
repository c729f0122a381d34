"""Coloured document: a shape of Open CASCADE whose faces have colours, as its writers take it."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from OCP.Quantity import Quantity_Color, Quantity_TOC_sRGB
from OCP.TCollection import TCollection_ExtendedString
from OCP.TDocStd import TDocStd_Document
from OCP.TopAbs import TopAbs_FACE
from OCP.TopExp import TopExp_Explorer
from OCP.XCAFDoc import XCAFDoc_ColorSurf, XCAFDoc_DocumentTool


def document_of(shape: Any, colours: NDArray[np.float64] | None = None) -> Any:
    """A document with one shape, and the colours (F, 3) of its faces, red, green, blue from 0 to 1 as on screens."""
    document = TDocStd_Document(TCollection_ExtendedString("BinXCAF"))
    shapes = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    label = shapes.AddShape(shape, False)
    if colours is not None:
        palette = XCAFDoc_DocumentTool.ColorTool_s(document.Main())
        for face, rgb in zip(_faces(shape), colours.tolist(), strict=True):
            palette.SetColor(
                shapes.AddSubShape(label, face), Quantity_Color(*rgb, Quantity_TOC_sRGB), XCAFDoc_ColorSurf
            )
    return document


def _faces(shape: Any) -> list[Any]:
    """The faces of a shell, or of a solid that has one, in the order in which they were added."""
    explorer, found = TopExp_Explorer(shape, TopAbs_FACE), []
    while explorer.More():
        found.append(explorer.Current())
        explorer.Next()
    return found
