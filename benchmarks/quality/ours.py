"""The surfaces of orbiframe, by overrides of its configuration."""

from __future__ import annotations

from functools import cache

import numpy as np
from quality.skins import Skin

from orbiframe import Config, OrbifoldSurface, Polyhedron, Registry, fit
from orbiframe.meshes import refine


@cache
def _registry() -> Registry:
    return Registry.discover()


def overrides_of(method: str) -> list[str]:
    """ "ps6 size=500 fitter.name=least-squares" as overrides; a key without a table belongs to the basis."""
    first, *rest = method.split()
    name = [] if first == "default" else [f"basis.name={first}"]
    return name + [text if "." in text.partition("=")[0] else f"basis.{text}" for text in rest]


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
