"""orbiframe distance: how long the shortest ways along the surface of a mesh are."""

from __future__ import annotations

import argparse
import json
import time
from typing import TYPE_CHECKING, Any

from orbiframe import Registry, UsageError
from orbiframe_fields.input_surfaces import add_surface_arguments, require_outputs

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from orbiframe_fields.input_surfaces import InputSurfaces, Shown

    Floats = NDArray[np.float64]

_METHODS = ("front", "heat")


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    add_surface_arguments(parser)
    add = parser.add_argument
    source = "from where: the number of a vertex of MESH, from 0, or a place as X,Y,Z; any number of times"
    add("--from", dest="sources", metavar="PLACE", action="append", required=True, help=source)
    add("--method", choices=_METHODS, default="front", help="a wave front (the default), or the flow of heat")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace, registry: Registry) -> int:
    """Fit, measure and write."""
    require_outputs(args)
    if not (args.output or args.picture):
        raise UsageError("say where the distances go: -o out.vtu, or --picture out.png")
    sources = [_parsed(text) for text in args.sources]
    from orbiframe_fields.field_table import FieldTable, write_table
    from orbiframe_fields.input_surfaces import columns_of, input_surfaces, shown
    from orbiframe_fields.number_pictures import write_levels

    surfaces = input_surfaces(args, registry)
    places = _places(sources, surfaces.mesh.vertices)
    args.progress("distance", None)
    start = time.perf_counter()
    there = shown(surfaces, args.refine)
    values = _distances(surfaces, there, places, args.method)
    args.progress("distance", time.perf_counter() - start)
    if args.output:
        write_table(args.output, FieldTable(there.mesh, columns_of(there, {"geodesic": values})))
    if args.picture:
        write_levels(args.picture, there.mesh, values)
    told = _summary(places, there.mesh.vertices, values)
    print(json.dumps(told) if args.json else "\n".join(_lines(told)))
    return 0


def _parsed(text: str) -> int | list[float]:
    """A vertex or a place. Raises UsageError for anything else."""
    try:
        return int(text)
    except ValueError:
        pass
    try:
        place = [float(part) for part in text.split(",")]
    except ValueError:
        place = []
    if len(place) != 3 or not all(abs(x) < float("inf") for x in place):
        raise UsageError(f"--from {text}: give the number of a vertex, such as 17, or a place, such as 0.5,0,1")
    return place


def _places(sources: list[int | list[float]], vertices: Floats) -> Floats:
    import numpy as np

    for source in sources:
        if isinstance(source, int) and not 0 <= source < len(vertices):
            raise UsageError(f"--from {source}: the mesh has the vertices 0 to {len(vertices) - 1}")
    return np.array([vertices[s] if isinstance(s, int) else s for s in sources], dtype=np.float64)


def _distances(found: InputSurfaces, there: Shown, places: Floats, method: str) -> Floats:
    """At each vertex the distance from the nearest place; inf on surfaces that no place is on."""
    import numpy as np

    from orbiframe.surfaces import geodesic_distance

    values = np.full(len(there.mesh.vertices), np.nan)
    owner = np.argmin([surface.distance(places) for surface in found.surfaces], axis=0)
    for part, surface in enumerate(found.surfaces):
        values[there.vertices[part]] = np.inf
        if (owner == part).any():
            ways = geodesic_distance(surface, places[owner == part], method=method)
            values[there.vertices[part]] = ways.at(surface.evaluate(there.points[part]))
    return values


def _summary(places: Floats, vertices: Floats, values: Floats) -> dict[str, Any]:
    import numpy as np

    reached = np.where(np.isfinite(values), values, -1.0)
    far = int(np.argmax(reached))
    return {
        "sources": places.tolist(),
        "farthest": float(reached[far]),
        "farthest_at": vertices[far].tolist(),
        "vertices": len(values),
        "not_reached": int((~np.isfinite(values)).sum()),
    }


def _lines(told: dict[str, Any]) -> list[str]:
    at = ", ".join(f"{x:.4g}" for x in told["farthest_at"])
    rows = [
        ("sources", str(len(told["sources"]))),
        ("vertices", f"{told['vertices']}, of which {told['not_reached']} cannot be reached"),
        ("farthest", f"{told['farthest']:.6g} at ({at})"),
    ]
    return [f"{name:<10}{text}" for name, text in rows]
