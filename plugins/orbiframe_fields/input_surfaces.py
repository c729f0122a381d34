"""Input surfaces: the surfaces of a mesh or of a saved file, and the mesh on which numbers are shown."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from orbiframe import OrbifoldSurface, Points, Polyhedron, Registry, UsageError, load_surface, read
from orbiframe.fitting import add_boundary
from orbiframe_fields.fitted_surfaces import fitted_surfaces
from orbiframe_fields.mesh_field import SURFACE, side_by_side, tessellated, vertices_of

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]


class InputSurfaces(NamedTuple):
    """A mesh, its surfaces, one for each component, and for each the numbers of its vertices in the mesh."""

    mesh: Polyhedron
    surfaces: list[OrbifoldSurface]
    vertices: list[Ints]


class Shown(NamedTuple):
    """A mesh for numbers: for each surface the points of X/H under its vertices, and which vertices these are."""

    mesh: Polyhedron
    points: list[Points]
    vertices: list[Ints]
    normals: Floats | None


def add_surface_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments that say which surface is meant and how it is fitted."""
    add = parser.add_argument
    add("mesh", metavar="MESH", type=Path, help="surfaces, or a surface that `fit --save` wrote (.npz)")
    add("-o", "--output", metavar="OUT", type=Path, help="numbers at the vertices of a mesh: .ply, .vtu or .csv")
    add("--picture", metavar="FILE", type=Path, help="a picture on the surface, .png")
    add(
        "--refine", metavar="K", type=int, help="each triangle in K*K; 0: at the vertices of MESH; default: a fine mesh"
    )
    add("--config", metavar="FILE.toml", type=Path, help="components and options of the fit of the surface")
    add("--set", metavar="TABLE.KEY=VALUE", action="append", default=[], help="one option, such as basis.size=2000")
    add_boundary(parser)
    add("--json", action="store_true", help="print one JSON object instead of the summary")


def require_outputs(args: argparse.Namespace) -> None:
    """Raise for files that cannot be written, before anything is computed."""
    from orbiframe.files import require_apart, require_output
    from orbiframe_fields.field_table import require_field_file

    given = {"-o": args.output, "--picture": args.picture}
    for name, path in given.items():
        if path is not None:
            require_apart({name: path}, {"the mesh": args.mesh, "--config": args.config})
    if args.output is not None:
        require_field_file(args.output)
    if args.picture is not None:
        if args.picture.suffix.lower() != ".png":
            raise UsageError(f"--picture {args.picture}: a picture is written as .png; give it this suffix")
        require_output(args.picture)
    if args.refine is not None and args.refine < 0:
        raise UsageError(f"--refine {args.refine}: give 0 for the vertices of the mesh, or 1 and more")


def input_surfaces(args: argparse.Namespace, registry: Registry) -> InputSurfaces:
    """The surfaces of the arguments."""
    if args.mesh.suffix.lower() == SURFACE:
        surface = load_surface(args.mesh, registry)
        mesh = vertices_of(surface)
        return InputSurfaces(mesh, [surface], [np.arange(len(mesh.vertices))])
    mesh = read(args.mesh, registry)
    options = [*args.set, *([] if args.boundary is None else [f"mesh.boundary={args.boundary}"])]
    fitted = fitted_surfaces(mesh, args.config, options, registry, args.progress)
    return InputSurfaces(mesh, [each.surface for each in fitted], [each.vertices for each in fitted])


def shown(found: InputSurfaces, refine: int | None) -> Shown:
    """The mesh itself for 0, with the points that are nearest to its vertices; else a finer one on the surfaces."""
    if refine == 0:
        x = found.mesh.vertices
        feet = [s.nearest(x[own])[0] for s, own in zip(found.surfaces, found.vertices, strict=True)]
        return Shown(found.mesh, feet, found.vertices, None)
    parts = [tessellated(surface, refine, len(found.surfaces)) for surface in found.surfaces]
    ends = np.cumsum([len(mesh.vertices) for mesh, _ in parts])
    vertices = np.split(np.arange(ends[-1]), ends[:-1])
    normals = [mesh.normals for mesh, _ in parts if mesh.normals is not None]
    mesh = side_by_side([mesh for mesh, _ in parts])
    return Shown(mesh, [points for _, points in parts], vertices, np.concatenate(normals) if normals else None)


def columns_of(there: Shown, columns: dict[str, Floats]) -> dict[str, Floats]:
    """The columns, after the normals where the mesh has some."""
    return columns if there.normals is None else {"normal": there.normals, **columns}
