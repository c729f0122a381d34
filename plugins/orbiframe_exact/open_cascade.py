"""STEP and IGES files with exact patches, through Open CASCADE."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from OCP.APIHeaderSection import APIHeaderSection_MakeHeader
from OCP.IFSelect import IFSelect_RetDone
from OCP.IGESControl import IGESControl_Writer
from OCP.IGESData import IGESData_GlobalSection
from OCP.Interface import Interface_Static
from OCP.Message import Message
from OCP.STEPControl import STEPControl_AsIs, STEPControl_Writer
from OCP.TCollection import TCollection_HAsciiString
from OCP.TopAbs import TopAbs_SOLID

from orbiframe import FitError, OrbifoldSurface, __version__, patches_of
from orbiframe_exact.shapes import shape_of

# Files have no time of day and no path, so that one surface always gives the same bytes.
_TIME = "1970-01-01T00:00:00"
_NAME = "surface"
_SYSTEM = f"orbiframe {__version__}"


def write_step(path: Path, surface: OrbifoldSurface) -> None:
    """The surface as exact rational patches in a STEP file (AP214, millimetres), three for each micro triangle.

    A solid where it has an inside, else a shell; a tensor product is one periodic surface. Raises FitError for a
    surface without exact patches, or where Open CASCADE fails.
    """
    shape = shape_of(patches_of(surface))
    _silence()
    writer = STEPControl_Writer()
    for key, value in (("write.step.unit", "MM"), ("write.step.product.name", _NAME)):
        Interface_Static.SetCVal_s(key, value)
    # Curves in the parameter planes are lines that every reader finds again; they would double the file.
    Interface_Static.SetIVal_s("write.surfacecurve.mode", 0)
    _require(writer.Transfer(shape, STEPControl_AsIs) == IFSelect_RetDone, "convert the shape to STEP")
    _sign_step(writer)
    _require(writer.Write(str(path)) == IFSelect_RetDone, "write the STEP file")


def write_iges(path: Path, surface: OrbifoldSurface) -> None:
    """The surface as exact rational patches in an IGES file (5.3, millimetres); see `write_step`."""
    shape = shape_of(patches_of(surface))
    _silence()
    writer = IGESControl_Writer("MM", int(shape.ShapeType() == TopAbs_SOLID))
    _require(bool(writer.AddShape(shape)), "convert the shape to IGES")
    writer.ComputeModel()
    _sign_iges(writer)
    _require(bool(writer.Write(str(path))), "write the IGES file")


def _sign_step(writer: Any) -> None:
    header = APIHeaderSection_MakeHeader(writer.Model())
    header.SetName(_text(_NAME))
    header.SetTimeStamp(_text(_TIME))
    header.SetAuthorValue(1, _text(""))
    header.SetOrganizationValue(1, _text(""))
    header.SetOriginatingSystem(_text(_SYSTEM))
    header.SetAuthorisation(_text(""))


def _sign_iges(writer: Any) -> None:
    model = writer.Model()
    section: IGESData_GlobalSection = model.GlobalSection()
    date = _TIME.replace("-", "").replace("T", ".").replace(":", "")
    signatures: tuple[tuple[Callable[[Any], None], str], ...] = (
        (section.SetSendName, _NAME),
        (section.SetReceiveName, _NAME),
        (section.SetFileName, _NAME),
        (section.SetSystemId, _SYSTEM),
        (section.SetAuthorName, ""),
        (section.SetCompanyName, ""),
        (section.SetDate, date),
        (section.SetLastChangeDate, date),
    )
    for set_value, value in signatures:
        set_value(_text(value))
    model.SetGlobalSection(section)


def _text(value: str) -> Any:
    return TCollection_HAsciiString(value)


def _silence() -> None:
    """Open CASCADE reports its progress on the standard output; the command line has its own."""
    messenger = Message.DefaultMessenger_s()
    for printer in list(messenger.Printers()):
        messenger.RemovePrinter(printer)


def _require(done: bool, what: str) -> None:
    if not done:
        raise FitError(f"Open CASCADE could not {what}; try fewer functions, or write a mesh instead")
