"""Colours of faces: those of the input, in files that Open CASCADE's own readers of colours understand."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from fitted import fitted as fit_of
from late import Late
from orbiframe_exact.face_colours import face_colours
from orbiframe_exact.quad_domain import QuadDomain, quad_domain

from orbiframe import OrbifoldSurface

coloured, open_cascade = (
    Late("coloured_shapes", needs="OCP.gp"),
    Late("orbiframe_exact.open_cascade", needs="OCP.gp"),
)

RED, BLUE = np.array([1.0, 0.0, 0.0]), np.array([0.2, 0.4, 0.6])


def vertices(surface: OrbifoldSurface) -> np.ndarray:
    """Those of the input, in its place."""
    return np.asarray(surface.origin + surface.scale * surface.refinement.coarse.vertices)


def painted(name: str, side: float, axis: int = 0) -> OrbifoldSurface:
    """A surface whose input is red beyond a plane, by the middles of its triangles, and blue before it."""
    surface = fit_of(name).surface
    mesh = surface.refinement.coarse
    beyond = vertices(surface)[mesh.triangles].mean(axis=1)[:, axis] > side
    return with_mesh(surface, face_colors=np.where(beyond[:, None], RED, BLUE))


def with_mesh(surface: OrbifoldSurface, **tables: Any) -> OrbifoldSurface:
    coarse = replace(surface.refinement.coarse, **tables)
    return replace(surface, refinement=replace(surface.refinement, coarse=coarse))


def places(domain: QuadDomain, quad: int, surface: OrbifoldSurface) -> np.ndarray:
    """Points of the face over a quadrilateral, in space."""
    s, t = (grid.ravel() for grid in np.meshgrid(*2 * [np.linspace(0.05, 0.95, 15)]))
    found = domain.points.jets(np.full(len(s), quad), s, t, 0)[0]
    return np.asarray(surface.origin + surface.scale * found)


@pytest.mark.parametrize("name", ["torus.off", "plate_genus2_coarse.off", "klein_bottle.off", "cube.off"])
def test_a_face_has_the_colour_of_the_side_that_it_lies_on(name):
    middle = float(vertices(fit_of(name).surface)[:, 0].mean())
    surface = painted(name, middle)
    domain = quad_domain(surface, 40)
    found = face_colours(surface, domain)
    assert found is not None
    diagonal = float(np.linalg.norm(np.ptp(vertices(surface), axis=0)))
    clear = 0
    for quad in range(domain.count):
        x = places(domain, quad, surface)[:, 0] - middle
        if np.abs(x).min() > 0.1 * diagonal and np.ptp(np.sign(x)) == 0:
            clear += 1
            np.testing.assert_array_equal(found.rgb[quad], RED if x[0] > 0 else BLUE)
            assert found.share[quad] > 0.8
    assert clear >= 8
    assert 0 < found.divided < domain.count


def test_all_faces_together_have_as_much_of_a_colour_as_the_input():
    """Over all faces a colour has the share of the area that it has on the input."""
    surface = painted("torus.off", 1.0)
    mesh = surface.refinement.coarse
    corners = mesh.vertices[mesh.triangles]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    red = area[(mesh.face_colors == RED).all(axis=1)].sum() / area.sum()
    domain = quad_domain(surface, 16)
    found = face_colours(surface, domain)
    assert found is not None
    u, weights = np.polynomial.legendre.leggauss(12)
    s, t = (grid.ravel() for grid in np.meshgrid((u + 1) / 2, (u + 1) / 2))
    size = np.empty(domain.count)
    for quad in range(domain.count):
        _, fs, ft = domain.points.jets(np.full(len(s), quad), s, t, 1)
        size[quad] = np.linalg.norm(np.cross(fs, ft), axis=1) @ np.outer(weights, weights).ravel()
    of_red = np.where((found.rgb == RED).all(axis=1), found.share, 1 - found.share)
    assert of_red @ size / size.sum() == pytest.approx(red, abs=0.02)


def test_without_colours_there_are_none_and_those_of_vertices_are_averaged():
    surface = fit_of("torus.off").surface
    domain = quad_domain(surface, 16)
    assert face_colours(surface, domain) is None
    mesh = surface.refinement.coarse
    grey = with_mesh(surface, colors=np.full((len(mesh.vertices), 4), 0.25))
    found = face_colours(grey, domain)
    assert found is not None
    np.testing.assert_allclose(found.rgb, 0.25)
    assert found.divided == 0


@pytest.mark.parametrize("suffix", [".step", ".iges"])
def test_files_keep_the_colours(suffix, tmp_path):
    surface = painted("plate_genus2_coarse.off", 2.5)
    path = tmp_path / f"surface{suffix}"
    write = open_cascade.write_step if suffix == ".step" else open_cascade.write_iges
    said = write(path, surface, exact=False, tolerance=1e-2)
    found = coloured.colours_of_faces(path)
    assert len(found) == said["faces"]
    for middle, colour in found:
        if abs(middle[0] - 2.5) > 0.8:
            np.testing.assert_allclose(colour, RED if middle[0] > 2.5 else BLUE, atol=2e-3)
    assert sum(abs(middle[0] - 2.5) > 0.8 for middle, _ in found) >= 8
    assert 0 < said["divided"] < said["faces"]
