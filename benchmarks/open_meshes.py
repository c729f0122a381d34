"""Open meshes: how near surfaces with a boundary are to their meshes; `python benchmarks/open_meshes.py [SIZE] [DATA]`.

Fits the shapes of `open_shapes` with SIZE functions (600) with each way to close them and prints, in diagonals of the
box: the error inside and on the boundary (root mean square and maximum), the least area element at the boundary against
that of the mesh (1 as on the mesh, 0 folded), the share that folds, what Gauss and Bonnet's sum lacks to 2 pi chi, and
the seconds. DATA: what the meshes mean, by default facets, where errors are both ways to the polygons themselves; auto
takes these shapes for smooth, and errors are those of the vertices.
"""

from __future__ import annotations

import sys
import time

import numpy as np
from open_shapes import SHAPES

from orbiframe import fit

WAYS = ("auto", "cap", "collar", "double")


def row(name: str, way: str, size: int, data: str) -> str:
    """A line of the table."""
    start = time.perf_counter()
    found = fit(SHAPES[name](), size=size, data=data, boundary=way, progress=False)
    seconds = time.perf_counter() - start
    report, surface = found.report, found.surface
    border, inside = report["boundary"], report["fit"]
    chi = report["surface"]["euler_characteristic"]
    defect = surface.total_curvature() + surface.boundary_turning() - 2 * np.pi * chi
    closed = f"{way} ({border['closed_by']})" if way == "auto" else way
    return (
        f"{name:26}{closed:16}{inside['rms']:9.1e}{inside['max']:9.1e}{border['rms']:9.1e}{border['max']:9.1e}"
        f"{border['least_element']:6.2f}{report['shape']['folded_share']:9.1e}{defect:9.1e}{seconds:7.1f}"
    )


def main() -> None:
    """Print the table."""
    size = int(sys.argv[1]) if len(sys.argv) > 1 else 600
    data = sys.argv[2] if len(sys.argv) > 2 else "facets"
    print(f"{size} functions, {data}")
    head = ("inside", "max", "boundary", "max")
    print(f"{'shape':26}{'closed by':16}" + "".join(f"{name:>9}" for name in head) + "  least  folded  G.-B.  seconds")
    for name in SHAPES:
        for way in WAYS:
            print(row(name, way, size, data), flush=True)


if __name__ == "__main__":
    main()
