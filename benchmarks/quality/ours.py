"""The surfaces of orbiframe, by overrides of its configuration."""

from __future__ import annotations

from functools import cache

import numpy as np

from orbiframe import Config, OrbifoldSurface, Polyhedron, Registry, fit
from orbiframe.meshes import refine
from quality.skins import Skin


@cache
def _registry() -> Registry:
    return Registry.discover()


# One linear fit of 1000 functions to the faces, on one map, whatever the mesh is.
LINEAR = ("fitter.name=least-squares", "data.means=facets", "data.lift=false", "basis.size=1000")


def overrides_of(method: str) -> list[str]:
    """The overrides of "ps6 size=500 fitter.name=least-squares".

    "default" is no basis at all; a key without a table belongs to the basis; "linear" before it, or alone, is `LINEAR`.
    """
    words = method.split()
    linear = list(LINEAR) if words[0] == "linear" else []
    first, *rest = words[words[0] == "linear" :] or ["default"]
    name = [] if first == "default" else [f"basis.name={first}"]
    return linear + name + [text if "." in text.partition("=")[0] else f"basis.{text}" for text in rest]


def fitted(method: str, mesh: Polyhedron) -> OrbifoldSurface:
    """The surface that `orbiframe.fit` makes of a mesh."""
    return fit(mesh, Config.load(overrides=overrides_of(method)), _registry()).surface


def skin_of(surface: OrbifoldSurface, faces: int) -> Skin:
    """About so many triangles on the surface, with its analytic normals and curvature."""
    domain = surface.triangulation
    fine = refine(domain.polyhedron, max(1, round(np.sqrt(faces / domain.polyhedron.face_count))))
    points = domain.locate(fine.face, fine.barycentric)
    bent = surface.curvature(points)
    return Skin(surface.evaluate(points), fine.polyhedron.triangles, bent.normal, bent.gaussian)
