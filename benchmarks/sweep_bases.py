"""No garbage with status 0: every basis on every mesh of the folder `shared`: `python benchmarks/sweep_bases.py`.

Each fit has all options left alone but the basis and the number of functions. What comes is a surface or an error in
words; a surface is garbage if it misses the mesh, one way or the other, by more than 2 % of the diagonal (root mean
square), if it leaves it by more than 15 % anywhere, or if more than 0.5 % of its area is folded; for one-sided surfaces
folds are not counted as such. Printed are a table of bases in Markdown and all findings, the worst first. Results are
kept as lines of JSON in the file of `--out`, so that a run goes on where the last one stopped. Meshes of more vertices
than `--most` are left out, and a fit that takes more than `--seconds` is given up and told so.
"""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import argparse
import json
import signal
import sys
import time
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

from orbiframe import Polyhedron, Registry, fit, read
from orbiframe.errors import OrbiframeError

ROOT = Path(__file__).parents[1]
FOLDERS = ("meshes", "cases/meshes")
SUFFIXES = (".off", ".obj", ".ply", ".stl")
SIZES = (200, 1000)
MOST_RMS, MOST_ANYWHERE, MOST_FOLDED = 0.02, 0.15, 0.005

Row = dict[str, Any]


class TooLong(Exception):
    """A fit has taken more than its seconds."""


def meshes(folder: Path) -> list[Path]:
    """The files of meshes, sorted by size: what is quick comes first."""
    found = (path for name in FOLDERS for path in (folder / name).glob("*") if path.suffix.lower() in SUFFIXES)
    return sorted(found, key=lambda path: (path.stat().st_size, path.name))


def tried(mesh: Polyhedron, basis: str, size: int, registry: Registry) -> Row:
    """What a fit gives, in numbers, or the words in which it refuses."""
    start = time.process_time()
    try:
        report = fit(mesh, registry=registry, basis=basis, size=size, progress=False).report
    except OrbiframeError as error:
        return {"refused": str(error)}
    except TooLong as error:
        return {"late": str(error)}
    except Exception as error:  # a crash is what is looked for
        return {"crash": f"{type(error).__name__}: {error}"}
    there, back = report["distance"]["mesh_to_surface"], report["distance"]["surface_to_mesh"]
    folded = report["shape"]["folded_share"] if report["surface"]["orientable"] else 0.0
    return {
        "functions": report["fit"]["size"],
        "means": report["data"]["means"],
        "rms": max(there["rms"], back["rms"]),
        "max": max(there["max"], back["max"]),
        "folded": folded,
        "notes": report["notes"],
        "seconds": round(time.process_time() - start, 1),
    }


def garbage(row: Row) -> bool:
    """Whether a surface is none of the mesh."""
    return "rms" in row and not (
        row["rms"] <= MOST_RMS and row["max"] <= MOST_ANYWHERE and (row["folded"] or 0) <= MOST_FOLDED
    )


def kept(path: Path) -> dict[tuple[str, str, int], Row]:
    """The results so far, by mesh, basis and size."""
    if not path.exists():
        return {}
    rows = (json.loads(line) for line in path.read_text(encoding="utf-8").splitlines())
    return {(row["mesh"], row["basis"], row["size"]): row for row in rows}


def run(args: argparse.Namespace, registry: Registry) -> None:
    """Try what is missing, a line for each."""
    known = kept(args.out)
    args.out.parent.mkdir(parents=True, exist_ok=True)
    for path in meshes(args.folder):
        if args.mesh and not any(name in path.name for name in args.mesh):
            continue
        wanted = [(b, n) for n in args.size or SIZES for b in args.basis if (path.name, b, n) not in known]
        mesh = opened(path, registry, args.most) if wanted else None
        for basis, size in wanted if mesh is not None else ():
            signal.setitimer(signal.ITIMER_PROF, args.seconds)
            row = {"mesh": path.name, "basis": basis, "size": size} | tried(mesh, basis, size, registry)
            signal.setitimer(signal.ITIMER_PROF, 0)
            with args.out.open("a", encoding="utf-8") as file:
                file.write(json.dumps(row) + "\n")
            print(line(row), file=sys.stderr, flush=True)


def opened(path: Path, registry: Registry, most: int) -> Polyhedron | None:
    """A mesh, None for one that is too large or that is no closed surface."""
    try:
        mesh = read(path, registry)
        fit(mesh, registry=registry, basis="gaussian", size=20, fast=True, progress=False)
    except OrbiframeError as error:
        print(f"{path.name}: left out: {error}", file=sys.stderr)
        return None
    return mesh if len(mesh.vertices) <= most else None


def line(row: Row) -> str:
    """A result in a line."""
    name = f"{row['mesh']}, {row['basis']} {row['size']}"
    for kind in ("refused", "late", "crash"):
        if kind in row:
            return f"{name}: {kind}: {row[kind]}"
    folded = f", folded {row['folded']:.1e}" if row["folded"] else ""
    mark = "GARBAGE: " if garbage(row) else ""
    return f"{mark}{name}: {row['means']}, rms {row['rms']:.1e}, max {row['max']:.1e}{folded}, {row['seconds']} s"


def tables(rows: Iterable[Row]) -> Iterator[str]:
    """The table of bases, and all that is garbage, crashed or late."""
    rows = list(rows)
    yield "| basis | size | fits | surfaces | refused | too long | crashes | garbage | largest rms | largest max |"
    yield "| --- " * 10 + "|"
    for basis, size in sorted({(row["basis"], row["size"]) for row in rows}):
        mine = [row for row in rows if (row["basis"], row["size"]) == (basis, size)]
        kinds = Counter(next((k for k in ("refused", "late", "crash") if k in row), "made") for row in mine)
        made = [row for row in mine if "rms" in row]
        worst = [f"{max((row[key] for row in made), default=0):.1e}" for key in ("rms", "max")]
        counts = (len(mine), kinds["made"], kinds["refused"], kinds["late"], kinds["crash"], sum(map(garbage, made)))
        yield f"| {basis} | {size} | {' | '.join(map(str, counts))} | {' | '.join(worst)} |"
    found = [row for row in rows if "crash" in row or "late" in row or garbage(row)]
    yield from ("", *(f"- {line(row)}" for row in sorted(found, key=lambda row: -row.get("rms", 0))))


def stop(*_: object) -> None:
    """End a fit that takes too long."""
    raise TooLong("given up")


def main(argv: Sequence[str] | None = None) -> None:
    """Try all, print the table."""
    registry = Registry.discover()
    bases = sorted(component.name for component in registry.components("basis"))
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--folder", type=Path, default=ROOT.parent / "shared", help="with meshes and cases/meshes")
    parser.add_argument("--mesh", action="append", metavar="NAME", help="files with this in their name")
    parser.add_argument("--basis", action="append", choices=bases, help="default all")
    parser.add_argument("--size", action="append", type=int, help="default 200 and 1000")
    parser.add_argument("--most", type=int, default=6000, help="vertices of a mesh")
    parser.add_argument("--seconds", type=int, default=120, help="of the processor, for a fit")
    parser.add_argument("--out", type=Path, default=ROOT / "build" / "sweep_bases.jsonl", help="the file of results")
    args = parser.parse_args(argv)
    args.basis = args.basis or bases
    signal.signal(signal.SIGPROF, stop)
    run(args, registry)
    wanted = (row for row in kept(args.out).values() if row["basis"] in args.basis)
    print("\n".join(tables(wanted)))


if __name__ == "__main__":
    main()
