"""Bases compared by what `orbiframe fit` makes with them: `python benchmarks/smooth_fit.py`, tables in Markdown.

A chain of two tori and a cross of five, melted together, are level sets of a function that is analytic near them. Their
meshes are surface nets whose vertices are moved onto the level set by Newton's method, to rounding. Every basis has
about as many functions as is asked for and all else is left alone: the mesh is taken for a smooth one, and samples
slide. The errors are distances of the vertices of a fine mesh on the surface to the level set. With `--plate` the plate
of genus 2 with its edges rounded, and kept. All relative to the diagonal of the bounding box.
"""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import argparse
import time
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray
from quality.nets import surface_net

from orbiframe import Polyhedron, fit

Floats = NDArray[np.float64]

_BIG, _SMALL, _BLEND, _APART = 1.0, 0.4, 10.0, 2.4
_PAIR = np.array([[-0.5, 0], [0.5, 0]]) * _APART
_CROSS = np.array([[0, 0], [1, 0], [-1, 0], [0, 1], [0, -1]]) * _APART
SHAPES = {"genus 2": (_PAIR, 0.042), "genus 5": (_CROSS, 0.06)}
FAMILIES: dict[str, dict[str, Any]] = {
    **{name: {"name": name} for name in ("gaussian", "wendland", "ps2", "ps3", "ps4", "ps6", "clough-tocher")},
    "gaussian, width 1.3": {"name": "gaussian", "width": 1.3},
}
PLATE = {"rounded": ("gaussian", "ps2", "ps4", "ps6", "clough-tocher"), "30": ("clough-tocher", "ps2")}


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


def smooth(name: str, step: float, families: list[str], size: int) -> Iterator[str]:
    """The rows of a smooth shape whose mesh has edges of about this length."""
    centres = SHAPES[name][0]
    mesh = net(centres, step or SHAPES[name][1])
    for family in families:
        started = time.process_time()
        made = fit(mesh, basis={**FAMILIES[family], "size": size}, progress=False)
        seconds = time.process_time() - started
        value, slope = level(centres, made.output.vertices)
        away = np.abs(value) / np.linalg.norm(slope, axis=1) / mesh.diagonal
        found = f"{np.sqrt((away**2).mean()):.1e} | {away.max():.1e} | {seconds:.0f}"
        yield f"| {name} | {len(mesh.vertices)} | {family} | {made.surface.basis.size} | {found} |"


def plate(size: int) -> Iterator[str]:
    """The rows of the plate, whose facets are meant."""
    for creases, families in PLATE.items():
        kept = {} if creases == "rounded" else {"data": {"creases": float(creases)}}
        for family in families:
            started = time.process_time()
            made = fit("dataset:plate_genus2", basis={"name": family, "size": size}, progress=False, **kept)
            seconds = time.process_time() - started
            error = made.report["fit"]
            found = f"{error['rms']:.1e} | {error['max']:.1e} | {seconds:.0f}"
            yield f"| plate, edges {creases} | 198 | {family} | {made.surface.basis.size} | {found} |"


def main() -> None:
    """Print the table line by line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--shape", choices=SHAPES, action="append", help="one shape; default both")
    parser.add_argument("--basis", choices=FAMILIES, action="append", help="one basis; default all")
    parser.add_argument("--size", type=int, default=1000, help="functions")
    parser.add_argument("--step", type=float, default=0.0, help="length of edges; default a fine mesh")
    parser.add_argument("--plate", action="store_true", help="the plate of genus 2 instead")
    arguments = parser.parse_args()
    print("| shape | vertices | basis | functions | rms | max | processor seconds |\n|---|---|---|---|---|---|---|")
    families = arguments.basis or list(FAMILIES)
    rows = (row for name in arguments.shape or SHAPES for row in smooth(name, arguments.step, families, arguments.size))
    for row in plate(arguments.size) if arguments.plate else rows:
        print(row, flush=True)


if __name__ == "__main__":
    main()
