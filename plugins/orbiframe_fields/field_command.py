"""orbiframe field: values at points of a mesh become smooth functions on its surface."""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from orbiframe import Registry, UsageError
from orbiframe.files import require_apart
from orbiframe.fitting import add_boundary

if TYPE_CHECKING:
    from orbiframe_fields.mesh_field import MeshField


# Outliers that are named in the summary; all are in the JSON.
_NAMED = 12


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    add = parser.add_argument
    add("mesh", metavar="MESH", type=Path, help="surfaces, or a surface that `fit --save` wrote (.npz)")
    add("data", metavar="DATA", type=Path, help="the values: a .csv file, or a mesh with attributes such as .ply, .vtu")
    add("-o", "--output", metavar="OUT", type=Path, required=True, help="the field: .ply, .vtu or .csv")
    add("--value", metavar="NAME", action="append", default=[], help="fit the values of this name, else all")
    add("--fairing", metavar="F", type=float, help="how much is smoothed; as cross-validation says if not given")
    add("--error-bars", action="store_true", help="write a standard error NAME_error beside every value")
    shown = parser.add_mutually_exclusive_group().add_argument
    shown("--robust", choices=("huber", "tukey"), help="outliers count little (huber) or not at all (tukey)")
    shown("--interpolate", action="store_true", help="meet all data exactly, with the least energy")
    add(
        "--refine", metavar="K", type=int, help="each triangle in K*K; 0: at the vertices of MESH; default: a fine mesh"
    )
    add("--config", metavar="FILE.toml", type=Path, help="components and options of the fit of the surface")
    add("--set", metavar="TABLE.KEY=VALUE", action="append", default=[], help="one option, such as basis.size=2000")
    add_boundary(parser)
    add("--json", action="store_true", help="print one JSON object instead of the summary")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace, registry: Registry) -> int:
    """Fit the surface and the field, write it, and say how far it can be trusted."""
    from orbiframe_fields.field_table import require_field_file, write_table

    inputs = {"the mesh": args.mesh, "the data": args.data, "--config": args.config}
    require_apart({"-o": args.output}, inputs)
    require_field_file(args.output)
    if args.refine is not None and args.refine < 0:
        raise UsageError(f"--refine {args.refine}: give 0 for the vertices of the mesh, or 1 and more")
    from orbiframe_fields.mesh_field import mesh_field

    found = mesh_field(args, registry)
    write_table(args.output, found.table(args.refine, error_bars=args.error_bars))
    told = _summary(found)
    print(json.dumps(told) if args.json else "\n".join(_lines(told)))
    return 0


def _summary(found: MeshField) -> dict[str, Any]:
    """How many data, how far from the surface, and of each column its range and its error by cross-validation."""
    return {
        "points": found.count,
        "distance": found.distance,
        "functions": sum(field.basis.size for field in found.fields),
        "fairing": [field.fairing for field in found.fields],
        "freedom": [field.freedom for field in found.fields],
        "values": [
            {"name": name, "from": low, "to": high, "error": error, "noise": noise}
            for name, low, high, error, noise in found.described()
        ],
        "outliers": found.outliers,
    }


def _lines(told: dict[str, Any]) -> list[str]:
    rows = [
        ("data", f"{told['points']} points, {told['distance']:.1e} from the surface at most"),
        ("functions", f"{told['functions']}, of which the data take {sum(told['freedom']):.1f}"),
        ("fairing", ", ".join(f"{fairing:.1e}" for fairing in told["fairing"])),
    ]
    rows += [
        (each["name"], f"from {each['from']:.6g} to {each['to']:.6g}, error {each['error']:.1e} at a point left out")
        for each in told["values"]
    ]
    if told["outliers"] is not None:
        named = ", ".join(map(str, told["outliers"][:_NAMED])) + (", …" if len(told["outliers"]) > _NAMED else "")
        noise = ", ".join(f"{each['noise']:.1e}" for each in told["values"])
        rows.append(("outliers", f"{len(told['outliers'])}, data {named}" if named else "none"))
        rows.append(("scale", f"{noise}, the standard deviation of the data without them"))
    width = max(len(name) for name, _ in rows) + 2
    return [f"{name:<{width}}{text}" for name, text in rows]
