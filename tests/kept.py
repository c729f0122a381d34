"""What each suffix keeps, found by writing and reading; `python tests/kept.py` prints the table of the docs."""

from __future__ import annotations

import contextlib
import importlib
import math
import tempfile
import warnings
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from orbiframe import FormatError, PluginError, Polyhedron
from orbiframe.components.registry import Registry
from orbiframe.files import gate
from orbiframe.meshes import MarkedEdges

TABLES = ("normals", "colors", "face_colors", "marked")
HEADING = ("suffix", "read and written by", "triangles", "quads", "n-gons", "normals", "colours of vertices",
           "colours of faces", "sharp edges", "coordinates")  # fmt: skip


def meshes() -> dict[str, Polyhedron]:
    """Triangles, quads, and triangles, quads and a pentagon together, with coordinates of many digits."""
    turn = np.exp(2j * np.pi * np.arange(5) / 5)
    ring = np.stack([turn.real, turn.imag, np.zeros(5)], axis=1)
    house = [[4, 3, 2, 1, 0], *([k, (k + 1) % 5, 5 + (k + 1) % 5, 5 + k] for k in range(5))]
    roof = [[5 + k, 5 + (k + 1) % 5, 10] for k in range(5)]
    box = np.array(np.meshgrid([0, 1], [0, 1], [0, 1], indexing="ij")).reshape(3, -1).T
    sides = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    rough = {
        "triangles": (np.eye(4)[:, :3], [[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]]),
        "quads": (box, sides),
        "n-gons": (np.vstack([ring, ring + np.array([0, 0, 1]), [[0, 0, 2]]]), [*house, *roof]),
    }
    return {name: Polyhedron.from_faces(points + math.pi, faces) for name, (points, faces) in rough.items()}


def suffixes(registry: Registry) -> list[tuple[str, str]]:
    """Every suffix that is both read and written, with the name of its component."""
    writers = {suffix for c in registry.components("writer") for suffix in c.suffixes}
    return [(s, c.name) for c in registry.components("reader") for s in c.suffixes if s in writers]


def row(suffix: str, name: str, registry: Registry, folder: Path) -> list[str]:
    """The row of a suffix in the table of the docs."""
    path = folder / f"mesh{suffix}"
    made, yes = meshes(), "yes"
    if _again(path, made["triangles"], registry) is None:
        made, yes = {kind: _flat(mesh) for kind, mesh in made.items()}, "in the plane"
    found = {kind: _again(path, mesh, registry) for kind, mesh in made.items()}
    assert found["triangles"] is not None, f"{suffix} does not even hold triangles"
    full = _again(path, _full(made["triangles"]), registry)
    kinds = ["no" if mesh is None else yes for mesh in found.values()]
    tables = ["no" if getattr(full, table) is None else "yes" for table in TABLES]
    return [f"`{suffix}`", f"`{name}`", *kinds, *tables, _precision(made["triangles"], found["triangles"])]


def _flat(mesh: Polyhedron) -> Polyhedron:
    return mesh.with_vertices(mesh.vertices * [1, 1, 0])


def _full(mesh: Polyhedron) -> Polyhedron:
    grey = np.full((mesh.face_count, 3), 0.2)
    marked = MarkedEdges(np.array([[0, 1], [3, 1]]), np.array([1.0, np.pi]))
    colors = np.full_like(mesh.vertices, 0.6)
    return replace(mesh, normals=mesh.vertices, colors=colors, face_colors=grey, marked=marked)


def _again(path: Path, mesh: Polyhedron, registry: Registry) -> Polyhedron | None:
    """The polyhedron written and read again, None where its writer refuses it. Nothing else may happen."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message=".*(left out|no opacity)")
        try:
            gate.write(path, mesh, registry)
        except FormatError:
            return None
        found = gate.read(path, registry)
    assert np.array_equal(found.offsets, mesh.offsets)
    assert np.allclose(found.vertices[found.tail], mesh.vertices[mesh.tail], rtol=0, atol=1e-6)
    return found


def _precision(made: Polyhedron, found: Polyhedron) -> str:
    wanted, got = made.vertices[made.tail], found.vertices[found.tail]
    if np.array_equal(wanted, got):
        return "double"
    if np.array_equal(wanted.astype(np.float32), got):
        return "single"
    digits = next(n for n in range(1, 18) if [float(f"{x:.{n - 1}e}") for x in wanted.flat] == got.ravel().tolist())
    return f"{digits} digits"


def in_this_process(target: str, *arguments: Any, **limits: float) -> Any:
    """In the place of a confined call, for files that are known to be good: saves a process each."""
    module, _, function = target.partition(":")
    return getattr(importlib.import_module(module), function)(*arguments)


def unconfined() -> None:
    """Let the libraries work in this process."""
    for name in ("meshio", "open3d"):
        importlib.import_module(f"orbiframe_{name}.reader").confined_read = in_this_process
        importlib.import_module(f"orbiframe_{name}.writer").confined_write = in_this_process


def lines() -> Iterator[str]:
    """The table, line by line; formats whose library is not installed are left out."""
    unconfined()
    registry = Registry.discover()
    yield f"| {' | '.join(HEADING)} |"
    yield "|---" * len(HEADING) + "|"
    with tempfile.TemporaryDirectory() as folder:
        for suffix, name in suffixes(registry):
            with contextlib.suppress(PluginError):
                yield f"| {' | '.join(row(suffix, name, registry, Path(folder)))} |"


if __name__ == "__main__":
    for line in lines():
        print(line, flush=True)
