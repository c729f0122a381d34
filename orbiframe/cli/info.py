"""orbiframe info: which surface a mesh is, and what is wrong with it."""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from orbiframe.errors import FormatError, TopologyError
from orbiframe.registry import Registry

if TYPE_CHECKING:
    from orbiframe.polyhedron import Polyhedron


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("files", metavar="FILE", type=Path, nargs="+", help="meshes to look at")
    parser.add_argument("-i", "--input-format", metavar="FORMAT", help="name of a reader, instead of the suffix")
    parser.add_argument("--json", action="store_true", help="print one JSON object on one line for each file")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace, registry: Registry) -> int:
    """Look at every file; the status is 1 if one cannot be read."""
    from orbiframe import formats

    status = 0
    for path in args.files:
        try:
            described = description(formats.read(path, registry, format=args.input_format))
        except (FormatError, TopologyError) as error:
            print(f"orbiframe: {error}", file=sys.stderr)
            status = 1
            continue
        if args.json:
            print(json.dumps({"file": str(path), **{k: v for k, v in described.items() if k != "name"}}))
        else:
            print(text(described, str(path) if len(args.files) > 1 else None))
    return status


def description(polyhedron: Polyhedron) -> dict[str, Any]:
    """The numbers and defects of a polyhedron as plain data."""
    import numpy as np

    from orbiframe.topology import defects, surface_type

    surface = surface_type(polyhedron)
    sizes, counts = np.unique(polyhedron.face_sizes, return_counts=True)
    return {
        "name": surface.name,
        "vertices": len(polyhedron.vertices),
        "edges": polyhedron.edge_count,
        "faces": polyhedron.face_count,
        "face_sizes": {str(size): int(count) for size, count in zip(sizes, counts, strict=True)},
        "components": surface.components,
        "closed": surface.closed,
        "orientable": surface.orientable,
        "euler_characteristic": surface.euler_characteristic,
        "genus": surface.genus,
        "defects": [{"kind": d.kind, "count": d.count, "where": d.where} for d in defects(polyhedron)],
    }


def text(described: dict[str, Any], title: str | None = None) -> str:
    """The description in lines; the first names the surface (after the title, if there is one)."""
    sizes = ", ".join(f"{count} of {size} corners" for size, count in described["face_sizes"].items())
    first = described["name"] if title is None else f"{title}: {described['name']}"
    lines = [
        first,
        f"{described['vertices']} vertices, {described['edges']} edges, {described['faces']} faces ({sizes or 'none'})",
        f"Euler characteristic {described['euler_characteristic']}",
        *(f"defect: {d['count']} {d['kind']}: {d['where']}" for d in described["defects"]),
    ]
    return "\n".join(lines)
