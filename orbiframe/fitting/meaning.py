"""Meaning: what a mesh stands for, its facets, a smooth shape, or some of both."""

from __future__ import annotations

from typing import NamedTuple

from orbiframe.functions.samples import Samples, coordinate_samples
from orbiframe.functions.smooth_samples import semi_smooth_samples, vertex_samples
from orbiframe.meshes.bending import bending
from orbiframe.meshes.bisection import Bisection
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.meshes.sizes import vector_areas
from orbiframe.triangulations.triangulation import Triangulation

SMOOTH, SEMI_SMOOTH, FACETS = "smooth", "semi-smooth", "facets"
MEANINGS = ("auto", SMOOTH, SEMI_SMOOTH, FACETS)

# Up to this share of its bending in sharp edges a mesh is taken for smooth, from the other one on for its facets.
_SMOOTH, _SHARP = 0.20, 0.45
# So many samples of facets are enough; a mesh of needles would have many more than functions can tell apart.
_LEAST_SAMPLES, _SAMPLES_PER_FUNCTION = 250_000, 100


class Meaning(NamedTuple):
    """What a mesh is taken for, the share of its bending in edges of more than 40 degrees, and why, in words."""

    name: str
    bend_share: float
    reason: str

    @property
    def smooth(self) -> bool:
        """Whether the vertices alone are the truth."""
        return self.name == SMOOTH

    def samples(
        self, triangulation: Triangulation, refinement: Bisection, size: int, noise: float | None = None
    ) -> Samples:
        """What is approximated, by so many functions; noise: the rms error of a coordinate of a vertex, if known."""
        if self.name == FACETS:
            return coordinate_samples(triangulation, max(_LEAST_SAMPLES, _SAMPLES_PER_FUNCTION * size))
        if self.name == SMOOTH:
            return vertex_samples(triangulation, refinement, noise)
        area = vector_areas(refinement.coarse)
        return semi_smooth_samples(triangulation, refinement, float(((area**2).sum(axis=1) ** 0.5).sum() / size) ** 0.5)


def meaning_of(mesh: Polyhedron, asked: str, size: int) -> Meaning:
    """What a triangle mesh stands for, as asked or found from the bends of its edges.

    size: the number of functions; where it is less than that of the vertices, those say where the facets are.
    """
    share = bending(mesh).share
    if asked != "auto":
        return Meaning(asked, share, "as asked")
    percent = f"{100 * share:.0f} % of its bending lies in edges of more than 40°"
    if share <= _SMOOTH:
        return Meaning(SMOOTH, share, percent)
    if share >= _SHARP:
        return Meaning(FACETS, share, percent)
    if len(mesh.vertices) > size:
        return Meaning(FACETS, share, f"{percent}, and it has more vertices than there are functions")
    return Meaning(SEMI_SMOOTH, share, percent)
