"""The map to X/H of shapes that are hard to map: `python benchmarks/hard_shapes.py [NAME …]`, one line of a table each.

Each mesh is refined as it is for a fit, to about 3000 vertices; `--plain` maps it as it is. NAME: only the shapes that
have one of the names in theirs.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

import hard_surfaces as hard
from signed_faces import WORDS, fan, wandering

from orbiframe import Polyhedron, Triangulation
from orbiframe.components.registry import Registry
from orbiframe.errors import OrbiframeError
from orbiframe.fitting.mapping import PARAMETRIZER
from orbiframe.meshes.bisection import bisected, edge_length_for
from orbiframe.meshes.face_diagonals import triangulated
from orbiframe.meshes.flat_flips import flat_flips
from orbiframe.meshes.subdivision import refine
from orbiframe.meshes.surface_type import surface_type
from orbiframe.triangulations.lost_digits import crowding_of

REGISTRY = Registry.discover()
GENERA = (*range(21), 50, 100, 133)


def shapes() -> Iterator[tuple[str, Callable[[], Polyhedron]]]:
    """The name of every shape, and what makes it."""
    for genus in GENERA:
        yield f"genus {genus}", lambda genus=genus: hard.handles(genus, 3 if genus < 50 else 2)
    for p, genus in ((7, 3), (13, 14), (29, 146)):
        yield f"Hurwitz surface of genus {genus}, random vertices", lambda p=p: hard.hurwitz(p)
    for count in range(1, 21):
        yield f"{count} crosscaps, random vertices", lambda count=count: hard.crosscaps(count, 3)
    two = hard.plate_cells(1, 2)
    for ratio in (5, 10, 20, 30, 35, 40, 60, 80):
        yield f"genus 2, finger of length {ratio} radii", lambda r=ratio: hard.with_finger(two, (0, 0, 0), r)
    one = hard.plate_cells(1, 1)
    for ratio in (10, 20, 30, 40, 60, 80):
        yield f"torus, finger of length {ratio} radii", lambda r=ratio: hard.with_finger(one, (0, 0, 0), r)
        yield f"sphere, finger of length {ratio} radii", lambda r=ratio: hard.with_finger(_slab(), (0, 0, 0), r)
    for kind, make in _bases().items():
        yield f"{kind}, slivers of 0.05 degrees", lambda m=make: hard.with_slivers(m(), 0.2, 1e-3, 3)
        yield f"{kind}, slivers of 1e-6 degrees", lambda m=make: hard.with_slivers(m(), 0.2, 2e-8, 2)
        yield f"{kind}, needles 1e4 : 1", lambda m=make: hard.stretched(m(), 1e4, 1, 1)
        yield f"{kind}, valence 1000", lambda m=make: hard.with_fan(m(), 5, 1000)
        yield f"{kind}, half the vertices of valence 3", lambda m=make: hard.with_many_of_valence_three(m(), 3)
        yield f"{kind}, hexagons with vertices of valence 2", lambda m=make: triangulated(hard.with_notched_edges(m()))
        yield f"{kind}, thickness 1e-4", lambda m=make: hard.stretched(m(), 1, 1, 1e-4)
    for name, word in WORDS.items():
        yield f"{name}, random cells, loops and all", lambda w=word: wandering(w, 1, 150).polyhedron()
    for name in ("torus", "Klein bottle", "genus 2", "genus 3", "3 crosscaps"):
        yield f"{name}, edges that share both ends", lambda n=name: _quartered_fan(WORDS[n])


def _slab() -> set[hard.Cell]:
    return {(i, j, 0) for i in range(3) for j in range(3)}


def _bases() -> dict[str, Callable[[], Polyhedron]]:
    return {
        "sphere": lambda: hard.voxels(_slab(), 3),
        "projective plane": lambda: hard.crosscaps(1, 6),
        "torus": lambda: hard.plate(1, 1, 3),
        "Klein bottle": lambda: hard.crosscaps(2, 5),
        "genus 2": lambda: hard.plate(1, 2, 3),
        "genus 20": lambda: hard.plate(4, 5, 2),
        "4 crosscaps": lambda: hard.crosscaps(4, 4),
    }


def _quartered_fan(word: str) -> Polyhedron:
    """A triangulation with one vertex, every triangle cut in four, its vertices anywhere."""
    mesh = refine(fan(word).polyhedron(), 2).polyhedron
    return mesh.with_vertices(np.random.default_rng(3).normal(size=mesh.vertices.shape))


def refined(mesh: Polyhedron) -> Polyhedron:
    """The mesh refined as for a fit by few functions."""
    flips = flat_flips(mesh)
    return bisected(mesh, edge_length_for(flips.after, 3000), True, flips).polyhedron


def mapped(mesh: Polyhedron) -> Triangulation:
    """The map of a mesh by the component that a fit would take."""
    geometry = REGISTRY.geometry(surface_type(mesh).euler_characteristic)
    return REGISTRY.load("parametrizer", PARAMETRIZER[geometry.name])(mesh, geometry, None)


def row(mesh: Polyhedron, plain: bool) -> str:
    """What the map of a mesh is like, or why there is none."""
    try:
        fine = mesh if plain else refined(mesh)
        start = time.perf_counter()
        found = mapped(fine)
    except OrbiframeError as error:
        return f"{len(mesh.vertices)} | refused: {error} | | | | | | "
    seconds = time.perf_counter() - start
    crowded = crowding_of(found)
    return (
        f"{len(found.points)} | {found.not_positive} | {found.relation_defect:.0e} | {found.area_defect:.0e} | "
        f"{np.median(found.angle_distortion):.2f} | {crowded.area_ratio:.0e} | {crowded.digits_lost:.0f} | "
        f"{found.group}, {found.weights} | {seconds:.1f}"
    )


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", help="only shapes with one of these in their name")
    parser.add_argument("--plain", action="store_true", help="without refinement")
    args = parser.parse_args()
    print("| shape | vertices | not positive | relations | area | distortion | smallest | lost | map | seconds |")
    print("|---|---|---|---|---|---|---|---|---|---|")
    for name, make in shapes():
        if not args.names or any(part in name for part in args.names):
            print(f"| {name} | {row(make(), args.plain)} |", flush=True)


if __name__ == "__main__":
    main()
