"""Loops: the loops that cut a mesh open, as polylines in a file, and the fundamental group that they generate."""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from orbiframe.cli.description import description, lines
from orbiframe.cli.report import plain
from orbiframe.cli.streams import read
from orbiframe.components.registry import Registry
from orbiframe.components.shown_text import shown
from orbiframe.errors import UsageError
from orbiframe.files.outputs import require_apart, require_output, write_text
from orbiframe.plugin import DEFAULT_MARKER

if TYPE_CHECKING:
    from orbiframe.meshes.polyhedron import Polyhedron


def add_loops(parser: argparse.ArgumentParser) -> None:
    """Add the option of `orbiframe info`."""
    text = "write short loops that cut the one FILE open to a disc, as polylines (.json or .obj)"
    parser.add_argument("--loops", metavar="OUT", type=Path, help=text)


def show_loops(args: argparse.Namespace, registry: Registry) -> int:
    """Describe the one mesh, write its loops, and say which group they generate."""
    path, out = _one_file(args.files), args.loops
    if out.suffix.lower() not in _TEXTS:
        raise UsageError(f"{out}: loops are written as .json or .obj; give OUT one of these suffixes")
    require_output(out)
    require_apart({"--loops": out}, {"FILE": path})
    mesh = read(path, registry, args.input_format, degenerate=True)
    found = marked(mesh, registry)
    write_text(out, _TEXTS[out.suffix.lower()]({"file": str(path), **found}))
    if args.json:
        short = {**found, "loops": [{"letter": x["letter"], "length": x["length"]} for x in found["loops"]]}
        print(json.dumps({"file": str(path), **plain({**description(mesh), **short})}, allow_nan=False))
    else:
        print("\n".join([*lines(description(mesh)), *_lines(found)]))
    return 0


def marked(mesh: Polyhedron, registry: Registry) -> dict[str, Any]:
    """The loops of a closed mesh and the presentations of its groups, as plain data; vertices as the mesh numbers them.

    Raises TopologyError for a mesh that is not one closed connected surface.
    """
    import numpy as np

    from orbiframe.meshes.defects import require_closed_surface
    from orbiframe.meshes.surface_type import without_unused_vertices
    from orbiframe.words.presentation import Presentation

    require_closed_surface(mesh)
    used = np.unique(mesh.tail)
    marking = registry.load("marker", DEFAULT_MARKER)(without_unused_vertices(mesh))
    group = Presentation.of(marking.word)
    return {
        "word": str(marking.word),
        "fundamental_group": str(group),
        "first_homology": group.homology_text,
        "loops": [_loop(letter, used[loop], mesh) for letter, loop in zip(_letters(group), marking.loops, strict=True)],
    }


def _letters(group: Any) -> list[str]:
    from orbiframe.words.word import text_of

    return [text_of(letter) for letter in group.generators]


def _loop(letter: str, vertices: Any, mesh: Polyhedron) -> dict[str, Any]:
    import numpy as np

    points = mesh.vertices[vertices]
    length = float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())
    return {"letter": letter, "length": length, "vertices": vertices.tolist(), "points": points.tolist()}


def _one_file(files: list[Path]) -> Path:
    if len(files) > 1:
        raise UsageError(f"--loops takes one mesh, and {len(files)} are given; run the command for each of them")
    return files[0]


def _lines(found: dict[str, Any]) -> Iterator[str]:
    yield f"word {found['word']}"
    yield f"fundamental group {found['fundamental_group']}"
    yield f"first homology {found['first_homology']}"
    for loop in found["loops"]:
        yield f"loop {loop['letter']}: {len(loop['vertices']) - 1} edges, length {loop['length']:.6g}"


def _json(found: dict[str, Any]) -> str:
    return json.dumps(plain(found), allow_nan=False) + "\n"


def _obj(found: dict[str, Any]) -> str:
    """Every loop as an object with vertices and one polyline, which comes back to the first of them."""
    text, first = [f"# loops of {shown(found['file'])}, word {found['word']}"], 1
    for loop in found["loops"]:
        points = loop["points"][:-1]
        text.append(f"o loop_{loop['letter']}")
        text += [" ".join(["v", *map(repr, point)]) for point in points]
        text.append(" ".join(["l", *(str(first + k) for k in [*range(len(points)), 0])]))
        first += len(points)
    return "\n".join(text) + "\n"


_TEXTS = {".json": _json, ".obj": _obj}
