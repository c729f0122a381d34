"""A torus beside algebraic-contours. Run `python benchmarks/algebraic_contours.py PORT`.

PORT is a checkout of pyalgcon, the Python port of algebraic-contours (Capouellez, Dai, Hertzmann, Zorin: *Algebraic
smooth occluding contours*, 2023), whose own packages have to be installed. It is given what it needs at its best: the
conformal map of the torus, which is known, without cones. Its linear systems are solved by SciPy's sparse LU, for its
own Cholesky solver has to be compiled. Distances are those to the true torus, in diagonals.
"""

from __future__ import annotations

import argparse
import enum
import sys
import time
import types
from pathlib import Path

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.linalg import splu

from orbiframe import fit

BIG, SMALL = 1.0, 0.4
SIZES = ((24, 12), (48, 24))


class _Kind(enum.Enum):
    CSC, CSR, COO = range(3)


class _Solver:
    """What the port asks of its Cholesky solver; unknowns in no equation are nought."""

    def __init__(self, n: int, starts: NDArray, columns: NDArray, values: NDArray, _: _Kind) -> None:
        matrix = sp.csr_matrix((values, columns, starts), shape=(n, n))
        unused = np.asarray(abs(matrix).sum(axis=1)).ravel() == 0
        self._factor = splu((matrix + sp.diags(unused.astype(float))).tocsc())

    def solve(self, right: NDArray, found: NDArray) -> None:
        """The solution, written into `found`."""
        found[...] = self._factor.solve(right)


def torus(along: int, across: int) -> tuple[NDArray, NDArray, NDArray]:
    """Vertices, and faces by numbers of the (along, across) grid and of the grid cut open."""
    i, j = (each.ravel() for each in np.meshgrid(np.arange(along), np.arange(across), indexing="ij"))
    u, v = 2 * np.pi * i / along, 2 * np.pi * j / across
    far = BIG + SMALL * np.cos(v)
    vertices = np.stack([far * np.cos(u), far * np.sin(u), SMALL * np.sin(v)], axis=1)
    square = [(0, 0), (1, 0), (1, 1), (0, 0), (1, 1), (0, 1)]
    closed = [(i + a) % along * across + (j + b) % across for a, b in square]
    opened = [(i + a) * (across + 1) + j + b for a, b in square]
    return vertices, *(np.stack(each, axis=1).reshape(-1, 3) for each in (closed, opened))


def conformal(along: int, across: int) -> NDArray:
    """The torus cut open in the plane, without distortion of angles: dy = r dv / (R + r cos v)."""
    fine = np.linspace(0, 2 * np.pi, 20001)
    slope = SMALL / (BIG + SMALL * np.cos((fine[1:] + fine[:-1]) / 2))
    y = np.concatenate([[0], np.cumsum(slope * np.diff(fine))])
    i, j = np.meshgrid(np.arange(along + 1), np.arange(across + 1), indexing="ij")
    return np.stack([2 * np.pi * i / along, np.interp(2 * np.pi * j / across, fine, y)], axis=2).reshape(-1, 2)


def said(name: str, points: NDArray, vertices: NDArray, start: float) -> None:
    """Print the distance of points to the torus."""
    away = np.abs(np.hypot(np.hypot(points[:, 0], points[:, 1]) - BIG, points[:, 2]) - SMALL)
    away /= np.linalg.norm(np.ptp(vertices, axis=0))
    seconds = time.process_time() - start
    print(f"{name:30s} rms {np.sqrt((away**2).mean()):.1e}  max {away.max():.1e}  {seconds:5.1f} s of processor")


def theirs(along: int, across: int) -> None:
    """The surface of the port, at five points of every patch."""
    from pyalgcon.core.affine_manifold import AffineManifold
    from pyalgcon.quadratic_spline_surface.optimize_spline_surface import OptimizationParameters
    from pyalgcon.quadratic_spline_surface.twelve_split_spline import TwelveSplitSplineSurface

    vertices, faces, opened = torus(along, across)
    start = time.process_time()
    manifold = AffineManifold(faces, conformal(along, across), opened)
    surface = TwelveSplitSplineSurface(vertices, manifold, OptimizationParameters())
    weights = np.array([[1 / 3, 1 / 3], [0.1, 0.1], [0.8, 0.1], [0.1, 0.8], [0.5, 0.25]])
    weights = np.column_stack([1 - weights.sum(axis=1), weights])
    patches = map(surface.get_patch, range(surface.num_patches))
    points = [np.ravel(each.evaluate(at)) for each in patches for at in weights @ np.array(each.domain.vertices)]
    said("algebraic-contours", np.array(points), vertices, start)


def ours(along: int, across: int, basis: str) -> None:
    """The default of so many functions of a basis, at the vertices of its output."""
    vertices, faces, _ = torus(along, across)
    start = time.process_time()
    found = fit((vertices, faces), basis=basis)
    said(f"orbiframe, {len(found.surface.coefficients)} of {basis}", found.output.vertices, vertices, start)


def main() -> None:
    """All sizes."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("port", type=Path, help="checkout of pyalgcon")
    sources = parser.parse_args().port / "src"
    if not (sources / "pyalgcon").is_dir():
        parser.error(f"there is no package pyalgcon in {sources}; give a checkout of it")
    sys.path.insert(0, str(sources))
    sys.modules["cholespy"] = types.ModuleType("cholespy")
    vars(sys.modules["cholespy"]).update(CholeskySolverD=_Solver, MatrixType=_Kind)
    for size in SIZES:
        print("torus of {} x {} vertices".format(*size))
        theirs(*size)
        for basis in ("gaussian", "ps6", "ps2"):
            ours(*size, basis)


if __name__ == "__main__":
    main()
