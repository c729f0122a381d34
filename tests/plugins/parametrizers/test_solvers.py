"""Solvers: the laws of their kind, the same maps with each, and no order of a mesh that nobody needs."""

from __future__ import annotations

import sys

import numpy as np
import pytest
from orbiframe_parametrizers import elimination
from orbiframe_parametrizers.harmonic import harmonic
from orbiframe_parametrizers.metis import metis
from reference_meshes import dataset, edge_lengths

from orbiframe import ConfigError, PluginError, Registry, fit
from orbiframe.testing import Lab, contract_tests, laws_of
from orbiframe.workers import chosen_solver, solving_by

test_laws = contract_tests("solver", metis)

try:
    from orbiframe_parametrizers.pardiso import pardiso
except ModuleNotFoundError:
    pardiso = metis
needs_pardiso = pytest.mark.skipif(pardiso is metis, reason="pypardiso is not installed")
test_laws_of_pardiso = needs_pardiso(contract_tests("solver", pardiso))


@pytest.mark.parametrize("law", laws_of("solver").laws, ids=lambda law: law.__name__)
def test_every_law_rejects_its_mutant(law, tmp_path):
    with pytest.raises(AssertionError):
        law(laws_of("solver").mutants[law.__name__](metis), Lab(tmp_path))


@pytest.mark.parametrize("name", ["plate_genus2", "klein_bottle"])
@pytest.mark.parametrize("solver", [metis, pytest.param(pardiso, marks=needs_pardiso)])
def test_the_map_is_that_of_the_order_of_the_mesh(name, solver, monkeypatch):
    """Complex equations of an orientable surface, real ones of another; the mesh itself is not ordered then."""
    mesh = dataset(name)
    geometry = Registry.discover().load("geometry", "h2" if name == "plate_genus2" else "e2")()
    wanted = harmonic(mesh, geometry)
    monkeypatch.setattr(elimination.Elimination, "of", None)
    with solving_by(solver):
        found = harmonic(mesh, geometry)
    assert chosen_solver() is None
    np.testing.assert_allclose(edge_lengths(found), edge_lengths(wanted), atol=1e-9)


def test_a_configuration_names_it(monkeypatch):
    """Every equation of the map goes to the solver, and an unknown one is refused with those that are known."""
    seen = []
    monkeypatch.setattr("orbiframe_parametrizers.metis.metis", lambda matrix: seen.append(matrix) or metis(matrix))
    found = fit("dataset:torus", size=60, solver="metis", progress=False)
    assert seen
    plain = fit("dataset:torus", size=60, progress=False)
    assert found.report["fit"]["rms"] == pytest.approx(plain.report["fit"]["rms"], rel=1e-3)
    with pytest.raises(ConfigError, match="metis"):
        fit("dataset:torus", size=60, solver="metiss", progress=False)


def test_meshes_with_the_same_faces_are_ordered_once(monkeypatch):
    """A mesh and the same one moved: one order of elimination, whatever steps ask for it."""
    mesh, counted = dataset("plate_genus2"), []
    order = elimination.elimination_order
    monkeypatch.setattr(elimination, "elimination_order", lambda *given: counted.append(1) or order(*given))
    first = elimination.Elimination.of(mesh.with_vertices(mesh.vertices + 1))
    assert elimination.Elimination.of(mesh.with_vertices(2 * mesh.vertices)) is first
    assert len(counted) <= 1


def test_pardiso_where_it_is_not_installed_is_an_error_with_the_way_out(monkeypatch):
    monkeypatch.setitem(sys.modules, "pypardiso", None)
    monkeypatch.delitem(sys.modules, "orbiframe_parametrizers.pardiso", raising=False)
    with pytest.raises(PluginError, match=r"pip install .*orbiframe\[pardiso\]"):
        fit("dataset:torus", size=60, solver="pardiso", progress=False)
