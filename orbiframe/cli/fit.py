"""orbiframe fit: one smooth surface from a mesh."""

from __future__ import annotations

import argparse
import json
import shlex
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

from orbiframe.cli.exports import export, export_options, require_known, size_of
from orbiframe.cli.report import json_text, summary, warnings_of, write_report
from orbiframe.cli.speech import say
from orbiframe.components.registry import Registry
from orbiframe.errors import UsageError
from orbiframe.files.destination import require_destination, require_textures
from orbiframe.files.folder import require_folder
from orbiframe.files.outputs import require_apart, require_output
from orbiframe.files.repair_options import add_repairs, repaired, repairs_asked
from orbiframe.fitting.boundary_option import add_boundary

if TYPE_CHECKING:
    from orbiframe.fitting.config import Config
    from orbiframe.fitting.parts import Parts
    from orbiframe.fitting.pipeline import Result
    from orbiframe.fitting.stages import Progress
    from orbiframe.meshes.polyhedron import Polyhedron

LOOK = 3  # the exit status of a fit that is done and whose report warns


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    add = parser.add_argument
    add("mesh", metavar="MESH", type=Path, nargs="+", help="surfaces, orientable or not, of any genus")
    add("-o", "--output", metavar="OUT", type=Path, help="a fine mesh, or the exact surface as .step")
    add("--into", metavar="DIR", type=Path, help="the folder for many meshes, instead of -o")
    add("--to", metavar="SUFFIX", default="ply", help="with --into: the suffix of the files; default ply")
    add("--workers", metavar="N", type=int, default=1, help="with --into: so many processes at once; default 1")
    add("--config", metavar="FILE.toml", type=Path, help="components and options of the steps")
    add("--set", metavar="TABLE.KEY=VALUE", action="append", default=[], help="one option, such as basis.size=200")
    add("--group", metavar="NAME", help="a named group, such as regular-polygon; else that of the mesh (group.method)")
    add("--map", metavar="NAME", help="the map to X/H, such as equivariant (map.method)")
    add(
        "--like",
        metavar="FILE",
        type=Path,
        help="the map of a saved surface, for its mesh moved or cut finer (map.like)",
    )
    add("--solver", metavar="NAME", help="what solves the equations of the map, such as pardiso (solver.name)")
    add("--basis", metavar="NAME", help="the functions, such as ps6 or gaussian (basis.name)")
    add("--data", metavar="MEANS", help="what the mesh means: smooth, semi-smooth or facets; default auto (data.means)")
    add(
        "--creases",
        metavar="ANGLE",
        type=_angle,
        help="edges that bend by ANGLE degrees or more stay sharp; 'marked': those that the file marks (data.creases)",
    )
    add_boundary(parser)
    add("--fast", action="store_true", help="one linear fit on one map (fitter.name=least-squares, data.lift=false)")
    add("--shape", metavar="NAME", help="makes faces regular in X/H, such as regular-faces (shape.method)")
    add(
        "--size",
        metavar="N",
        type=int,
        help="number of functions; default as the shape needs (basis.size)",
    )
    add("--tolerance", metavar="T", type=float, help="largest rms error, of the box's diagonal (output.tolerance)")
    add("--max-error", metavar="T", type=float, help="largest error anywhere, of the box's diagonal (output.max_error)")
    add("--refine", metavar="K", type=int, help="K*K output triangles for each input triangle (output.refine)")
    add("--uv", action="store_true", help="texture coordinates, to .obj, .gltf or .glb (output.uv)")
    add("--faces", metavar="N", type=int, help="to CAD: about so many B-spline faces; default as the topology suggests")
    add("--export-tolerance", metavar="T", type=float, help="of these faces, of the box's diagonal; default 1e-4")
    add("--conforming", action="store_true", help="to G+Smo (.xml): neighbouring patches have the same knots")
    add("--unit", choices=("mm", "cm", "m", "in"), help="to CAD: the unit of the file's lengths; default mm")
    add("--exact", action="store_true", help="to CAD: the exact patches of --basis ps2, ps6 and others")
    add("--order", metavar="Q", type=int, help="write curved triangles of order 1 to 6, for finite elements")
    add("--format", metavar="NAME", help="with --order: the format, such as gmsh-2.2, instead of that of the suffix")
    add(
        "--report",
        metavar="DIR",
        type=Path,
        help="write the report: a folder for a page with pictures, or FILE.json; status 3 if it warns",
    )
    add("--save", metavar="FILE", type=Path, help="write the surface itself, to be evaluated anywhere")
    add("--json", action="store_true", help="print the report as JSON instead of the summary")
    add("--quiet", action="store_true", help="print nothing but errors")
    add_repairs(parser)
    parser.set_defaults(run=run, wrong_use=parser.error)


def _angle(word: str) -> float | str:
    """An angle, or a word, of which the configuration knows one."""
    try:
        return float(word)
    except ValueError:
        return word


def run(args: argparse.Namespace, registry: Registry) -> int:
    """Fit, write what was asked for, and say what came out; many meshes with --into."""
    if args.into is not None:
        from orbiframe.cli.fit_many import run_many

        return run_many(args, registry)
    if args.output is None or len(args.mesh) > 1:
        args.wrong_use("give one MESH and -o OUT, or any number of meshes and --into DIR")
    args.mesh = args.mesh[0]
    report, written = fitted(args, registry, args.progress)
    if not args.quiet:
        print(json_text(report) if args.json else summary(report, written=written))
    return LOOK if args.report and warnings_of(report) else 0


def fitted(args: argparse.Namespace, registry: Registry, progress: Progress) -> tuple[dict[str, Any], str | None]:
    """Fit one mesh and write what was asked for; the report, and what was written where that is no mesh."""
    from orbiframe.files import gate
    from orbiframe.files.gate import require_no_boundary
    from orbiframe.fitting.config import Config
    from orbiframe.fitting.parts import fit_parts
    from orbiframe.fitting.pipeline import mesh_of

    config = Config.load(args.config, overrides(args), registry)
    _require_destinations(args, config, registry)
    kind = _kind(args, config, registry)
    mesh = _repaired(args, config, registry) if repairs_asked(args) else args.mesh
    options = export_options(args, config, registry) or {} if kind == "exporter" else {}
    if kind == "exporter" and config.boundary != "error" and options.get("exact", True):
        mesh = mesh_of(mesh, config, registry)
        require_no_boundary(args.output, open_=bool((mesh.twin < 0).any()))
    found = fit_parts(mesh, config, registry, progress)
    written = None
    if kind == "elements":
        written = _write_elements(args, found, config.output.refine or 1, registry, progress)
    elif kind == "exporter":
        written = export(args.output, _only(found, args.output), options, registry, progress)
    else:
        gate.write(args.output, found.output, registry)
    if args.save:
        _save(args.save, found)
    if args.report:
        _write_report(args, found, progress)
    return found.report, written


def _write_report(args: argparse.Namespace, found: Parts, progress: Progress) -> None:
    """The report with the command that makes it again: as data, or as a page in a folder."""
    command = shlex.join(["orbiframe", *args.words])
    if not _is_page(args.report):
        write_report(args.report, {**found.report, "command": command})
        return
    from orbiframe.cli.fit_page import write_page

    write_page(args.report, found, command, progress)


def _is_page(path: Path) -> bool:
    """Whether a report is a page in a folder: what has no suffix, or is a folder."""
    return path.is_dir() or not path.suffix


def _only(found: Parts, path: Path) -> Result:
    """The one part that there is; a file of exact patches holds no more."""
    if len(found.results) > 1:
        raise UsageError(
            f"{path}: the mesh has {len(found.results)} components, and an exact surface is one; choose one with "
            "--component N, or write a mesh"
        )
    return found.results[0]


def _save(path: Path, found: Parts) -> None:
    """Write the surface, or one file for each, numbered: FILE-1.npz, FILE-2.npz and so on."""
    from orbiframe.files.surface_file import save_surface

    several = len(found.results) > 1
    for number, result in enumerate(found.results, start=1):
        save_surface(result.surface, path.with_stem(f"{path.stem}-{number}") if several else path)


def _write_elements(
    args: argparse.Namespace, found: Parts, density: int, registry: Registry, progress: Progress
) -> str:
    """Write curved triangles on all surfaces, and say what was written."""
    from orbiframe.files import gate
    from orbiframe.surfaces import GeodesicFaces, curved_mesh, input_faces, joined_meshes

    progress("elements", None)
    start = time.perf_counter()
    surfaces = [result.surface for result in found.results]
    faces: list[GeodesicFaces] = [input_faces(surface) for surface in surfaces]
    mesh = joined_meshes(
        [curved_mesh(surface, part, args.order, density) for surface, part in zip(surfaces, faces, strict=True)]
    )
    gate.write_elements(args.output, mesh, registry, format=args.format)
    found.report["seconds"]["elements"] = round(time.perf_counter() - start, 4)
    progress("elements", found.report["seconds"]["elements"])
    other = any(not part.of_input for part in faces)
    if other and not args.quiet and all(surface.triangulation.crease is None for surface in surfaces):
        say("triangles of the input fold as geodesic triangles, so the elements are Delaunay triangles of its vertices")
    return f"{len(mesh.elements)} triangles of order {mesh.order}, {len(mesh.nodes)} nodes, {size_of(args.output)}"


def _repaired(args: argparse.Namespace, config: Config, registry: Registry) -> Polyhedron:
    from orbiframe.files import gate

    format = None if config.mesh.open else config.mesh.name
    mesh = gate.read(args.mesh, registry, format=format, degenerate=args.drop_degenerate)
    return repaired(mesh, args, None if args.quiet else say)


def overrides(args: argparse.Namespace) -> list[str]:
    """The options of the command line as TABLE.KEY=VALUE, those with a name of their own last."""
    named = {
        "group.method": args.group,
        "map.method": args.map,
        "map.like": None if args.like is None else json.dumps(str(args.like)),
        "solver.name": args.solver,
        "basis.name": args.basis,
        "shape.method": args.shape,
        "basis.size": args.size,
        "output.tolerance": args.tolerance,
        "output.max_error": args.max_error,
        "data.means": args.data,
        "data.creases": args.creases,
        "mesh.boundary": args.boundary,
        "output.refine": args.refine,
        "output.uv": "true" if args.uv else None,
    }
    fast = ["fitter.name=least-squares", "data.lift=false"] if args.fast else []
    return [*fast, *args.set, *(f"{key}={value}" for key, value in named.items() if value is not None)]


def _kind(args: argparse.Namespace, config: Config, registry: Registry) -> str:
    """The kind of component that writes the output. Raises UsageError for orders that are not made."""
    from orbiframe.surfaces.curved_triangles import LARGEST_ORDER

    if args.order is None:
        if args.format is not None:
            raise UsageError(f"--format {args.format} chooses how elements are written; add --order, such as --order 2")
        return "writer" if export_options(args, config, registry) is None else "exporter"
    if not 1 <= args.order <= LARGEST_ORDER:
        raise UsageError(f"--order {args.order}: elements have an order of 1 to {LARGEST_ORDER}")
    require_known(args, None)
    return "elements"


def _require_textures(args: argparse.Namespace, kind: str, registry: Registry) -> None:
    if kind != "writer":
        raise UsageError(f"{args.output}: texture coordinates belong to meshes of flat faces, such as surface.obj")
    require_textures(args.output, registry, args.format)


def _require_destinations(args: argparse.Namespace, config: Config, registry: Registry) -> None:
    outputs = {"-o": args.output, "--report": args.report, "--save": args.save}
    plugins = {f"the plugin {path}": path for path in config.plugins}
    require_apart(outputs, {"the input": args.mesh, "--config": args.config, "--like": args.like, **plugins})
    kind = _kind(args, config, registry)
    require_destination(args.output, registry, args.format, kind=kind)
    if config.output.uv:
        _require_textures(args, kind, registry)
    if args.report is not None and _is_page(args.report):
        require_folder(args.report)
    elif args.report is not None:
        require_output(args.report)
    if args.save is not None:
        require_output(args.save)
