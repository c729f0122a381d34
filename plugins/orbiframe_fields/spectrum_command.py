"""orbiframe spectrum: eigenvalues and eigenfunctions of the surface of a mesh, and what heat and waves tell of it."""

from __future__ import annotations

import argparse
import json
import math
import time
from typing import TYPE_CHECKING, Any

from orbiframe import Registry, UsageError
from orbiframe_fields.input_surfaces import add_surface_arguments, require_outputs

if TYPE_CHECKING:
    from orbiframe_fields.mesh_spectrum import MeshSpectrum

_COUNT = 10


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    add_surface_arguments(parser)
    add = parser.add_argument
    add("--count", metavar="N", type=int, default=_COUNT, help=f"how many eigenvalues, from 0 on; default {_COUNT}")
    add("--heat", metavar="T", type=float, action="append", default=[], help="also the heat kernel signature at time T")
    add("--wave", metavar="E", type=float, action="append", default=[], help="also the wave signature at log energy E")
    add("--width", metavar="W", type=float, help="of energies in --wave; default: 7 steps from one energy to the next")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace, registry: Registry) -> int:
    """Fit, solve and write."""
    require_outputs(args)
    _require_numbers(args)
    from orbiframe_fields.field_table import FieldTable, write_table
    from orbiframe_fields.input_surfaces import columns_of, input_surfaces, shown
    from orbiframe_fields.mesh_spectrum import mesh_spectrum
    from orbiframe_fields.number_pictures import write_pictures

    surfaces = input_surfaces(args, registry)
    args.progress("spectrum", None)
    start = time.perf_counter()
    found = mesh_spectrum(surfaces.surfaces, args.count)
    args.progress("spectrum", time.perf_counter() - start)
    if args.output or args.picture:
        there = shown(surfaces, args.refine)
        functions = found.functions(there)
        columns = {f"function_{k}": functions[:, k] for k in range(args.count)}
        columns |= found.signatures(there, args.heat, args.wave, args.width)
    if args.output:
        write_table(args.output, FieldTable(there.mesh, columns_of(there, columns)))
    if args.picture:
        write_pictures(args.picture, there.mesh, found.scales(functions))
    print(json.dumps(_summary(found)) if args.json else "\n".join(_lines(found)))
    return 0


def _require_numbers(args: argparse.Namespace) -> None:
    if args.count < 1:
        raise UsageError(f"--count {args.count}: ask for at least 1 eigenvalue")
    for value in args.heat:
        if not (value > 0 and math.isfinite(value)):
            raise UsageError(f"--heat {value:g}: give a positive time, in squares of the unit of length")
    if args.width is not None and not (args.width > 0 and args.wave):
        raise UsageError(f"--width {args.width:g}: give a positive number, beside --wave")
    if (args.heat or args.wave) and not args.output:
        raise UsageError("--heat and --wave are numbers at vertices; name their file with -o, such as -o out.vtu")


def _summary(found: MeshSpectrum) -> dict[str, Any]:
    """Area, functions, and the eigenvalues with their errors."""
    errors = [None if math.isnan(error) else float(error) for error in found.error]
    return {
        "area": found.area,
        "functions": found.size,
        "spectrum": [
            {"value": float(value), "error": error} for value, error in zip(found.values, errors, strict=True)
        ],
    }


def _lines(found: MeshSpectrum) -> list[str]:
    told = _summary(found)
    rows = [("area", f"{told['area']:.6g}"), ("functions", str(told["functions"]))]
    for k, each in enumerate(told["spectrum"]):
        rows.append(("spectrum" if k == 0 else "", _eigenvalue(each["value"], each["error"])))
    return [f"{name:<10}{text}" for name, text in rows]


def _eigenvalue(value: float, error: float | None) -> str:
    """The value to the digits that are sure, and its error."""
    if error is None:
        return f"{value:.6g}, error unknown"
    decimals = min(max(math.ceil(-math.log10(max(error, 1e-15))), 0), 15)
    return f"{value:.{decimals}f}, error {error:.1e}"
