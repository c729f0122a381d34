"""Counts of a default fit: what is computed once stays computed once."""

from __future__ import annotations

import numpy as np
import pytest
from orbiframe_bases.gaussian import Gaussian
from orbiframe_fitters import few_samples, normal_equations
from orbiframe_parametrizers import elimination
from reference_meshes import grid

from orbiframe import fit
from orbiframe.fitting.meaning import facets_show
from orbiframe.functions import orbit_sum
from orbiframe.meshes import orientation

# Dense factors of a fit and sparse ones of its maps; pairs of a point and a lift, and tests for them: at most so many.
FACTORS, COPIES = (34, 4), (4_800_000, 3_700_000)


def counted(monkeypatch, owner, name):
    """The arguments of the calls of a function from now on."""
    calls, function = [], getattr(owner, name)

    def noted(*given):
        calls.append(given)
        return function(*given)

    monkeypatch.setattr(owner, name, noted)
    return calls


@pytest.mark.parametrize(("along", "maps"), [(80, 1), (24, 2)])
def test_a_mesh_that_is_finer_than_its_functions_is_mapped_once(along, maps, monkeypatch):
    """And one order of elimination serves all matrices of both maps, for the faces are the same."""
    elimination._of_faces.cache_clear()
    orders = counted(monkeypatch, elimination, "elimination_order")
    seen = []
    mesh = grid(along, along // 2)
    fit(mesh, size=60, progress=lambda stage, seconds: seen.append(stage) if seconds is None else None)
    assert facets_show(mesh, 60) == (maps == 2)
    assert seen.count("map") == maps
    assert len(orders) == 1


def test_sheets_are_found_once_for_a_mesh_wherever_it_lies(monkeypatch):
    found = counted(monkeypatch, orientation, "face_sheets")
    mesh = grid(8, 6)
    assert mesh.sheets is mesh.with_vertices(2 * mesh.vertices).sheets
    assert mesh.with_vertices(mesh.vertices + 1).edge is not None
    assert len(found) == 1


def test_fairness_asks_for_few_third_derivatives(monkeypatch):
    """Twelve samples a function, twice: for the linear fit and for the steps."""
    monkeypatch.setattr(few_samples, "_CHEAP", 0)
    asked = counted(monkeypatch, Gaussian, "jet_matrices")
    fit(grid(80, 40), size=60, progress=False)
    thirds = sum(len(points.patch) for _, points, order in asked if order == 3)
    assert 0 < thirds <= 2 * 12 * 60


def test_few_stand_for_all_in_the_energy(monkeypatch):
    """The surface is as near to the torus as with all samples in the energy."""
    away = []
    for cheap in (0, 1 << 30):
        monkeypatch.setattr(few_samples, "_CHEAP", cheap)
        points = fit(grid(80, 40), size=60, progress=False).output.vertices
        away.append(np.sqrt(np.mean((np.hypot(np.hypot(points[:, 0], points[:, 1]) - 2, points[:, 2]) - 1) ** 2)))
    assert away[0] < 1.1 * away[1] + 1e-12


@pytest.mark.parametrize("order", [0, 1, 2, 3])
def test_profiles_have_what_is_asked_for_and_no_more(order):
    basis = object.__new__(Gaussian)
    basis.decay = 6.76
    t = np.linspace(0, 1.2, 50)
    found = basis.profile_jet(t, order)
    assert len(found) == order + 1
    for some, every in zip(found, basis.profile(t), strict=False):
        assert np.array_equal(some, every)


def test_a_default_fit_makes_few_factors_and_walks_few_copies(monkeypatch):
    """Three factors a step, one for each trial of fairness, two a map.

    Copies walked: pairs of a point and a lift of a centre that reaches it, and the tests that find them.
    """
    dense = counted(monkeypatch, normal_equations, "_factored")
    of_maps = counted(monkeypatch, elimination, "factorised")
    walked, pairs_of_block = np.zeros(2, dtype=int), orbit_sum._pairs_of_block

    def noted(*given):
        pairs = pairs_of_block(*given)
        walked[:] += len(pairs.column), pairs.tests
        return pairs

    monkeypatch.setattr(orbit_sum, "_pairs_of_block", noted)
    monkeypatch.setenv("ORBIFRAME_THREADS", "1")
    mesh = grid(48, 24)
    fit(mesh, size=250, progress=False)
    assert FACTORS[0] / 2 <= len(dense) <= FACTORS[0]
    assert 1 <= len(of_maps) <= FACTORS[1]
    assert COPIES[0] / 2 <= walked[0] <= COPIES[0]
    assert COPIES[1] / 2 <= walked[1] <= COPIES[1]
