"""The map of a mesh to X/H, step by step and beside its peers: `python benchmarks/map.py`.

Seconds of one processor core with all code loaded, on plates with holes, of genus 2 and 20, with vertices moved a
little. libigl maps the same mesh, cut open along the loops of its marking, to a disc: one linear system
with the boundary held, no group and no metric to be found. `--growth` maps meshes of 10,000 to 500,000 vertices, each
in a process of its own, and draws the picture of the times.
"""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import argparse
import resource
import sys
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from orbiframe_geometries.h2 import H2
from orbiframe_groups.regular_polygon import regular_polygon_group
from orbiframe_markers.tree_cotree import tree_cotree
from orbiframe_parametrizers.circle_packing import packed
from orbiframe_parametrizers.developing import developed
from orbiframe_parametrizers.edge_weights import mean_value
from orbiframe_parametrizers.elimination import Elimination, factorised
from orbiframe_parametrizers.embedding import embedded
from orbiframe_parametrizers.equivariant import equivariant
from orbiframe_parametrizers.harmonic import harmonic
from orbiframe_parametrizers.vertex_scaling import scaled
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.sparse.linalg import splu

from orbiframe import Marking, Polyhedron, Triangulation, surface_type
from orbiframe.groups import MarkedGroup
from orbiframe.meshes.face_diagonals import triangulated

sys.path.insert(0, str(Path(__file__).parents[1] / "datasets"))
import make

HOLES = {2: (2, 1), 20: (5, 4)}
SIZES = (10_000, 30_000, 100_000, 200_000, 500_000)
PICTURE = Path(__file__).parents[1] / "docs" / "pictures" / "map_growth.png"


def plate(genus: int, count: int) -> Polyhedron:
    """A plate with so many holes and about so many vertices, each moved by a twentieth of an edge."""
    across, along = HOLES[genus]
    holes = [(2 * i + 1, 2 * j + 1) for i in range(across) for j in range(along)]
    size = 2 * across + 1, 2 * along + 1
    squares = len(make.plate(*size, holes)[1])
    fine = triangulated(Polyhedron.from_faces(*make.plate(*size, holes, parts=round(np.sqrt(count / squares)))))
    noise = np.random.default_rng(0).normal(size=fine.vertices.shape) * fine.edge_lengths.mean() / 20
    return fine.with_vertices(fine.vertices + noise)


def seconds(action: Callable[[], Any]) -> tuple[float, Any]:
    """Processor seconds of an action, and its result."""
    start = time.process_time()
    result = action()
    return time.process_time() - start, result


def steps(mesh: Polyhedron) -> Iterator[tuple[str, float]]:
    """The steps of the map, each with its seconds."""
    plane, surface = H2(), surface_type(mesh)
    spent, packing = seconds(lambda: packed(mesh, -1))
    yield "circle packing, with the order of elimination", spent
    lengths, angles = packing.lengths, packing.angles
    spent, layout = seconds(lambda: developed(mesh, plane, lengths, angles, surface=surface, patch_radius=1.0))
    yield "atlas", spent
    spent, made = seconds(lambda: embedded(layout, "auto"))
    yield "harmonic map", spent
    require_right(made)
    yield "vertex scaling, with its own order", seconds(lambda: scaled(mesh))[0]
    mesh = fresh(mesh)
    spent, made = seconds(lambda: harmonic(mesh, plane))
    yield "whole map, default", spent
    require_right(made)
    mesh = fresh(mesh)
    spent, marking = seconds(lambda: tree_cotree(mesh))
    yield "marking", spent
    group = MarkedGroup(regular_polygon_group(plane, marking.word), marking, "regular-polygon")
    spent, made = seconds(lambda: equivariant(mesh, plane, group))
    yield "map to the regular polygon's group", spent
    require_right(made)
    yield from peers(mesh, marking)


def fresh(mesh: Polyhedron) -> Polyhedron:
    """The same mesh, of which nothing is known yet."""
    return Polyhedron(mesh.vertices, mesh.offsets, mesh.tail, mesh.twin, mesh.same)


def require_right(made: Triangulation) -> None:
    """A map with a fold or an open relation has no time."""
    assert made.not_positive == 0
    assert made.relation_defect < 1e-12
    assert made.area_defect < 1e-9


def peers(mesh: Polyhedron, marking: Marking) -> Iterator[tuple[str, float]]:
    """Factors of one matrix in two orders, and the map of the disc by libigl."""
    mesh, once = fresh(mesh), mesh.representative
    weights, ends = mean_value(mesh)[once], (mesh.tail[once], mesh.head[once])
    diagonal = np.bincount(np.concatenate(ends), weights=np.tile(weights, 2)) * (1 + 1e-6)
    yield (
        "order and factors of one matrix",
        seconds(lambda: factorised(Elimination.of(mesh).matrix(*ends, -weights, diagonal)))[0],
    )
    every = np.arange(len(mesh.vertices))
    plain = Elimination(every, every).matrix(*ends, -weights, diagonal)
    yield "the same, scipy's `splu` with its default order", seconds(lambda: splu(plain))[0]
    points, triangles = cut_open(mesh, marking)
    yield "libigl's `harmonic` on the disc", seconds(lambda: disc_map(points, triangles))[0]


def cut_open(mesh: Polyhedron, marking: Marking) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """The vertices and triangles of the disc that is left when the mesh is cut along all loops of its marking."""
    ends = np.concatenate([np.stack([loop[:-1], loop[1:]], axis=1) for loop in marking.loops])
    count = len(mesh.vertices)
    cut = np.unique(ends.min(axis=1) * count + ends.max(axis=1))
    whole = np.flatnonzero(~np.isin(np.minimum(mesh.tail, mesh.head) * count + np.maximum(mesh.tail, mesh.head), cut))
    # Across an edge that is not cut the corners at its two ends are the same.
    graph = coo_array((np.ones(len(whole)), (whole, mesh.next[mesh.twin[whole]])), shape=(len(mesh.tail),) * 2)
    corner = connected_components(graph.tocsr(), directed=False)[1]
    points = np.empty((corner.max() + 1, 3))
    points[corner] = mesh.vertices[mesh.tail]
    return points, corner.reshape(-1, 3).astype(np.int64)


def disc_map(points: NDArray[np.float64], triangles: NDArray[np.int64]) -> NDArray[np.float64]:
    """The harmonic map of a disc to the unit disc."""
    import igl

    boundary = igl.boundary_loop(triangles)
    circle = igl.map_vertices_to_circle(points, boundary)
    flat = np.asarray(igl.harmonic(points, triangles, boundary, circle, 1))
    assert np.isfinite(flat).all()
    return flat


def growth(genus: int, count: int) -> tuple[int, float, float]:
    """Vertices, seconds and gigabytes of the whole map of one mesh; for a process of its own."""
    harmonic(plate(genus, 3000), H2())
    mesh = plate(genus, count)
    spent, made = seconds(lambda: harmonic(mesh, H2()))
    require_right(made)
    return len(mesh.vertices), spent, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024 / 1e9


def picture(times: dict[int, list[tuple[int, float, float]]]) -> None:
    """Seconds against vertices on two logarithmic axes, with the slope 3/2."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(figsize=(5, 3.6), layout="constrained")
    for genus, rows in times.items():
        axes.loglog([row[0] for row in rows], [row[1] for row in rows], "o-", label=f"genus {genus}")
    first, last = times[2][0], times[2][-1]
    axes.loglog(
        [first[0], last[0]], [first[1], first[1] * (last[0] / first[0]) ** 1.5], "--", color="grey", label=r"$n^{1.5}$"
    )
    axes.set(xlabel="vertices", ylabel="seconds")
    axes.grid(alpha=0.3, which="both")
    axes.legend()
    figure.savefig(PICTURE, dpi=90)


def exponent(rows: list[tuple[int, float, float]]) -> float:
    """The slope of the line through the logarithms."""
    return float(np.polyfit(np.log([row[0] for row in rows]), np.log([row[1] for row in rows]), 1)[0])


def print_steps(count: int) -> None:
    """The table of the steps."""
    columns = []
    for genus in HOLES:
        list(steps(plate(genus, 3000)))
        mesh = plate(genus, count)
        columns.append((f"genus {genus}, {len(mesh.vertices):,} vertices", list(steps(mesh))))
    print(f"| seconds | {' | '.join(name for name, _ in columns)} |\n|---|{'---|' * len(columns)}")
    for row in zip(*(values for _, values in columns), strict=True):
        print(f"| {row[0][0]} | {' | '.join(f'{value:.2f}' for _, value in row)} |")


def print_growth(sizes: list[int]) -> None:
    """The table of the growth, and its picture."""
    times: dict[int, list[tuple[int, float, float]]] = {}
    print("| genus | vertices | seconds | gigabytes |\n|---|---|---|---|")
    for genus in HOLES:
        for count in sizes:
            with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
                row = pool.submit(growth, genus, count).result()
            times.setdefault(genus, []).append(row)
            print(f"| {genus} | {row[0]:,} | {row[1]:.1f} | {row[2]:.1f} |", flush=True)
    print("\nExponents:", ", ".join(f"{exponent(rows):.2f} for genus {genus}" for genus, rows in times.items()))
    picture(times)


def main() -> None:
    """Print the table asked for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--vertices", type=int, default=100_000)
    parser.add_argument("--growth", action="store_true")
    parser.add_argument("--sizes", type=int, nargs="+", default=list(SIZES))
    args = parser.parse_args()
    print_growth(args.sizes) if args.growth else print_steps(args.vertices)


if __name__ == "__main__":
    main()
