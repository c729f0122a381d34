"""orbiframe draw: the tessellation of X/H that a mesh becomes, its smooth surface, and the loops that cut it open."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from orbiframe import FormatError, Registry, UsageError
from orbiframe.files import require_apart
from orbiframe.fitting import add_boundary
from orbiframe.plugin import DEFAULT_MARKER

if TYPE_CHECKING:
    from orbiframe import OrbifoldSurface, Polyhedron
    from orbiframe_drawing.picture import Picture

SURFACE = ".npz"
# Functions of a fit of which only the map is drawn.
_FEW = "basis.size=100"


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    add = parser.add_argument
    add("mesh", metavar="MESH", type=Path, help="a mesh, or a surface that `fit --save` wrote (.npz)")
    add("-o", "--output", metavar="FILE", type=Path, required=True, help="the picture: .svg, .png or .pdf")
    what = parser.add_mutually_exclusive_group().add_argument
    what("--surface", action="store_true", help="the smooth surface beside the tessellation")
    what("--cut", action="store_true", help="the mesh with the loops that cut it open, beside the polygon they make")
    add("--group", metavar="NAME", help="a named group, such as regular-polygon; else that of the mesh (group.method)")
    add_boundary(parser)
    add("--config", metavar="FILE.toml", type=Path, help="components and options of the fit")
    add("--set", metavar="TABLE.KEY=VALUE", action="append", default=[], help="one option, such as basis.size=200")
    add("--model", metavar="NAME", help="projective, conformal (the default), hyperboloid or sphere")
    add("--radius", metavar="R", type=float, help="fill the disc of radius R in X; else as far as edges can be told")
    add("--centre", metavar="V", type=int, help="the vertex of the mesh in the middle of the tessellation")
    add("--view", metavar=("X", "Y", "Z"), type=float, nargs=3, help="from where a surface in space is seen")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace, registry: Registry) -> int:
    """Make the picture and write it."""
    from orbiframe_drawing.file import require_picture_file, save_picture

    require_picture_file(args.output)
    require_apart({"-o": args.output}, {"the input": args.mesh, "--config": args.config})
    save_picture(_picture(args, registry), args.output)
    return 0


def _picture(args: argparse.Namespace, registry: Registry) -> Picture:
    from orbiframe.triangulations import Tessellation
    from orbiframe_drawing.solid import VIEW
    from orbiframe_drawing.solid_picture import surface_picture
    from orbiframe_drawing.tessellation_picture import tessellation_picture

    view = VIEW if args.view is None else tuple(args.view)
    if not any(view):
        raise UsageError("--view 0 0 0 is no direction; give that from the surface to the eye, such as 1 -2 2")
    if args.cut:
        return _cut(args, view, registry)
    made = _made(args, registry)
    tessellation = Tessellation.of_map(made.polyhedron, made.surface.refinement, made.surface.triangulation)
    patch, centre = _middle(args.centre, made.surface)
    tiling = tessellation_picture(tessellation, model=args.model, radius=args.radius, patch=patch, centre=centre)
    return surface_picture(made.surface, made.polyhedron, tiling, view=view) if args.surface else tiling


class _Made(NamedTuple):
    """A surface and the polyhedron that it belongs to; of a saved surface its triangles."""

    surface: OrbifoldSurface
    polyhedron: Polyhedron


def _made(args: argparse.Namespace, registry: Registry) -> _Made:
    from orbiframe import Config, fit, load_surface
    from orbiframe.meshes import oriented

    if args.mesh.suffix.lower() == SURFACE:
        if args.group or args.config or args.set or args.boundary:
            raise UsageError(
                f"{args.mesh} is a finished surface; --group, --boundary, --config and --set belong to meshes"
            )
        surface = load_surface(args.mesh, registry)
        return _Made(surface, surface.own_mesh)
    chosen = [f"group.method={args.group}"] if args.group else []
    chosen += [f"mesh.boundary={args.boundary}"] if args.boundary else []
    sized = args.surface or args.config or any(text.startswith("basis.") for text in args.set)
    config = Config.load(args.config, [*([] if sized else [_FEW]), *args.set, *chosen], registry)
    polyhedron = oriented(_read(args, registry))
    return _Made(fit(polyhedron, config, registry, args.progress).surface, polyhedron)


def _read(args: argparse.Namespace, registry: Registry) -> Polyhedron:
    from orbiframe import read
    from orbiframe.meshes import without_unused_vertices

    return without_unused_vertices(read(args.mesh, registry))


def _middle(vertex: int | None, surface: OrbifoldSurface) -> tuple[int, Any]:
    """The patch and the point in it that come into the middle of the picture."""
    if vertex is None:
        return 0, None
    count = len(surface.refinement.coarse.vertices)
    if not 0 <= vertex < count:
        raise UsageError(f"--centre {vertex}: the vertices of the mesh are 0 to {count - 1}")
    return int(surface.triangulation.patch[vertex]), surface.triangulation.points[vertex]


def _cut(args: argparse.Namespace, view: Any, registry: Registry) -> Picture:
    from orbiframe.meshes import require_closed_surface
    from orbiframe_drawing.solid_picture import cut_picture

    if args.mesh.suffix.lower() == SURFACE:
        raise FormatError(f"{args.mesh}: loops are drawn on a mesh; give the mesh that the surface was made of")
    if args.boundary:
        raise UsageError("--cut draws loops that cut a closed surface open; leave out --cut or --boundary")
    mesh = _read(args, registry)
    surface = require_closed_surface(mesh)
    marking = registry.load("marker", DEFAULT_MARKER)(mesh)
    name = args.group or "regular-polygon"
    group = registry.load("group", name)(registry.geometry(surface.euler_characteristic), marking.word)
    return cut_picture(marking, group, view=view)
