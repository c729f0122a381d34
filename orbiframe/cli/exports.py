"""Exports: a surface itself, or a few faces near it, as files for CAD and analysis."""

from __future__ import annotations

import argparse
import time
import warnings
from collections.abc import Collection, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from orbiframe.components.registry import Registry
from orbiframe.errors import UsageError

if TYPE_CHECKING:
    from orbiframe.fitting.config import Config
    from orbiframe.fitting.pipeline import Result
    from orbiframe.fitting.stages import Progress

# Faces of a file for CAD, at most, and the least tolerance.
_MOST_FACES, _LEAST_TOLERANCE = 5000, 1e-7


def export_options(args: argparse.Namespace, config: Config, registry: Registry) -> dict[str, object] | None:
    """The options of the exporter that writes the surface itself, or faces near it; None where a mesh is written."""
    known = _exporter_options(args.output, registry)
    require_known(args, known)
    if known is None:
        return None
    options: dict[str, object] = {"unit": args.unit or "mm", "name": args.mesh.stem}
    if "faces" in known and not args.exact:
        if config.data.creases is not None and "exact" not in known:
            raise UsageError(f"{args.output}: patches round creases off; write part.step, or leave --creases out")
        if config.data.creases is not None and args.faces is not None:
            raise UsageError("creases decide how many faces there are; leave --faces out")
        options |= {"exact": False, "conforming": args.conforming, **_faces(args)}
    elif not _piecewise(config, registry):
        return None
    return {name: value for name, value in options.items() if name in known}


def require_known(args: argparse.Namespace, known: Collection[str] | None) -> None:
    """Raise UsageError for what the exporter of the output's suffix, with options of these names, does not do."""
    found = known or ()
    asked = args.faces is not None or args.export_tolerance is not None
    for wrong, sentence in (
        (
            asked and (args.exact or "faces" not in found),
            "--faces and --export-tolerance are for CAD, as part.step, without --exact",
        ),
        (
            args.exact and (known is None or ("faces" in found and "exact" not in found)),
            "--exact is for files that hold exact surfaces, such as part.step",
        ),
        (args.conforming and "conforming" not in found, "--conforming is for patches of G+Smo, as patches.xml"),
        (args.unit is not None and "unit" not in found, "--unit is for CAD, as part.step"),
    ):
        if wrong:
            raise UsageError(f"{args.output}: {sentence}")


def _faces(args: argparse.Namespace) -> dict[str, object]:
    """How many faces are asked for, and how near."""
    if args.faces is not None and not 1 <= args.faces <= _MOST_FACES:
        raise UsageError(f"--faces {args.faces}: give 1 to {_MOST_FACES}")
    tolerance = 1e-4 if args.export_tolerance is None else args.export_tolerance
    if not _LEAST_TOLERANCE <= tolerance < 1:
        raise UsageError(f"--export-tolerance {tolerance:g}: give {_LEAST_TOLERANCE:g} to 1, of the box's diagonal")
    return {"faces": args.faces or 0, "tolerance": tolerance}


def _exporter_options(path: Path, registry: Registry) -> set[str] | None:
    """The names of the options of the exporter of a suffix; None if there is none."""
    from orbiframe.components.options import options_of
    from orbiframe.files.gate import component_name, exports

    if not exports(path, registry):
        return None
    exporter = registry.load("exporter", component_name(path, registry, "exporter", None))
    return {option.name for option in options_of(exporter)}


def _piecewise(config: Config, registry: Registry) -> bool:
    """Whether the functions have exact patches."""
    from orbiframe.functions.basis import PiecewiseBasis

    basis = registry.load("basis", config.basis.name)
    return isinstance(basis, type) and issubclass(basis, PiecewiseBasis)


def export(path: Path, result: Result, options: dict[str, object], registry: Registry, progress: Progress) -> str:
    """Write the surface itself, or a few faces near it, and say what was written; it takes seconds."""
    from orbiframe.files import gate

    progress("export", None)
    start = time.perf_counter()
    found = gate.export(path, result.surface, registry, options=options | _quads(path, result, options, registry))
    result.report["seconds"]["export"] = round(time.perf_counter() - start, 4)
    progress("export", result.report["seconds"]["export"])
    if "faces" not in options:
        return f"exact rational patches, {size_of(path)}"
    result.report["export"] = found
    for note in _shortcomings(found):
        result.report["notes"].append(note)
        warnings.warn(note, stacklevel=2)
    planes = f"{found['planes']} planes and " if "planes" in found else ""
    return (
        f"{planes}{found['faces'] - found.get('planes', 0)} B-spline faces, at most {found['error']:.1e} of the diagonal from the surface, tangent "
        f"planes within {found['angle']:.2f}°, {size_of(path)}"
    )


def _quads(path: Path, result: Result, options: dict[str, object], registry: Registry) -> dict[str, object]:
    """The faces of the input for an exporter that makes blocks of them, if all have four corners."""
    asked = "faces" in options and "quads" in (_exporter_options(path, registry) or ())
    if not asked or (result.input.face_sizes != 4).any():
        return {}
    return {"quads": result.input.tail.reshape(-1, 4).tolist()}


def _shortcomings(found: dict[str, Any]) -> Iterator[str]:
    """What a user should know of faces that are not as near, as smooth or as sound as they should be."""
    place = ", ".join(f"{x:.6g}" for x in found["worst"])
    if not found["reached"]:
        yield (
            f"the faces of the file are {found['error']:.1e} of the diagonal from the surface, and neighbours meet at "
            f"{found['angle']:.2f}° near ({place}), where the surface may be pinched; try more --faces"
        )
    if not found.get("valid", True):
        yield (
            "Open CASCADE does not find the shape of the file valid, as where a surface is pinched or passes through "
            "itself on an edge; try another number of --faces"
        )
    if found.get("divided"):
        yield (
            f"colours of the mesh divide {found['divided']} of the {found['faces']} faces of the file; each has that "
            "of most of its area, and with more --faces less is divided"
        )


def size_of(path: Path) -> str:
    """The size of a file in words."""
    return f"{path.stat().st_size / 1e6:.2g} MB"
