"""Claims of speed about fits, fields and the start of a command."""

from __future__ import annotations

import subprocess
import sys
from functools import cache, partial

import map as maps
import numpy as np
from claim import Action, Claim
from numpy.typing import NDArray
from orbiframe_fitters.coupled import KIND, PackedBlocks, nearly_solved
from orbiframe_fitters.normal_equations import solved
from scipy.interpolate import RBFInterpolator

from orbiframe import OrbifoldSurface, Polyhedron, fit
from orbiframe.meshes.triangle_boxes import _turned

Floats = NDArray[np.float64]

_SIZE = "[size and fairing](../how_to/choose_size_and_fairing.md)"


@cache
def mesh() -> Polyhedron:
    """A plate of genus 2 and some 30,000 vertices."""
    return maps.plate(2, 30_000)


@cache
def surface() -> OrbifoldSurface:
    """A linear fit of it."""
    return fit(mesh(), size=500, fast=True, progress=False).surface


def boxes() -> tuple[Action, Action]:
    """Boxes turned along triangles, by compiled code and by numpy's eigenvectors."""
    corners = mesh().vertices[mesh().triangles]
    leaves = np.repeat(corners, 4, axis=0).reshape(-1, 12, 3)

    def with_numpy() -> object:
        away = leaves - leaves.mean(axis=1, keepdims=True)
        axes = np.linalg.eigh(np.swapaxes(away, 1, 2) @ away)[1]
        along = leaves @ axes
        return along.min(axis=1), along.max(axis=1)

    return lambda: _turned(leaves), with_numpy


def jets() -> tuple[Action, Action]:
    """Values and derivatives of a surface at points, summed up in one pass, and by sparse matrices."""
    basis, coefficients, points = surface().basis, surface().coefficients, surface().triangulation
    places = points.locate(np.arange(points.polyhedron.face_count), np.full((points.polyhedron.face_count, 3), 1 / 3))
    return (
        lambda: basis.jets(places, coefficients, 2),  # type: ignore[attr-defined]
        lambda: [matrix @ coefficients for matrix in basis.jet_matrices(places, 2)],  # type: ignore[attr-defined]
    )


def packed() -> tuple[Action, Action]:
    """The product of a step of a sliding fit: packed entries, and nine dense blocks."""
    size, rng = 1500, np.random.default_rng(0)
    near = np.abs(np.subtract.outer(np.arange(size), np.arange(size))) < size * 0.06
    upper = np.triu(near)[:, :, None] * rng.standard_normal((size, size, 6))
    matrix, x = PackedBlocks.of(upper, np.zeros((size, size))), rng.standard_normal((size, 3))
    blocks = [[upper[:, :, k] + upper[:, :, k].T for k in line] for line in ((0, 1, 2), (1, 3, 4), (2, 4, 5))]
    return lambda: matrix.image(x), lambda: [sum(block @ x[:, b] for b, block in enumerate(line)) for line in blocks]


def linear() -> tuple[Action, Action]:
    """`--fast` beside the default."""
    return (
        lambda: fit("dataset:plate_genus2", size=500, fast=True, progress=False),
        lambda: fit("dataset:plate_genus2", size=500, progress=False),
    )


def coupled() -> tuple[Action, Action]:
    """The equations of a step of a sliding fit: iterated, and factored as a whole."""
    size, rng = 500, np.random.default_rng(0)
    rows = np.exp(-(np.subtract.outer(np.linspace(0, size, 10 * size), np.arange(size)) ** 2) / 2)
    normals = rng.standard_normal((len(rows), 3))
    upper = np.zeros((size, size, 6))
    for a, line in enumerate(KIND):
        for b in range(a, 3):
            weight = normals[:, a] * normals[:, b] + 0.1 * (a == b)
            upper[:, :, line[b]] = np.triu(rows.T @ (weight[:, None] * rows))
    matrix, right = PackedBlocks.of(upper, np.zeros((size, size))), rng.standard_normal((size, 3))
    full = upper + np.swapaxes(upper, 0, 1)
    full[np.diag_indices(size)] /= 2
    whole = np.block([[full[:, :, kind] for kind in line] for line in KIND])
    return lambda: nearly_solved(matrix, right), lambda: solved(whole, right.T.reshape(-1, 1))


def field() -> tuple[Action, Action]:
    """A field of 2,000 data at 20,000 points of a sphere, and scipy's thin plates there."""
    ball = fit("dataset:sphere", basis="ps6", size=1000, fast=True, progress=False).surface
    there = ball.triangulation.locate(*_anywhere(ball, 20_000))
    data = ball.evaluate(ball.triangulation.locate(*_anywhere(ball, 2_000)))
    wanted = np.sin(3 * data[:, 0]) * data[:, 1]
    found, plates = ball.fit_field(data, wanted), RBFInterpolator(data, wanted, kernel="thin_plate_spline")
    places = ball.evaluate(there)
    return lambda: found.evaluate(there), lambda: plates(places)


def _anywhere(surface: OrbifoldSurface, count: int) -> tuple[NDArray[np.intp], Floats]:
    rng = np.random.default_rng(count)
    return rng.integers(surface.triangulation.polyhedron.face_count, size=count), rng.dirichlet(np.ones(3), count)


_CALL = """
import numpy as np
from orbiframe.compiled import machine_code
{}
from orbiframe.meshes.triangle_boxes import _turned
_turned(np.random.default_rng(0).random((8, 12, 3)))
"""


def start() -> tuple[Action, Action]:
    """A process that imports a kernel and calls it, its code kept: as it is, and with numba."""
    one, other = (_CALL.format(line) for line in ("", "machine_code._TRIED = ('none',)"))
    return partial(_run, one), partial(_run, other)


def _run(program: str) -> None:
    subprocess.run([sys.executable, "-c", program], check=True)


def subdivision() -> tuple[Action, Action]:
    """The default fit, and Loop's subdivision to as many faces by trimesh."""
    import trimesh

    cage = trimesh.Trimesh(*_triangles("dataset:plate_genus2"), process=False)
    return lambda: fit("dataset:plate_genus2", progress=False), lambda: cage.subdivide_loop(4)


def _triangles(name: str) -> tuple[Floats, NDArray[np.intp]]:
    found = fit(name, size=60, fast=True, progress=False).surface.refinement.coarse
    return found.vertices, found.triangles


CLAIMS = (
    Claim("boxes of triangles", "`numpy.linalg.eigh`", 5.0, "decision 45", boxes),
    Claim("derivatives of a surface up to the second", "sparse matrices", 1.2, "changelog", jets),
    Claim("product in a step of a sliding fit", "nine dense blocks", 3.0, "decision 45", packed),
    Claim("equations of a step of a sliding fit, 500 functions", "factors of the whole", 2.0, "changelog", coupled),
    Claim("`--fast`", "the default fit", 2.0, _SIZE, linear),
    Claim("a field at 20,000 points", "scipy's `RBFInterpolator`", 30.0, "[fields](../how_to/fields.md)", field),
    Claim("a first call of kept code, in a new process", "the same by numba", 1.5, "decision 50", start),
    Claim("default fit of a plate with two holes", "Loop's subdivision by trimesh", 0.02, "README", subdivision),
)
