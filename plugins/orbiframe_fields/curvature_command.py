"""orbiframe curvature: principal curvatures and directions at the vertices of a mesh."""

from __future__ import annotations

import argparse
import json
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

from orbiframe import Registry
from orbiframe.files import require_apart
from orbiframe.fitting import add_boundary

if TYPE_CHECKING:
    from orbiframe_fields.vertex_curvature import VertexCurvature


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    add = parser.add_argument
    add("mesh", metavar="MESH", type=Path, help="surfaces, one or several, orientable or not, of any genus")
    add("-o", "--output", metavar="OUT", type=Path, required=True, help="the numbers at the vertices: .ply, .vtu, .csv")
    add("--config", metavar="FILE.toml", type=Path, help="components and options of the fit")
    add("--set", metavar="TABLE.KEY=VALUE", action="append", default=[], help="one option, such as basis.size=2000")
    add_boundary(parser)
    add("--json", action="store_true", help="print one JSON object instead of the summary")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace, registry: Registry) -> int:
    """Fit, measure and write."""
    from orbiframe_fields.field_table import require_field_file

    require_apart({"-o": args.output}, {"the input": args.mesh, "--config": args.config})
    require_field_file(args.output)
    from orbiframe import read
    from orbiframe_fields.field_table import FieldTable, write_table
    from orbiframe_fields.fitted_surfaces import fitted_surfaces
    from orbiframe_fields.vertex_curvature import curvature_of

    mesh = read(args.mesh, registry)
    fitted = fitted_surfaces(mesh, args.config, [*args.set, *_boundary(args)], registry, args.progress)
    args.progress("curvature", None)
    start = time.perf_counter()
    found = curvature_of(mesh, fitted, registry)
    args.progress("curvature", time.perf_counter() - start)
    write_table(args.output, FieldTable(found.mesh, found.columns))
    print(json.dumps(_summary(found)) if args.json else "\n".join(_lines(found)))
    return 0


def _boundary(args: argparse.Namespace) -> list[str]:
    return [] if args.boundary is None else [f"mesh.boundary={args.boundary}"]


def _summary(found: VertexCurvature) -> dict[str, Any]:
    """Ranges of the numbers, how near the surface is, and the total curvature beside that of its topology."""
    import numpy as np

    ranges = {
        name: [float(np.nanmin(found.columns[name])), float(np.nanmax(found.columns[name]))]
        for name in ("k1", "k2", "gaussian", "mean")
    }
    return {
        "vertices": len(found.mesh.vertices),
        "distance": float(np.nanmax(found.columns["distance"])),
        **ranges,
        "total": found.total,
        "total_by_topology": found.expected,
    }


def _lines(found: VertexCurvature) -> list[str]:
    """The same in words."""
    told = _summary(found)
    rows = [
        ("vertices", f"{told['vertices']}, {told['distance']:.1e} from the smooth surface at most"),
        *((name, "from {:.6g} to {:.6g}".format(*told[name])) for name in ("k1", "k2", "gaussian", "mean")),
        ("total", f"{told['total']:.6g}, by Gauss and Bonnet {told['total_by_topology']:.6g}"),
    ]
    return [f"{name:<10}{text}" for name, text in rows]
