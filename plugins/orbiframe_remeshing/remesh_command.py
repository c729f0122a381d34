"""orbiframe remesh: even triangles or quadrilaterals on the smooth surface of a mesh."""

from __future__ import annotations

import argparse
import json
import time
import warnings
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from orbiframe import Registry, UsageError
from orbiframe.files import require_apart, require_destination
from orbiframe.fitting import add_boundary

if TYPE_CHECKING:
    from orbiframe import OrbifoldSurface, Polyhedron
    from orbiframe_remeshing.remeshing import Wanted
    from orbiframe_remeshing.surface_mesh import SurfaceMesh

_SURFACE = ".npz"
_LARGEST_ORDER = 6


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    add = parser.add_argument
    add("mesh", metavar="MESH", type=Path, help="surfaces, or one surface that `fit --save` wrote (.npz)")
    add("-o", "--output", metavar="OUT", type=Path, required=True, help="the mesh to write")
    size = parser.add_mutually_exclusive_group(required=True).add_argument
    size("--edge-length", metavar="H", type=float, help="the mean length of edges, in units of the mesh")
    size("--vertices", metavar="N", type=int, help="the number of vertices")
    add("--quads", action="store_true", help="quadrilaterals, three of every triangle")
    add("--order", metavar="Q", type=int, help="write curved triangles of order 1 to 6, for finite elements")
    add("--format", metavar="NAME", help="with --order: the format, such as gmsh-2.2, instead of that of the suffix")
    add("--size", metavar="N", type=int, help="number of functions of the surface (basis.size)")
    add("--creases", metavar="ANGLE", help="edges that bend by ANGLE degrees or more stay, or 'marked' (data.creases)")
    add_boundary(parser)
    add("--config", metavar="FILE.toml", type=Path, help="components and options of the fit")
    add("--set", metavar="TABLE.KEY=VALUE", action="append", default=[], help="one option, such as basis.name=ps6")
    add("--seed", metavar="S", type=int, default=0, help="another mesh of the same kind; default 0")
    add("--json", action="store_true", help="print one JSON object")
    add("--quiet", action="store_true", help="print nothing but errors and warnings")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace, registry: Registry) -> int:
    """Make the surface, mesh it, write the mesh and say how good it is."""
    from orbiframe import Polyhedron
    from orbiframe.files import write
    from orbiframe_remeshing.quality import quality
    from orbiframe_remeshing.remeshing import Wanted

    wanted = Wanted(args.edge_length, args.vertices, args.quads)
    if args.seed < 0:
        raise UsageError(f"--seed {args.seed}: give 0 or more")
    require_apart({"-o": args.output}, {"the input": args.mesh, "--config": args.config})
    _require_order(args)
    require_destination(args.output, registry, args.format, kind="writer" if args.order is None else "elements")
    surfaces = _surfaces(args, registry)
    args.progress("remesh", None)
    start = time.perf_counter()
    made = _made(surfaces, wanted, args.seed)
    seconds = time.perf_counter() - start
    args.progress("remesh", seconds)
    mesh = _whole([part if isinstance(part, Polyhedron) else part.polyhedron() for part in made])
    found = quality(mesh) | {"seconds": round(seconds, 4)}
    if args.order is None:
        write(args.output, mesh, registry)
    else:
        found |= _write_elements(args, made, registry)
    _warn(found)
    if not args.quiet:
        print(json.dumps(found, indent=2) if args.json else "\n".join(f"{a:<10}{b}" for a, b in _lines(found)))
    return 0


def _surfaces(args: argparse.Namespace, registry: Registry) -> list[OrbifoldSurface]:
    """The saved surface, or those that are fitted to the components of the mesh."""
    from orbiframe import Config, load_surface, read
    from orbiframe.fitting import fit_parts

    if args.mesh.suffix.lower() == _SURFACE:
        if args.config or args.set or any(given is not None for given in (args.size, args.creases, args.boundary)):
            raise UsageError(
                f"{args.mesh} is a finished surface; --config, --set, --size, --creases and --boundary belong to meshes"
            )
        return [load_surface(args.mesh, registry)]
    size = [] if args.size is None else [f"basis.size={args.size}"]
    sharp = [] if args.creases is None else [f"data.creases={args.creases}"]
    ends = [] if args.boundary is None else [f"mesh.boundary={args.boundary}"]
    config = Config.load(args.config, [*args.set, *size, *sharp, *ends], registry)
    mesh = read(args.mesh, registry, format=None if config.mesh.open else config.mesh.name)
    found = fit_parts(mesh, config, registry, args.progress)
    return [result.surface for result in found.results]


def _require_order(args: argparse.Namespace) -> None:
    """Raise UsageError for an order that is not made, or options that do not go with it."""
    if args.order is None:
        if args.format is not None:
            raise UsageError(f"--format {args.format} chooses how elements are written; add --order, such as --order 2")
    elif not 1 <= args.order <= _LARGEST_ORDER:
        raise UsageError(f"--order {args.order}: elements have an order of 1 to {_LARGEST_ORDER}")
    elif args.quads:
        raise UsageError("--quads has no elements of an order; leave out --order or --quads")


def _made(surfaces: list[OrbifoldSurface], wanted: Wanted, seed: int) -> list[Any]:
    """A mesh on each surface, with its share of the vertices by area: triangles on it, or a mesh of quadrilaterals."""
    from orbiframe_remeshing.remeshing import areas_of, even_triangles, remeshed, rim_length

    areas = areas_of(surfaces)
    total = wanted.total(sum(areas), sum(map(rim_length, surfaces)))
    shares = [total * area / sum(areas) for area in areas]
    if wanted.quads:
        return [remeshed(surface, n, quads=True, seed=seed) for surface, n in zip(surfaces, shares, strict=True)]
    return [even_triangles(surface, n, seed) for surface, n in zip(surfaces, shares, strict=True)]


def _whole(meshes: list[Polyhedron]) -> Polyhedron:
    from orbiframe.meshes import disjoint_union

    return meshes[0] if len(meshes) == 1 else replace(disjoint_union(meshes), unit=meshes[0].unit)


def _write_elements(args: argparse.Namespace, made: list[SurfaceMesh], registry: Registry) -> dict[str, Any]:
    """Write curved triangles on all surfaces; returns their order and the number of nodes."""
    from orbiframe.files import write_elements
    from orbiframe.surfaces import joined_meshes
    from orbiframe_remeshing.curved import curved

    mesh = joined_meshes([curved(part, args.order) for part in made])
    write_elements(args.output, mesh, registry, format=args.format)
    return {"order": mesh.order, "nodes": len(mesh.nodes)}


def _warn(found: dict[str, Any]) -> None:
    angles = found["angles"]
    if angles["small"]:
        place = ", ".join(f"{x:.6g}" for x in angles["worst"])
        warnings.warn(
            f"{angles['small']} of {found['faces']} faces have an angle below 25 degrees, the worst "
            f"{angles['least']:.1f} near ({place}); more vertices help where the surface is narrow",
            stacklevel=2,
        )


def _lines(found: dict[str, Any]) -> Iterator[tuple[str, str]]:
    angles, edges = found["angles"], found["edges"]
    kind, number = ("triangles", "5 to 7") if found["corners"] == 3 else ("quadrilaterals", "3 to 5")
    curved = f", curved of order {found['order']}, {found['nodes']} nodes" if "order" in found else ""
    yield "mesh", f"{found['vertices']} vertices, {found['faces']} {kind}{curved}"
    yield (
        "angles",
        f"least {angles['least']:.1f}°, mean of the least {angles['mean_of_least']:.1f}°, greatest "
        f"{angles['greatest']:.1f}°",
    )
    yield (
        "edges",
        f"mean {edges['mean']:.4g}, deviation {edges['deviation'] / edges['mean']:.0%}, from {edges['shortest']:.4g} "
        f"to {edges['longest']:.4g}",
    )
    yield "valences", f"{number} at {found['regular']:.1%} of the vertices"
    yield "seconds", f"{found['seconds']:.1f}"
