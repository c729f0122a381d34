"""Few faces between creases: planes where a region is plane, B-spline faces elsewhere, one closed solid."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from creased import fitted_with_creases
from late import Late
from orbiframe_exact.creased_domain import creased_domain
from orbiframe_exact.creased_faces import CreasedFaces
from orbiframe_exact.faces_of_surface import described, diagonal_of, fitted_between_creases
from orbiframe_exact.plane_borders import PlaneBorders

opened, shared_edges, open_cascade = (
    Late("opened_shapes", needs="OCP.gp"),
    Late("shared_edges", needs="OCP.gp"),
    Late("orbiframe_exact.open_cascade", needs="OCP.gp"),
)

# How many planes there are, and the tolerance; those of the bar end in rounds, without a crease.
SHAPES = {"cube.off": (6, 1e-4), "cylinder": (2, 1e-2), "plate_genus2.off": (14, 1e-4), "rounded bar": (6, 1e-3)}


@cache
def surface_of(name: str):
    return fitted_with_creases(name).surface


def domain_of(name: str):
    surface = surface_of(name)
    return creased_domain(surface, SHAPES[name][1] * diagonal_of(surface))


@pytest.mark.parametrize("name", SHAPES)
def test_plane_regions_are_planes_and_the_rest_is_covered_three_times(name):
    domain = domain_of(name)
    assert domain.planes.number == SHAPES[name][0]
    assert domain.count == 3 * (domain.planes.region < 0).sum()
    on = np.flatnonzero(domain.planes.region >= 0)
    places = domain.places[domain.triangles.vertex[on]]
    off = np.einsum("fcj,fj->fc", places, domain.planes.normal[domain.planes.region[on]])
    assert np.abs(off - domain.planes.offset[domain.planes.region[on], None]).max() < 1e-12


def test_the_borders_of_planes_are_closed_and_each_line_is_in_two_of_them():
    domain = domain_of("plate_genus2.off")
    borders, lines = PlaneBorders(domain), []
    for plane in range(domain.planes.number):
        for loop in borders.loops(plane):
            assert [end for _, _, end in loop] == [start for _, start, _ in loop[1:] + loop[:1]]
            lines += [piece[0] for piece in loop]
    number, count = np.unique(lines, return_counts=True)
    assert len(number) == 36
    assert (count == 2).all()
    assert sum(len(borders.loops(plane)) == 3 for plane in range(14)) == 2


def test_faces_are_near_the_surface_and_sharp_only_at_creases():
    surface = surface_of("cylinder")
    found = fitted_between_creases(surface, 1e-2)
    said = described(found, surface, 1e-2)
    assert said["planes"] == 2
    assert said["error"] <= 1e-2
    assert said["angle"] <= 0.1
    sharp = ~found.domain.smooth
    assert sharp.any()
    assert (found.domain.at_plane[sharp] >= 0).all()
    for e in np.flatnonzero(found.domain.at_plane >= 0):
        normal = found.domain.planes.normal[found.domain.at_plane[e]]
        assert np.ptp(found.edge_poles[e] @ normal) < 1e-12


def test_without_the_mean_of_normals_a_kink_is_left(monkeypatch):
    """The mutant: each face keeps its own normals, which differ across hairs of a rough surface."""
    surface = fitted_with_creases("cylinder", 30, 120).surface
    good = fitted_between_creases(surface, 1e-2)
    monkeypatch.setattr(CreasedFaces, "_border_normals", lambda self, quads, at, own: own)
    good._fit_faces(list(range(good.domain.count)))
    before = good.angle.max()
    good._rough_faces()
    assert good.angle.max() > before


@pytest.mark.long
@pytest.mark.parametrize("name", SHAPES)
def test_open_cascade_reads_a_valid_solid_that_is_sharp_where_it_should_be(name, tmp_path):
    surface, path = surface_of(name), tmp_path / "part.step"
    said = open_cascade.write_step(path, surface, exact=False, tolerance=SHAPES[name][1])
    assert said["valid"]
    shape = opened.read_back(path)
    assert opened.is_valid(shape)
    assert opened.is_solid(shape)
    fine = surface.tessellate(12)
    inside = np.linalg.det(fine.vertices[fine.triangles]).sum() / 6
    assert opened.volume(shape) == pytest.approx(inside, rel=10 * SHAPES[name][1])
    met = shared_edges.meeting(shape, 5)
    assert set(met.faces) == {2}
    assert met.gap < 1e-6
    assert met.angle == pytest.approx(90, abs=0.5)
