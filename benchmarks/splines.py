"""The claims of the bases, measured: `python benchmarks/splines.py`, tables in Markdown.

Every family approximates one smooth function on a sphere, a torus and a surface of genus 2, with about 250, 1000 and
4000 functions: errors, the order of convergence, the condition of the equations, how well 1 is reproduced; `--picture
FILE` draws the errors. `--claims` counts functions and measures jumps and reproduction on small triangulations of eight
surfaces instead; `--speed` times evaluation on one core beside SciPy's interpolators in the plane, all in one run.
"""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import argparse
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_array, csr_array, diags_array
from scipy.sparse.linalg import splu
from spline_claims import show_claims
from spline_speed import show_speed

from orbiframe import Basis, Points, Registry, Triangulation
from orbiframe.errors import OrbiframeError
from orbiframe.files.gate import read
from orbiframe.functions.lifted_centres import LiftedCentres
from orbiframe.functions.orbit_sum import in_blocks
from orbiframe.meshes.face_diagonals import triangulated
from orbiframe.meshes.orientation import oriented
from orbiframe.meshes.subdivision import refine
from orbiframe.planes import triangle_points

Floats = NDArray[np.float64]

DATASETS = Path(__file__).parents[1] / "datasets"
SURFACES = {"sphere": ("sphere.off", "s2", "sphere"), "torus": ("torus.off", "e2", "harmonic")}
SURFACES["genus 2"] = ("plate_genus2.off", "h2", "harmonic")
FAMILIES: dict[str, tuple[str, dict[str, Any]]] = {
    "bernstein, degree 2": ("bernstein", {"degree": 2}),
    "bernstein, degree 3": ("bernstein", {"degree": 3}),
    "bernstein, degree 4": ("bernstein", {"degree": 4}),
    "ps2": ("ps2", {}),
    "ps3": ("ps3", {}),
    "ps4": ("ps4", {}),
    "ps5": ("ps5", {}),
    "ps6": ("ps6", {}),
    "clough-tocher": ("clough-tocher", {}),
    "argyris, degree 5": ("argyris", {"degree": 5}),
    "argyris, degree 6": ("argyris", {"degree": 6}),
    "zenisek": ("zenisek", {}),
    "hybrid": ("hybrid", {}),
    "simplex": ("simplex", {}),
    "dms": ("dms", {}),
    "tensor-bspline": ("tensor-bspline", {}),
    "wendland": ("wendland", {}),
    "gaussian": ("gaussian", {}),
    "gaussian, width 1.7": ("gaussian", {"width": 1.7}),
}
SIZES = (250, 1000, 4000)
PICTURED = ["bernstein, degree 2", "bernstein, degree 4", "ps2", "ps4", "ps6", "clough-tocher", "argyris, degree 6"]
PICTURED += ["zenisek", "dms", "tensor-bspline", "gaussian", "gaussian, width 1.7"]


class Problem(NamedTuple):
    """A map, points and weights on X/H that integrate, and a smooth function at the points."""

    triangulation: Triangulation
    points: Points
    weights: Floats
    values: Floats


def problem(name: str, registry: Registry, density: int) -> Problem:
    """The sum of two bumps exp(-c / w) of the versine c, summed over the group, about two vertices of the mesh."""
    file, geometry, parametrizer = SURFACES[name]
    mesh = refine(triangulated(oriented(read(DATASETS / file, registry))), density).polyhedron
    made = registry.load("parametrizer", parametrizer)(mesh, registry.load("geometry", geometry)(), None)
    x, weights = triangle_points(made.orbifold.geometry, made.lifts, 3)
    patch = np.repeat(made.patch[mesh.triangles[:, 0]], x.shape[1])
    points = Points(patch, x.reshape(-1, 3))
    return Problem(made, points, np.abs(weights).ravel(), bumps(made, points))


def bumps(made: Triangulation, points: Points) -> Floats:
    """Two bumps whose width is a fixed part of the surface, far from any vertex of a spline domain on purpose."""
    centre = np.array([0, len(made.patch) // 2])
    width = made.orbifold.area / 60
    support = np.full(2, 36 * width if made.orbifold.geometry.curvature < 1 else 2.0)
    values = np.zeros(len(points.patch))
    centres = Points(made.patch[centre], made.points[centre])
    for pairs in in_blocks(LiftedCentres(made.orbifold, centres, support), points, lambda pairs: pairs):
        heights = np.exp(-pairs.versine / width) * (1 + 0.5 * pairs.column)
        values[pairs.rows] = np.add.reduceat(np.append(heights, 0.0), pairs.start[:-1]) * (np.diff(pairs.start) > 0)
    return values


class Outcome(NamedTuple):
    """A basis with the relative error of its projection in the mean square, and the condition of its equations."""

    basis: Basis
    error: float
    condition: float


def projected(basis: Basis, task: Problem) -> Outcome:
    """The least squares approximation at the points of the quadrature, which stands for the projection in L2."""
    matrix = basis.design_matrix(task.points)
    weighted = diags_array(task.weights) @ matrix
    gram = csr_array(matrix.T @ weighted)
    scale = 1 / np.sqrt(np.maximum(gram.diagonal(), np.finfo(float).tiny))
    scaled = csc_array(diags_array(scale) @ gram @ diags_array(scale))
    damped = csc_array(scaled + 1e-13 * diags_array(np.ones(basis.size)))
    factor = splu(damped, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    right = scale * (weighted.T @ task.values)
    solution = factor.solve(right)
    solution += factor.solve(right - scaled @ solution)
    gap = matrix @ (scale * solution) - task.values
    error = np.sqrt(task.weights @ gap**2 / (task.weights @ task.values**2))
    return Outcome(basis, float(error), _condition(scaled) if basis.size <= 1500 else np.nan)


def _condition(scaled: csc_array) -> float:
    values = np.linalg.eigvalsh(scaled.toarray())
    return float(values[-1] / values[0]) if values[0] > 0 else np.inf


def constants(basis: Basis, task: Problem) -> float:
    """How far the nearest function is from 1, in the mean square."""
    ones = task._replace(values=np.ones(len(task.weights)))
    return projected(basis, ones).error


def accuracy(registry: Registry, surfaces: list[str], density: int) -> Iterator[tuple[str, str, list[Outcome], float]]:
    """Family, surface, outcomes by size, and the error of constants at the middle size."""
    for surface in surfaces:
        task = problem(surface, registry, density)
        for title, (name, options) in FAMILIES.items():
            component = registry.load("basis", name)
            try:
                found = [
                    projected(component(task.triangulation.orbifold, task.triangulation, size=size, **options), task)
                    for size in SIZES
                ]
            except OrbiframeError as error:
                print(f"<!-- {title}, {surface}: {error} -->")
                continue
            yield title, surface, found, constants(found[1].basis, task)


def order(found: list[Outcome]) -> float:
    """The power of the mesh width that the error falls with, from the two finer levels."""
    (n, e), (m, f) = ((o.basis.size, o.error) for o in found[-2:])
    return float(2 * np.log(e / f) / np.log(m / n))


def show_accuracy(registry: Registry, surfaces: list[str], density: int) -> list[tuple[str, str, list[Outcome], float]]:
    """Print the table line by line."""
    print("| surface | basis | smooth | functions: relative error | order | condition | error of 1 |")
    print("|---|---|---|---|---|---|---|")
    rows = []
    for title, surface, found, one in accuracy(registry, surfaces, density):
        rows.append((title, surface, found, one))
        errors = ", ".join(f"{o.basis.size}: {o.error:.1e}" for o in found)
        smooth = "∞" if np.isinf(found[0].basis.smoothness) else str(int(found[0].basis.smoothness))
        numbers = f"{order(found):.1f} | {found[1].condition:.0e} | {one:.0e}"
        print(f"| {surface} | {title} | C{smooth} | {errors} | {numbers} |", flush=True)
    return rows


# ---- picture --------------------------------------------------------------------------------------------------------


def draw(rows: list[tuple[str, str, list[Outcome], float]], path: Path) -> None:
    """Error against number of functions, a panel for each surface."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    surfaces = list(dict.fromkeys(surface for _, surface, _, _ in rows))
    figure, axes = plt.subplots(1, len(surfaces), figsize=(3.6 * len(surfaces) + 1.6, 4.6), sharey=True, squeeze=False)
    for title, surface, found, _ in rows:
        if title in PICTURED:
            k, axis = PICTURED.index(title), axes[0][surfaces.index(surface)]
            sizes, errors = [o.basis.size for o in found], [o.error for o in found]
            axis.loglog(sizes, errors, marker="os^vD*"[k % 6], color=plt.cm.tab20(k), lw=1.2, ms=5, label=title)
    for axis, surface in zip(axes[0], surfaces, strict=True):
        axis.set(title=surface, xlabel="functions", ylim=(1e-10, 0.1))
        axis.set_xticks(SIZES, [str(size) for size in SIZES])
        axis.minorticks_off()
        axis.grid(visible=True, lw=0.3)
    axes[0][0].set_ylabel("relative error")
    handles = {label: h for axis in axes[0] for h, label in zip(*axis.get_legend_handles_labels(), strict=True)}
    axes[0][-1].legend(
        handles.values(), handles.keys(), fontsize=8, loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False
    )
    figure.tight_layout()
    figure.savefig(path, dpi=70)


def main() -> None:
    """What the command line asks for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--surface", choices=SURFACES, action="append", help="one surface; default all")
    parser.add_argument("--density", type=int, default=8, help="refinement of the meshes that carry the maps")
    parser.add_argument("--claims", action="store_true", help="dimensions, jumps and reproduction instead of accuracy")
    parser.add_argument("--speed", action="store_true", help="speed instead of accuracy")
    parser.add_argument("--picture", type=Path, help="draw the errors")
    arguments = parser.parse_args()
    registry = Registry.discover()
    if arguments.claims:
        return show_claims(registry)
    if arguments.speed:
        return show_speed(registry, problem("torus", registry, 4).triangulation)
    rows = show_accuracy(registry, arguments.surface or list(SURFACES), arguments.density)
    if arguments.picture:
        draw(rows, arguments.picture)


if __name__ == "__main__":
    main()
