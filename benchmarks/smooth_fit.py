"""Bases compared on smooth shapes: `python benchmarks/smooth_fit.py`, a table in Markdown.

A chain of two tori and a cross of five, melted together, are level sets of a function that is analytic near them. Their
meshes are surface nets whose vertices are moved onto the level set by Newton's method, to rounding. Every basis has
about 1000 functions and is fitted as `orbiframe fit` does it; the errors are those at the vertices of the mesh: to the
point that belongs to the parameters, and to the level set. Both relative to the diagonal of the bounding box.
"""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import argparse
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from quality.nets import surface_net

from orbiframe import Points, Polyhedron, Registry, Samples, Triangulation
from orbiframe.functions.samples import coordinate_samples
from orbiframe.meshes.bisection import bisected
from orbiframe.meshes.face_diagonals import triangulated
from orbiframe.meshes.orientation import oriented

Floats = NDArray[np.float64]

_BIG, _SMALL, _BLEND, _APART = 1.0, 0.4, 10.0, 2.4
_PAIR = np.array([[-0.5, 0], [0.5, 0]]) * _APART
_CROSS = np.array([[0, 0], [1, 0], [-1, 0], [0, 1], [0, -1]]) * _APART
SHAPES = {"genus 2": (_PAIR, 0.042), "genus 5": (_CROSS, 0.06)}
FAMILIES: dict[str, tuple[str, dict[str, Any]]] = {
    "ps2": ("ps2", {}),
    "ps4": ("ps4", {}),
    "ps6": ("ps6", {}),
    "gaussian": ("gaussian", {}),
    "gaussian, width 1.7": ("gaussian", {"width": 1.7}),
}


def level(centres: Floats, x: Floats) -> tuple[Floats, Floats]:
    """A smooth least distance to tori with these centres in the plane z = 0, and its gradient: (...), (..., 3)."""
    offset = x[..., None, :2] - centres
    radius, height = np.hypot(offset[..., 0], offset[..., 1]), x[..., None, 2]
    distance = np.hypot(radius - _BIG, height)
    share = np.exp(-_BLEND * (distance - _SMALL))
    total = share.sum(axis=-1)
    with np.errstate(invalid="ignore", divide="ignore"):
        flat = offset * ((radius - _BIG) / (radius * distance))[..., None]
        slopes = np.nan_to_num(np.concatenate([flat, (height / distance)[..., None]], axis=-1))
    return -np.log(total) / _BLEND, (share[..., None] * slopes).sum(axis=-2) / total[..., None]


def on_level(centres: Floats, x: Floats, steps: int = 20) -> Floats:
    """Points moved along gradients onto the level set."""
    for _ in range(steps):
        value, slope = level(centres, x)
        x = x - (value / (slope**2).sum(axis=-1))[..., None] * slope
    return x


def net(centres: Floats, step: float) -> Polyhedron:
    """Quadrilaterals about the edges of a grid that cross the level set, with vertices on it."""
    reach = np.append(np.abs(centres).max(axis=0) + _BIG + _SMALL, _SMALL) + 3.4 * step
    made = surface_net(lambda x: level(centres, x)[0], -reach, reach, step)
    return made.with_vertices(on_level(centres, made.vertices))


class Shape(NamedTuple):
    """A smooth shape, its mesh on X/H, the length of its box, and what is fitted."""

    centres: Floats
    triangulation: Triangulation
    diagonal: float
    samples: Samples


def shape(name: str, registry: Registry, exact: bool) -> Shape:
    """exact: the samples inside of triangles are moved onto the level set too."""
    centres, step = SHAPES[name]
    mesh = bisected(triangulated(oriented(net(centres, step))), np.inf, simplicial=True).polyhedron
    mesh = mesh.with_vertices(on_level(centres, mesh.vertices))
    made = registry.load("parametrizer", "harmonic")(mesh, registry.load("geometry", "h2")(), None)
    samples = coordinate_samples(made)
    if exact:
        samples = replace(samples, values=on_level(centres, samples.values))
    return Shape(centres, made, float(np.linalg.norm(np.ptp(mesh.vertices, axis=0))), samples)


def errors(task: Shape, basis: Any, coefficients: Floats) -> tuple[float, float, float]:
    """Root mean square at the vertices, to their places and to the level set, and the largest of the latter."""
    made = task.triangulation
    found = basis.values(Points(made.patch, made.points), coefficients)
    value, slope = level(task.centres, found)
    gap = np.linalg.norm(found - made.polyhedron.vertices, axis=1) / task.diagonal
    away = np.abs(value) / np.linalg.norm(slope, axis=1) / task.diagonal
    return float(np.sqrt((gap**2).mean())), float(np.sqrt((away**2).mean())), float(away.max())


def main() -> None:
    """Print the table line by line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--shape", choices=SHAPES, action="append", help="one shape; default both")
    parser.add_argument("--size", type=int, default=1000, help="functions")
    parser.add_argument("--fairing", type=float, action="append", help="default 0.003 and 0")
    parser.add_argument("--exact", action="store_true", help="samples inside of triangles on the level set too")
    arguments = parser.parse_args()
    registry = Registry.discover()
    print("| shape | basis | functions | fairing | rms | rms to the level set | max to the level set |")
    print("|---|---|---|---|---|---|---|")
    for name in arguments.shape or SHAPES:
        task = shape(name, registry, arguments.exact)
        for title, (family, options) in FAMILIES.items():
            made = task.triangulation
            basis = registry.load("basis", family)(made.orbifold, made, size=arguments.size, **options)
            for fairing in arguments.fairing or (0.003, 0.0):
                fitter = registry.load("fitter", "least-squares")(fairing=fairing)
                found = errors(task, basis, fitter.fit(basis, task.samples))
                numbers = " | ".join(f"{e:.1e}" for e in found)
                print(f"| {name} | {title} | {basis.size} | {fairing:g} | {numbers} |", flush=True)


if __name__ == "__main__":
    main()
