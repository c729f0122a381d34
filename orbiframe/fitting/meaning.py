"""Meaning: what a mesh stands for, its facets, a smooth shape, or some of both."""

from __future__ import annotations

from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from orbiframe.functions.border_samples import with_border
from orbiframe.functions.samples import Samples, coordinate_samples
from orbiframe.functions.samples_of_sides import crease_samples
from orbiframe.functions.smooth_samples import inside_facets, semi_smooth_samples, vertex_samples
from orbiframe.meshes.bending import SHARP, bending
from orbiframe.meshes.bisection import Bisection
from orbiframe.meshes.even_bends import even_share
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.meshes.sizes import vector_areas
from orbiframe.triangulations.triangulation import Triangulation

SMOOTH, SEMI_SMOOTH, FACETS = "smooth", "semi-smooth", "facets"
# Which facets beside creases stand for something curved.
_CURVED: dict[str, Literal["none", "bent", "all"]] = {FACETS: "none", SEMI_SMOOTH: "bent", SMOOTH: "all"}


MEANINGS = ("auto", SMOOTH, SEMI_SMOOTH, FACETS)

# Up to this share of its bending in sharp edges a mesh is taken for smooth, from the other one on for its facets; up to
# the third one where bends between flats of even width are not counted as sharp.
_SMOOTH, _SHARP, _EVEN = 0.20, 0.475, 0.02
# Beside creases nothing bends if no more than this share does.
_FLAT = 1e-6
# Facets no longer than this share of the distance of functions leave no mark in a fit.
_SEEN = 0.3
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

    def less_smooth(self, vertices: int, size: int, stray: float) -> Meaning:
        """What the mesh means where a surface of this meaning leaves a facet by so many of its sizes."""
        name = SEMI_SMOOTH if self.smooth and vertices <= size else FACETS
        return self._replace(
            name=name,
            reason=f"{self.reason}, but as {self.name} the surface leaves a facet by {stray:.1f} times its size",
        )

    def arcs(self, triangulation: Triangulation) -> bool:
        """Whether bent facets stand for arcs over them, and flat ones for themselves."""
        return triangulation.crease is not None and self.name == SEMI_SMOOTH

    def samples(
        self, triangulation: Triangulation, refinement: Bisection, size: int, noise: float | None = None
    ) -> Samples:
        """What is approximated, by so many functions; noise: the rms error of a coordinate of a vertex, if known."""
        area = (vector_areas(refinement.coarse) ** 2).sum(axis=1) ** 0.5
        own = area if triangulation.inside is None else area[inside_facets(triangulation, refinement)]
        spacing = float(own.sum() / size) ** 0.5
        found = self._inside(triangulation, refinement, size, spacing, noise)
        return with_border(found, triangulation, refinement, spacing, arcs=self.name != FACETS)

    def _inside(
        self, triangulation: Triangulation, refinement: Bisection, size: int, spacing: float, noise: float | None
    ) -> Samples:
        """The samples of the mesh without those of its boundary."""
        if triangulation.crease is not None:
            return crease_samples(triangulation, refinement, spacing, curved=_CURVED[self.name])
        if self.name == FACETS:
            return coordinate_samples(triangulation, max(_LEAST_SAMPLES, _SAMPLES_PER_FUNCTION * size))
        if self.name == SMOOTH:
            return vertex_samples(triangulation, refinement, noise)
        return semi_smooth_samples(triangulation, refinement, spacing)


def meaning_of(mesh: Polyhedron, asked: str, size: int, creases: NDArray[np.bool_] | None = None) -> Meaning:
    """What a triangle mesh stands for, as asked or found from the bends of its edges.

    size: the number of functions; where it is less than that of the vertices, those say where the facets are; creases:
    (H,), the edges that stay sharp: then what bends at others is curved.
    """
    bends = bending(mesh)
    share = bends.share
    if asked != "auto":
        return Meaning(asked, share, "as asked")
    if creases is not None:
        return _beside_creases(mesh, share, creases)
    if mesh.edge_lengths @ bends.angle <= _FLAT * mesh.edge_lengths.sum():
        return Meaning(FACETS, share, "it is flat")
    percent = f"{100 * share:.0f} % of its bending lies in edges of more than 40°"
    if share <= _SMOOTH:
        return Meaning(SMOOTH, share, percent)
    if (even := even_share(mesh)) <= _EVEN:
        return Meaning(SMOOTH, share, f"{percent}, but no more than {100 * even:.0f} % between flats of uneven width")
    if share >= _SHARP:
        return Meaning(FACETS, share, percent)
    if len(mesh.vertices) > size:
        return Meaning(FACETS, share, f"{percent}, and it has more vertices than there are functions")
    return Meaning(SEMI_SMOOTH, share, percent)


def facets_show(mesh: Polyhedron, size: int) -> bool:
    """Whether the facets of a mesh are so long that so many functions would see them: their edges, mean on the area."""
    square = mesh.edge_lengths**2
    area = float(np.linalg.norm(vector_areas(mesh), axis=1).sum())
    return float(square @ square) > _SEEN**2 * area / size * float(square.sum())


def _beside_creases(mesh: Polyhedron, share: float, creases: NDArray[np.bool_]) -> Meaning:
    """Facets where little bends but creases and other sharp edges; otherwise what bends is curved, the rest is flat."""
    angle = bending(mesh).angle
    amount = mesh.edge_lengths * angle
    total, rest = float(amount.sum()), float(amount[~creases].sum())
    reason = f"{100 * (1 - rest / max(total, 1e-300)):.0f} % of its bending lies in creases"
    if rest <= _FLAT * total:
        return Meaning(FACETS, share, reason)
    sharp = float(amount[~creases & (angle > SHARP)].sum()) / rest
    if sharp >= _SHARP:
        return Meaning(FACETS, share, f"{reason}, and {100 * sharp:.0f} % of the rest in other edges of more than 40°")
    return Meaning(SEMI_SMOOTH, share, reason)
