"""Lab: what a law gets to try a component on."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.testing.polyhedra import reference_polyhedra

if TYPE_CHECKING:
    from orbiframe.groups.group import Group
    from orbiframe.orbifolds.orbifold import Orbifold
    from orbiframe.surfaces.curved_triangles import CurvedMesh
    from orbiframe.surfaces.surface import OrbifoldSurface
    from orbiframe.triangulations.triangulation import Triangulation


class Untried(Exception):
    """A law cannot be tried on this component; the text says why."""


@dataclass(frozen=True)
class Lab:
    """A fresh folder, random numbers that repeat, and reference objects.

    tmp_path: an empty folder; params: the options that are bound to the component under test; suffix: the file
    suffix to try (of kinds that read or make files); counterpart: the writer for a reader, the reader for a writer,
    None where there is none.
    """

    tmp_path: Path
    params: Mapping[str, object] = field(default_factory=dict)
    suffix: str | None = None
    counterpart: Callable[..., Any] | None = None

    @cached_property
    def rng(self) -> np.random.Generator:
        """A generator of random numbers with a fixed seed; each lab starts it anew."""
        return np.random.default_rng(20071)

    @cached_property
    def polyhedra(self) -> Mapping[str, Polyhedron]:
        """Small closed polyhedra by name: quads and n-gons, an orientable torus, a nonorientable projective plane."""
        return reference_polyhedra()

    @cached_property
    def triangulations(self) -> Mapping[str, Triangulation]:
        """Small triangulations of X/H by name, at least one for each sign of the curvature."""
        from orbiframe.testing.reference import reference_triangulations

        return reference_triangulations()

    @cached_property
    def orbifolds(self) -> Mapping[str, Orbifold]:
        """The surfaces X/H of `triangulations`, by the same names."""
        return {name: triangulation.orbifold for name, triangulation in self.triangulations.items()}

    @cached_property
    def surfaces(self) -> Mapping[str, OrbifoldSurface]:
        """Small surfaces of Powell-Sabin splines of degree 2, which have exact patches, on these triangulations."""
        return {name: self.surface(name, "ps2") for name in self.triangulations}

    @cached_property
    def groups(self) -> Mapping[str, Group]:
        """Small groups with a fundamental polygon by name: flat and hyperbolic ones, one of them nonorientable."""
        from orbiframe.testing.reference import reference_groups

        return reference_groups()

    def surface(self, name: str, basis: str) -> OrbifoldSurface:
        """A small surface on one of the triangulations, of the functions of an installed basis."""
        from orbiframe.testing.reference import reference_surface

        shared = reference_surface(name, basis)
        return replace(shared, coefficients=shared.coefficients.copy())

    def curved_mesh(self, name: str, order: int) -> CurvedMesh:
        """Lagrange triangles of some order on one of the surfaces."""
        from orbiframe.surfaces.curved_triangles import curved_mesh
        from orbiframe.surfaces.geodesic_faces import input_faces

        return curved_mesh(self.surfaces[name], input_faces(self.surfaces[name]), order)
