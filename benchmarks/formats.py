"""Reading and writing a million triangles, side by side with meshio and Open3D: `python benchmarks/formats.py`.

Each number is megabytes of the file for a second, the best of some runs with the file in the memory of the system and
all code loaded; `--memory` shows instead the most memory that a reader takes, in times of the arrays of its result.
Here a reader makes more than the others: it checks the numbers and finds the neighbour of every edge.
"""

from __future__ import annotations

import argparse
import contextlib
import io
import tempfile
import time
import tracemalloc
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from orbiframe import Polyhedron
from orbiframe.components.registry import Registry
from orbiframe.files import gate

REGISTRY = Registry.discover()
FORMATS = {
    "OFF": ("off", {}),
    "OBJ": ("obj", {}),
    "PLY, text": ("ply", {"ascii": True}),
    "PLY, binary": ("ply", {}),
    "STL, text": ("stl", {"ascii": True}),
    "STL, binary": ("stl", {}),
}
ARRAYS = ("vertices", "offsets", "tail", "twin", "same")


def torus(count: int) -> Polyhedron:
    """A torus of so many triangles, its vertices moved a little so that all their digits are needed."""
    m = max(3, int((count / 4) ** 0.5))
    n = count // (2 * m)
    a, b = np.divmod(np.arange(n * m), m)
    u, v = 2 * np.pi * a / n, 2 * np.pi * b / m
    points = np.stack([(2 + np.cos(v)) * np.cos(u), (2 + np.cos(v)) * np.sin(u), np.sin(v)], axis=1)
    points += np.random.default_rng(0).normal(size=points.shape) * 1e-5

    def index(i: Any, j: Any) -> Any:
        return (i % n) * m + j % m

    corners = [index(a, b), index(a + 1, b), index(a + 1, b + 1), index(a, b), index(a + 1, b + 1), index(a, b + 1)]
    return Polyhedron.from_faces(points, np.stack(corners, axis=1).reshape(-1, 3))


@dataclass(frozen=True)
class Trial:
    """How speeds are measured: by how many runs, and by which clock."""

    runs: int
    clock: Callable[[], float]

    def speed(self, action: Callable[[], object], size: float) -> str:
        """Megabytes for a second, by the best of the runs; what the library raises, if it does."""
        best = float("inf")
        try:
            for _ in range(self.runs):
                start = self.clock()
                action()
                best = min(best, self.clock() - start)
        except (Exception, SystemExit) as error:
            return type(error).__name__
        return f"{size / 1e6 / best:.0f}"


def orbiframe_actions(path: Path, mesh: Polyhedron, options: dict[str, bool]) -> tuple[Callable[[], object], ...]:
    """Read and write."""
    writer = REGISTRY.load("writer", path.suffix[1:])
    return partial(gate.read, path, REGISTRY), partial(writer, path, mesh, **options)


def meshio_actions(path: Path, mesh: Polyhedron, options: dict[str, bool]) -> tuple[Callable[[], object], ...]:
    """Read and write."""
    import meshio

    binary = {} if path.suffix in (".off", ".obj") else {"binary": not options}
    made = meshio.Mesh(mesh.vertices, [("triangle", mesh.triangles)])
    return partial(meshio.read, path), partial(meshio.write, path.with_stem("meshio"), made, **binary)


def open3d_actions(path: Path, mesh: Polyhedron, options: dict[str, bool]) -> tuple[Callable[[], object], ...]:
    """Read and write; None where Open3D does not write text."""
    import open3d

    vector = open3d.utility
    made = open3d.geometry.TriangleMesh(vector.Vector3dVector(mesh.vertices), vector.Vector3iVector(mesh.triangles))
    made.compute_triangle_normals()
    write = partial(open3d.io.write_triangle_mesh, str(path.with_stem("open3d")), made, write_ascii=bool(options))
    return partial(open3d.io.read_triangle_mesh, str(path)), write


PEERS = {"orbiframe": orbiframe_actions, "meshio": meshio_actions, "Open3D": open3d_actions}


def rows(names: list[str], count: int, trial: Trial) -> Iterator[list[str]]:
    """A row for each format: its megabytes, and for each peer the speeds of reading and writing."""
    with tempfile.TemporaryDirectory() as folder:
        for name in names:
            suffix, options = FORMATS[name]
            path, made = Path(folder) / f"mesh.{suffix}", torus(count)
            REGISTRY.load("writer", suffix)(path, made, **options)
            size = path.stat().st_size
            yield [name, f"{size / 1e6:.0f}", *(_speeds(peer, path, made, options, size, trial) for peer in PEERS)]


def _speeds(peer: str, path: Path, mesh: Polyhedron, options: dict[str, bool], size: int, trial: Trial) -> str:
    try:
        actions = PEERS[peer](path, mesh, options)
    except ImportError:
        return "–"
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        return " / ".join(trial.speed(action, size) for action in actions)


def memory(names: list[str], count: int) -> Iterator[list[str]]:
    """A row for each format: the most memory while reading, in times of the result."""
    with tempfile.TemporaryDirectory() as folder:
        for name in names:
            suffix, options = FORMATS[name]
            path, made = Path(folder) / f"mesh.{suffix}", torus(count)
            REGISTRY.load("writer", suffix)(path, made, **options)
            gate.read(path, REGISTRY)
            tracemalloc.start()
            found = gate.read(path, REGISTRY)
            peak = tracemalloc.get_traced_memory()[1]
            tracemalloc.stop()
            yield [name, f"{peak / sum(getattr(found, array).nbytes for array in ARRAYS):.1f}"]


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--triangles", type=int, default=1_000_000)
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--formats", nargs="+", choices=FORMATS, default=list(FORMATS), metavar="NAME")
    parser.add_argument("--cpu", action="store_true", help="count processor seconds, where other work goes on beside")
    parser.add_argument("--memory", action="store_true")
    args = parser.parse_args()
    heading = ["format", "memory"] if args.memory else ["format", "MB", *(f"{peer}: read / write" for peer in PEERS)]
    print(f"| {' | '.join(heading)} |\n{'|---' * len(heading)}|")
    trial = Trial(args.runs, time.process_time if args.cpu else time.perf_counter)
    count = args.triangles
    for row in memory(args.formats, count) if args.memory else rows(args.formats, count, trial):
        print(f"| {' | '.join(row)} |", flush=True)


if __name__ == "__main__":
    main()
