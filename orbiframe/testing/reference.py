"""Reference triangulations of X/H and surfaces on them, made by installed components from the reference polyhedra."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from types import MappingProxyType

import numpy as np

from orbiframe.components.registry import Registry
from orbiframe.functions.basis import Basis
from orbiframe.functions.fitter import Fitter
from orbiframe.functions.samples import coordinate_samples
from orbiframe.groups.group import Group
from orbiframe.meshes.bisection import Bisection
from orbiframe.meshes.face_diagonals import triangulated
from orbiframe.meshes.subdivision import refine
from orbiframe.surfaces.surface import OrbifoldSurface
from orbiframe.testing.polyhedra import reference_polyhedra
from orbiframe.triangulations.triangulation import Triangulation
from orbiframe.words.word import Word

# Geometry and parametrizer for the sign of the Euler characteristic of each polyhedron, and how fine it becomes.
RECIPES = {
    "tetrahedron": ("s2", "sphere", 6),
    "projective plane": ("s2", "sphere", 5),
    "torus": ("e2", "harmonic", 5),
    "Klein bottle": ("e2", "harmonic", 2),
    "double torus": ("h2", "harmonic", 2),
}


@cache
def reference_groups() -> Mapping[str, Group]:
    """Small groups by name, made by installed components: a torus, a Klein bottle, a genus 2, three crosscaps."""
    registry = Registry.discover(only=["geometries", "groups"])
    words = {"torus": "abAB", "Klein bottle": "aabb", "double torus": "abABcdCD", "three crosscaps": "aabbcc"}
    return MappingProxyType({name: _group(Word.parse(text), registry) for name, text in words.items()})


def _group(word: Word, registry: Registry) -> Group:
    name = "regular-polygon" if word.euler_characteristic < 0 else "lattice"
    group: Group = registry.load("group", name)(registry.geometry(word.euler_characteristic), word)
    return group


@cache
def reference_triangulations() -> Mapping[str, Triangulation]:
    """Small triangulations of X/H by name: both kinds of sphere and of plane, and one hyperbolic surface."""
    registry = Registry.discover(only=["geometries", "parametrizers"])
    return MappingProxyType({name: _triangulation(name, registry) for name in RECIPES})


def _triangulation(name: str, registry: Registry) -> Triangulation:
    geometry, parametrizer, density = RECIPES[name]
    mesh = refine(triangulated(reference_polyhedra()[name]), density).polyhedron
    made: Triangulation = registry.load("parametrizer", parametrizer)(mesh, registry.load("geometry", geometry)(), None)
    return made


@cache
def reference_surface(name: str, basis: str, size: int = 30) -> OrbifoldSurface:
    """The reference polyhedron of this name, approximated by functions of an installed basis; shared, so read-only."""
    registry = Registry.discover(only=["bases", "fitters"])
    triangulation = reference_triangulations()[name]
    made: Basis = registry.load("basis", basis)(triangulation.orbifold, triangulation, size=size)
    fitter: Fitter = registry.load("fitter", "least-squares")()
    coefficients = fitter.fit(made, coordinate_samples(triangulation))
    mesh = triangulation.polyhedron
    leaves = np.arange(mesh.face_count)
    return OrbifoldSurface(
        triangulation,
        Bisection(mesh, mesh, np.full_like(leaves, -1), leaves),
        made,
        coefficients,
        np.zeros(3),
        1.0,
        basis,
    )
