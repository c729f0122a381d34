"""The laws of bases on the surfaces of the datasets, one basis and one surface at a time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache, cached_property, partial
from pathlib import Path

from orbiframe import Triangulation
from orbiframe.components.geometry_names import geometry_name
from orbiframe.components.registry import Registry
from orbiframe.files import gate
from orbiframe.fitting.mapping import PARAMETRIZER
from orbiframe.meshes.defects import require_closed_surface
from orbiframe.meshes.face_diagonals import triangulated
from orbiframe.meshes.orientation import oriented
from orbiframe.testing.kit import Verdict, laws_of, tried
from orbiframe.testing.lab import Lab

FOLDER = Path(__file__).parents[1] / "datasets"
REGISTRY = Registry.discover()
FAMILIES = [component.name for component in REGISTRY.components("basis")]
SURFACES = (
    "sphere",
    "projective_plane",
    "torus",
    "klein_bottle",
    "plate_genus2",
    "plate_genus5",
    "three_crosscaps",
)

# Functions of every basis; where the surface needs more for the fewest triangles, it gets more.
SIZE = 60


@dataclass(frozen=True)
class OneSurface(Lab):
    """A lab with the triangulation of one dataset."""

    surface_name: str = ""

    @cached_property
    def triangulations(self) -> Mapping[str, Triangulation]:
        return {self.surface_name: mapped(self.surface_name)}


@cache
def mapped(surface: str) -> Triangulation:
    """The map of a dataset to X/H, as coarse as its mesh is."""
    mesh = oriented(gate.read(FOLDER / f"{surface}.off", REGISTRY))
    chi = require_closed_surface(mesh).euler_characteristic
    geometry = geometry_name(chi)
    parametrizer = REGISTRY.load("parametrizer", PARAMETRIZER[geometry])
    made: Triangulation = parametrizer(triangulated(mesh), REGISTRY.load("geometry", geometry)(), None)
    return made


def exists(family: str, surface: str) -> bool:
    """Whether a basis exists on a surface: products of B-splines only where the Euler characteristic is 0."""
    return family != "tensor-bspline" or surface in ("torus", "klein_bottle")


def verdicts(family: str, surface: str, folder: Path, **options: object) -> list[Verdict]:
    """What every law says of a basis with some options on a surface."""
    params = {"size": SIZE, **options}
    component = partial(REGISTRY.load("basis", family), **params)
    return [tried(law, component, OneSurface(folder, params, surface_name=surface)) for law in laws_of("basis").laws]
