"""How good surfaces are, beside those of others: `python benchmarks/quality.py`, tables in Markdown.

Shapes with a truth in closed form are measured against it, all others against their faces: distances both ways,
normals, curvature, triangles that meet, processor seconds. Results go to a JSON file in the folder of `--out` as they
come, and a run goes on where the last one stopped. `--quick`: six shapes. Needs `pip install .[benchmarks]`.

A method of orbiframe is a basis with options: `--method "ps6 size=500 fitter.name=least-squares"`; `default` is what
`orbiframe fit` does, and `linear` before a basis, or alone, one linear fit to the faces. Shapes of the folder `shared`
beside the repository are left out where it is absent.
"""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import argparse
import sys
import time
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from quality import measures, ours, peers, pictures
from quality.results import Result, Results, today
from quality.shapes import QUICK, SHAPES, Shape
from quality.skins import Skin
from quality.table import tables

from orbiframe import Polyhedron, surface_type
from orbiframe.errors import FormatError, OrbiframeError

FOLDER = Path(__file__).parents[1] / "build" / "quality"
OURS = ("default", "ps6", "linear")
QUICK_METHODS = ("default", "ps6", "Loop", "butterfly", "LS3")


def surface(method: str, shape: Shape, mesh: Polyhedron) -> tuple[Skin, float]:
    """What a method makes of a mesh, and its processor seconds."""
    start = time.process_time()
    if method in peers.METHODS:
        found = peers.METHODS[method](peers.Task(mesh, shape.meant))
        seconds = time.process_time() - start
        return peers.skin(found), seconds
    made = ours.fitted(method, mesh)
    seconds = time.process_time() - start
    return ours.skin_of(made, peers.FACES), seconds


def measured(method: str, shape: Shape, mesh: Polyhedron, tile: Path | None) -> Result:
    """One row; with a picture if a file is named."""
    said = (shape.name, shape.kind, shape.meant, surface_type(mesh).name, len(mesh.vertices), method)
    try:
        skin, seconds = surface(method, shape, mesh)
    except (OrbiframeError, peers.Refused) as error:
        return Result(*said, reason=str(error), day=today())
    except Exception as error:  # a crash is a result too, and the run goes on
        return Result(*said, reason=f"crash: {type(error).__name__}: {error}", day=today())
    if not np.isfinite(skin.vertices).all():
        return Result(*said, seconds=seconds, reason="a coordinate is not finite", day=today())
    if tile:
        pictures.tile(skin.vertices, skin.triangles, tile, pictures.view_of(mesh))
    found = measures.errors(skin, shape.finer() if shape.finer else mesh, shape.truth)
    curvature = None if np.isnan(found.curvature) else found.curvature
    crossing = None if found.crossing < 0 else found.crossing
    numbers = (float(found.rms), float(found.max), float(found.normals), curvature, crossing)
    return Result(*said, seconds, *numbers, day=today())


def run(shapes: Sequence[Shape], methods: Sequence[str], results: Results, again: bool, draw: bool) -> None:
    """Measure what is missing, with a line for each."""
    for shape in shapes:
        wanted = [m for m in methods if again or (shape.name, m) not in results.rows]
        if not wanted:
            continue
        try:
            mesh = shape.mesh()
        except FormatError as error:
            print(f"{shape.name}: left out: {error}", file=sys.stderr)
            continue
        if draw:
            pictures.input_tile(mesh, results.path.parent / pictures.tile_name(shape.name, "mesh"))
        for method in wanted:
            tile = results.path.parent / pictures.tile_name(shape.name, method) if draw else None
            result = measured(method, shape, mesh, tile)
            results.add(result)
            print(line(result), file=sys.stderr, flush=True)


def line(result: Result) -> str:
    """A result in a line of text."""
    if result.rms is None:
        return f"{result.shape}, {result.method}: no surface: {result.reason}"
    curved = "" if result.curvature is None else f", curvature {100 * result.curvature:.2g} %"
    return (
        f"{result.shape}, {result.method}: rms {result.rms:.1e}, max {result.max:.1e}, normals {result.normals:.2g}°"
        f"{curved}, {result.seconds:.1f} s"
    )


def warm_up(methods: Sequence[str]) -> None:
    """Compile what is compiled once, so that no shape pays for it."""
    mesh = next(s for s in SHAPES if s.name == QUICK[0]).mesh()
    for method in methods:
        if method not in peers.METHODS:
            ours.fitted(method, mesh)


def replaced(page: str, text: str) -> str:
    """A page with the text between its two marks exchanged."""
    head, _, rest = page.partition("<!-- results -->\n")
    _, _, tail = rest.partition("<!-- end of results -->")
    return f"{head}<!-- results -->\n\n{text}\n\n<!-- end of results -->{tail}"


def arguments(argv: Sequence[str] | None) -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--shape", action="append", metavar="NAME", help="shapes with this in their name or kind")
    parser.add_argument(
        "--method",
        action="append",
        metavar="METHOD",
        help=f"of {', '.join((*OURS, *peers.METHODS))}, or a basis with options",
    )
    parser.add_argument("--quick", action="store_true", help=f"{len(QUICK)} shapes and {len(QUICK_METHODS)} methods")
    parser.add_argument("--again", action="store_true", help="measure again what is there")
    parser.add_argument("--no-pictures", action="store_true", help="numbers alone")
    parser.add_argument("--list", action="store_true", help="the shapes")
    parser.add_argument("--out", type=Path, default=FOLDER, help="folder of results and pictures (build/quality)")
    parser.add_argument("--page", type=Path, metavar="FILE.md", help="put the tables between the marks of a page")
    return parser.parse_args(argv)


def main(argv: Sequence[str] | None = None) -> None:
    """Measure, print the tables, draw the sheets."""
    args = arguments(argv)
    chosen = [s for s in SHAPES if not args.shape or any(n in s.name or n == s.kind for n in args.shape)]
    chosen = [s for s in chosen if s.name in QUICK] if args.quick and not args.shape else chosen
    methods = args.method or (QUICK_METHODS if args.quick else (*OURS, *peers.METHODS))
    if args.list:
        print("\n".join(f"{s.kind}: {s.name}" for s in chosen))
        return
    args.out.mkdir(parents=True, exist_ok=True)
    results = Results(args.out / "quality.json")
    warm_up(methods)
    run(chosen, methods, results, args.again, not args.no_pictures)
    by = results.of([s.name for s in chosen], methods)
    text = "\n".join(tables(by, methods))
    print(text)
    if args.page:
        args.page.write_text(replaced(args.page.read_text(encoding="utf-8"), text), encoding="utf-8")
    if not args.no_pictures:
        labels = {(s, m): f"{r.rms:.1e}" for s, row in by.items() for m, r in row.items() if r.rms is not None}
        for sheet in pictures.sheets(args.out, list(by), methods, labels):
            print(f"\n{sheet}", file=sys.stderr)


if __name__ == "__main__":
    main()
