"""STEP and IGES files with exact patches, or a few faces in their colours, through Open CASCADE."""

from __future__ import annotations

import re
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from io import BytesIO
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from OCP.APIHeaderSection import APIHeaderSection_MakeHeader
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.IFSelect import IFSelect_RetDone
from OCP.IGESCAFControl import IGESCAFControl_Writer
from OCP.IGESControl import IGESControl_Controller, IGESControl_Reader
from OCP.IGESData import IGESData_GlobalSection, IGESData_IGESWriter
from OCP.IGESSelect import IGESSelect_WorkLibrary
from OCP.Interface import Interface_Static
from OCP.Message import Message
from OCP.StepBasic import StepBasic_Product
from OCP.STEPCAFControl import STEPCAFControl_Writer
from OCP.STEPControl import STEPControl_AsIs, STEPControl_Reader
from OCP.TCollection import TCollection_HAsciiString

from orbiframe import FitError, Notice, OrbifoldSurface, __version__
from orbiframe.surfaces import PeriodicPatch, patches_of
from orbiframe_exact.coloured_document import document_of
from orbiframe_exact.creased_faces import CreasedFaces
from orbiframe_exact.creased_shapes import creased_shape
from orbiframe_exact.face_colours import face_colours
from orbiframe_exact.faces_of_surface import Quads, described, fitted, fitted_between_creases
from orbiframe_exact.shapes import shape_of
from orbiframe_exact.spline_shapes import spline_shape
from orbiframe_exact.step_text import shorter

# Files have no time of day and no path, so that one surface always gives the same bytes.
_TIME = "1970-01-01T00:00:00"
_NAME = "surface"
_LONGEST = 60
# What Open CASCADE calls a unit of length, and its millimetres; those of units of meshes.
_UNITS = {"mm": ("MM", 1.0), "cm": ("CM", 10.0), "m": ("M", 1000.0), "in": ("INCH", 25.4)}
_MILLIMETRES = {"millimetre": 1.0, "metre": 1000.0}
_SYSTEM = f"orbiframe {__version__}"

_AS_TOPOLOGY = 1  # IGES: shells and solids that share their edges, not a heap of trimmed surfaces


def write_step(
    path: Path,
    surface: OrbifoldSurface,
    *,
    exact: bool = True,
    faces: int = 0,
    tolerance: float = 1e-4,
    unit: str = "mm",
    name: str = _NAME,
    quads: Quads = (),
) -> dict[str, Any]:
    """The surface in a STEP file (AP214): a solid where it has an inside, else a shell.

    exact: as rational patches, three for each micro triangle; a tensor product is one periodic surface. Otherwise a few
    polynomial B-spline faces near the surface, in the colours of the input: faces, about so many, 0 for as many as its
    topology suggests; tolerance, their largest distance from the surface as a share of the diagonal of its box. Returns
    what they are in numbers, with `valid`, what Open CASCADE finds when it reads the file.
    unit: mm, cm, m or in; a surface in another one is converted, with a notice, and one of no unit has its numbers in
    this one. name: of the product; letters, digits and ._- are kept. quads: the faces of the input, if all have four
    corners; blocks of them become faces where that serves. Raises FitError for a surface without exact
    patches, or derivatives, for another unit, or where Open CASCADE fails.
    """
    made = _made(_in_unit(path, surface, unit), exact, faces, tolerance, quads)
    _silence()
    writer = STEPCAFControl_Writer()
    writer.SetColorMode(True)
    Interface_Static.SetCVal_s("write.step.unit", _UNITS[unit][0])
    # Readers find lines in the parameter squares of patches again, and without them files are smaller, exact ones by a
    # third. Not so on a periodic surface, where two of them are one curve in space, nor on a face that meets a vertex
    # twice.
    Interface_Static.SetIVal_s("write.surfacecurve.mode", int(made.seamed))
    with _lengths_in(unit):
        _require(bool(writer.Transfer(document_of(made.shape, made.colours), STEPControl_AsIs)), "convert to STEP")
    _sign_step(writer.ChangeWriter(), _plain(name))
    _require(writer.Write(str(path)) == IFSelect_RetDone, "write the STEP file")
    if not exact:
        Path(path).write_text(shorter(Path(path).read_text(encoding="ascii")), encoding="ascii")
        made.numbers["valid"] = _sound(STEPControl_Reader(), path)
    return made.numbers


def write_iges(
    path: Path,
    surface: OrbifoldSurface,
    *,
    exact: bool = True,
    faces: int = 0,
    tolerance: float = 1e-4,
    unit: str = "mm",
    name: str = _NAME,
    quads: Quads = (),
) -> dict[str, Any]:
    """The surface in an IGES file (5.3).

    The options exact, faces, tolerance, unit, name and quads are those of `write_step`.
    """
    placed = _in_unit(path, surface, unit)
    # The writer takes shapes for millimetres and converts them.
    made = _made(_scaled(placed, _UNITS[unit][1]), exact, faces, tolerance, quads)
    _silence()
    IGESControl_Controller.Init_s()
    Interface_Static.SetIVal_s("write.iges.brep.mode", _AS_TOPOLOGY)
    Interface_Static.SetCVal_s("write.iges.unit", _UNITS[unit][0])
    writer = IGESCAFControl_Writer()
    writer.SetColorMode(True)
    _require(bool(writer.Transfer(document_of(made.shape, made.colours))), "convert the shape to IGES")
    writer.ComputeModel()
    _sign_iges(writer, _plain(name))
    Path(path).write_bytes(_iges_text(writer.Model()))
    if not exact:
        made.numbers["valid"] = _sound(IGESControl_Reader(), path)
    return made.numbers


class _Made(NamedTuple):
    """A shape to write: the colours of its faces (F, 3); what it is in numbers; seamed: whether a face meets itself,
    at a seam or a vertex.
    """

    shape: Any
    colours: NDArray[np.float64] | None
    numbers: dict[str, Any]
    seamed: bool


def _made(surface: OrbifoldSurface, exact: bool, faces: int, tolerance: float, quads: Quads) -> _Made:
    if exact:
        patches = patches_of(surface)
        return _Made(shape_of(patches), None, {}, isinstance(patches, PeriodicPatch))
    creased = surface.triangulation.crease is not None
    few = fitted_between_creases(surface, tolerance) if creased else fitted(surface, faces or None, tolerance, quads)
    numbers, found = described(few, surface, tolerance), face_colours(surface, few.domain)
    if found is not None:
        numbers["divided"] = found.divided
    seamed = bool(few.domain.meets_itself.any())
    shape = creased_shape(few, surface) if isinstance(few, CreasedFaces) else spline_shape(few, surface)
    return _Made(shape, None if found is None else found.rgb[few.domain.group_of_faces], numbers, seamed)


def _sound(reader: Any, path: Path) -> bool:
    """Whether Open CASCADE finds valid what it reads of a file."""
    reader.ReadFile(str(path))
    reader.TransferRoots()
    return bool(BRepCheck_Analyzer(reader.OneShape()).IsValid())


def _in_unit(path: Path, surface: OrbifoldSurface, unit: str) -> OrbifoldSurface:
    """The surface with its lengths in a unit; as it is where it has none."""
    if unit not in _UNITS:
        raise FitError(f"lengths are written in {', '.join(_UNITS)}, not in '{unit}'; name one of these")
    factor = _MILLIMETRES.get(surface.unit or "", _UNITS[unit][1]) / _UNITS[unit][1]
    if factor == 1:
        return surface
    told = f"coordinates are converted from {surface.unit}s to {unit} (times {factor:.10g})"
    warnings.warn(f"{path.name}: {told}", Notice, stacklevel=3)
    return _scaled(surface, factor)


def _scaled(surface: OrbifoldSurface, factor: float) -> OrbifoldSurface:
    return replace(surface, origin=factor * surface.origin, scale=factor * surface.scale)


@contextmanager
def _lengths_in(unit: str) -> Iterator[None]:
    """What Open CASCADE takes the lengths of shapes for; millimetres again afterwards, for all of the process."""
    Interface_Static.SetCVal_s("xstep.cascade.unit", _UNITS[unit][0])
    try:
        yield
    finally:
        Interface_Static.SetCVal_s("xstep.cascade.unit", "MM")


def _plain(name: str) -> str:
    """A name that every reader takes: as much of it as is letters, digits and ._-"""
    return re.sub(r"[^A-Za-z0-9._-]+", "_", name)[:_LONGEST] or _NAME


def _iges_text(model: Any) -> bytes:
    """The lines of an IGES file, with as many digits as STEP has; by itself Open CASCADE writes 10."""
    writer, lines = IGESData_IGESWriter(model), BytesIO()
    writer.FloatWriter().SetFormat("%.12E")
    writer.FloatWriter().SetZeroSuppress(True)
    writer.SendModel(IGESSelect_WorkLibrary.DefineProtocol_s())
    _require(bool(writer.Print(lines)), "write the IGES file")
    return lines.getvalue()


def _sign_step(writer: Any, name: str) -> None:
    model = writer.Model()
    entities = (model.Value(number) for number in range(1, model.NbEntities() + 1))
    product = next(entity for entity in entities if isinstance(entity, StepBasic_Product))
    # By itself Open CASCADE counts the products of the process.
    product.SetId(_text(name))
    product.SetName(_text(name))
    header = APIHeaderSection_MakeHeader(model)
    header.SetName(_text(name))
    header.SetTimeStamp(_text(_TIME))
    header.SetAuthorValue(1, _text(""))
    header.SetOrganizationValue(1, _text(""))
    header.SetOriginatingSystem(_text(_SYSTEM))
    header.SetAuthorisation(_text(""))


def _sign_iges(writer: Any, name: str) -> None:
    model = writer.Model()
    section: IGESData_GlobalSection = model.GlobalSection()
    date = _TIME.replace("-", "").replace("T", ".").replace(":", "")
    signatures: tuple[tuple[Callable[[Any], None], str], ...] = (
        (section.SetSendName, name),
        (section.SetReceiveName, name),
        (section.SetFileName, name),
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
