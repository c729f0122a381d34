"""orbiframe info: which surface a mesh is, its sizes, and what is wrong with it."""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

from orbiframe.cli.description import description, lines
from orbiframe.cli.loops import add_loops, show_loops
from orbiframe.cli.report import plain
from orbiframe.cli.streams import choice, read
from orbiframe.components.registry import Registry
from orbiframe.components.shown_text import shown
from orbiframe.errors import OrbiframeError, UsageError

Described = dict[str, Any]
Describe = Callable[[Path], Described]


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("files", metavar="FILE", type=Path, nargs="+", help="meshes to look at; - for a stream")
    parser.add_argument("-i", "--input-format", metavar="FORMAT", help="name or suffix of a reader")
    parser.add_argument("--json", action="store_true", help="print one JSON object on one line for each file")
    add_loops(parser)
    parser.set_defaults(run=run)


def run(args: argparse.Namespace, registry: Registry) -> int:
    """Look at every file; the status is 1 if one cannot be read."""
    if args.loops is not None:
        return show_loops(args, registry)
    describe = partial(_described, format=args.input_format, registry=registry)
    if args.json:
        return _show_json(args.files, describe)
    if len(args.files) > 1:
        return _show_table(args.files, describe)
    print("\n".join(lines(describe(args.files[0]))))
    return 0


def _described(path: Path, *, format: str | None, registry: Registry) -> Described:
    polyhedron = read(path, registry, format, degenerate=True)
    found = description(polyhedron)
    if _welds(path, format, registry):
        corners, vertices = len(polyhedron.tail), len(polyhedron.vertices)
        where = f"the {corners} corners in the file became {vertices} vertices"
        found["notes"].append({"kind": "welded", "count": corners - vertices, "where": where})
    return found


def _welds(path: Path, format: str | None, registry: Registry) -> bool:
    """Whether the reader of a file joins equal corners of faces."""
    from orbiframe.files.gate import component_name

    name = choice("reader", format, registry).component
    return registry.component("reader", component_name(path, registry, "reader", name)).welds


def _outcomes(files: list[Path], describe: Describe) -> Iterator[tuple[Path, Described]]:
    """Every file with its description, or with the error that it is."""
    for path in files:
        try:
            yield path, describe(path)
        except UsageError:
            raise
        except OrbiframeError as error:
            yield path, {"error": str(error)}


def _show_json(files: list[Path], describe: Describe) -> int:
    status = 0
    for path, found in _outcomes(files, describe):
        print(json.dumps({"file": str(path), **plain(found)}, allow_nan=False), flush=True)
        status |= "error" in found
    return status


def _show_table(files: list[Path], describe: Describe) -> int:
    outcomes = list(_outcomes(files, describe))
    head = ("file", "vertices", "edges", "faces", "surface", "defects")
    rows = [head, *(_row(path, found) for path, found in outcomes)]
    widths = [max(len(row[k]) for row in rows if len(row) == len(head)) for k in range(len(head) - 1)]
    widths[0] = max(len(row[0]) for row in rows)
    for row in rows:
        entries = [entry.ljust(width) for entry, width in zip(row, widths, strict=False)]
        print("  ".join([*entries, *row[len(entries) :]]).rstrip())
    return int(any("error" in found for _, found in outcomes))


def _row(path: Path, found: Described) -> tuple[str, ...]:
    """The entries of a file: name, counts, surface and defects; name and error."""
    if "error" in found:
        return shown(str(path)), shown(f"error: {found['error'].removeprefix(f'{path}').lstrip(':, ')}")
    counts = (str(found[key]) for key in ("vertices", "edges", "faces"))
    defects = ", ".join(f"{defect['count']} {defect['kind']}" for defect in found["defects"])
    return shown(str(path)), *counts, found["surface"], defects or "none"
