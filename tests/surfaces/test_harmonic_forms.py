"""Harmonic forms and Hodge's decomposition: against the round torus, by jumps, and on nonorientable surfaces."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from fitted import DATASETS, REGISTRY, config, mesh_of

from orbiframe import fit
from orbiframe.errors import FitError, TopologyError
from orbiframe.orbifolds.atlas import Points
from orbiframe.surfaces.complex_structure import period_matrix
from orbiframe.surfaces.harmonic_forms import HarmonicForms, continuous_functions
from orbiframe.surfaces.hodge import Hodge
from orbiframe.surfaces.whitney_form import edge_form


@cache
def torus():
    """A torus of revolution with the radii 3 and 1."""
    return fit(mesh_of("round torus"), config(500, "basis.name=ps6"), REGISTRY).surface


@cache
def other(name: str):
    return fit(DATASETS / f"{name}.off", config(150, "basis.name=ps2"), REGISTRY).surface


@cache
def hodge() -> Hodge:
    return Hodge.of(torus(), degree=4)


def reduced(tau: complex) -> complex:
    """In the fundamental domain of the modular group, on its left half."""
    for _ in range(100):
        tau = tau - np.round(tau.real)
        if abs(tau) > 1 - 1e-9:
            break
        tau = -1 / tau
    return complex(-abs(tau.real), tau.imag)


def test_the_round_torus_in_space_is_conformal_to_a_rectangle():
    """Angles u round and v across with dv / (3 + cos v): the rectangle has the sides 2 pi and 2 pi / sqrt(8)."""
    found = period_matrix(HarmonicForms.on_surface(torus(), degree=6))
    assert reduced(found.matrix[0, 0]) == pytest.approx(1j * np.sqrt(8), abs=1e-4)


def test_on_x_the_modulus_is_that_of_the_lattice():
    """It is another one than in space: energies know the metric."""
    made = torus()
    found = period_matrix(HarmonicForms.on_x(continuous_functions(made, 2)))
    again = period_matrix(Hodge.of(made, 2, on_x=True).harmonic)
    assert found.matrix[0, 0] == pytest.approx(again.matrix[0, 0], abs=1e-9)
    from orbiframe.orbifolds.flat_lattice import FlatLattice

    first, second = FlatLattice.of(made.orbifold).basis.T @ [1, 1j]
    assert reduced(found.matrix[0, 0]) == pytest.approx(reduced(second / first), abs=1e-9)


def tangential(vectors: np.ndarray) -> np.ndarray:
    normal = torus().normals(hodge().points)
    return vectors - np.einsum("ni,ni->n", vectors, normal)[:, None] * normal


def test_parts_of_a_field_that_is_made_of_them():
    """The slope of z, that of x turned about the normal, and twice the differential of the angle round the axis."""
    x = torus().evaluate(hodge().points)
    normal = torus().normals(hodge().points)
    round_axis = np.stack([-x[:, 1], x[:, 0], 0 * x[:, 0]], axis=1) / (x[:, 0] ** 2 + x[:, 1] ** 2)[:, None]
    up, along = tangential(np.tile([0.0, 0.0, 1.0], (len(x), 1))), tangential(np.tile([1.0, 0.0, 0.0], (len(x), 1)))
    found = hodge().decompose(up + np.cross(normal, along) + 2 * round_axis)
    for name, part in (("exact", up), ("coexact", along), ("harmonic", 2 * round_axis)):
        area = np.einsum("n,ni,ni->", hodge().forms.weights, part, part)
        assert found.squares[name] == pytest.approx(area, rel=1e-3)
    assert found.squares["rest"] < 1e-3 * found.squares["exact"]
    basis = hodge().forms.basis
    for coefficients, wanted in ((found.exact, x[:, 2]), (found.coexact, x[:, 0])):
        missed = basis.values(hodge().points, coefficients[:, None])[:, 0] - wanted
        assert np.ptp(missed) < 0.02 * np.ptp(wanted)
    # The angle grows by 2 pi: the factors are periods.
    np.testing.assert_allclose(found.harmonic / (4 * np.pi), np.rint(found.harmonic / (4 * np.pi)), atol=1e-3)


def test_parts_are_orthogonal_and_add_up():
    rng = np.random.default_rng(0)
    form = rng.normal(size=(len(hodge().forms.weights), 2))
    found = hodge().decompose(form)
    assert sum(found.squares.values()) == pytest.approx(hodge().product(form, form), rel=1e-6)
    both = hodge().decompose(hodge().turned(form))
    assert both.squares["exact"] == pytest.approx(found.squares["coexact"], rel=1e-6)


def test_turning_twice_is_the_opposite_and_keeps_the_length():
    form = np.random.default_rng(1).normal(size=(len(hodge().forms.weights), 2))
    turned = hodge().turned(form)
    np.testing.assert_allclose(hodge().turned(turned), -form, atol=1e-9)
    assert hodge().product(turned, turned) == pytest.approx(hodge().product(form, form))
    assert abs(hodge().product(turned, form)) < 1e-9 * hodge().product(form, form)


@pytest.mark.long
@pytest.mark.parametrize(("name", "rank"), [("klein_bottle", 1), ("three_crosscaps", 2), ("sphere", 0)])
def test_surfaces_with_and_without_classes(name, rank):
    """Harmonic: orthogonal to the slopes of all functions, and of the jumps that were asked for."""
    made = other(name)
    forms = HarmonicForms.on_surface(made, degree=4)
    assert forms.count == rank
    parts = Hodge.of(made, 4)
    for k in range(rank):
        found = parts.decompose(parts.harmonic.evaluate(parts.points)[k])
        np.testing.assert_allclose(found.harmonic, np.eye(rank)[k], atol=1e-9)
        assert found.squares["exact"] < 1e-15
    if name != "sphere":
        assert found.coexact is None
        with pytest.raises(TopologyError, match="nonorientable"):
            period_matrix(forms)


def test_components_agree_where_the_branches_jump():
    """On both sides of the middle of edges: the jump is constant, so that its differential is not seen."""
    forms, made = HarmonicForms.on_surface(torus(), degree=6), torus()
    domain = forms.basis.domain
    face, corner = np.divmod(np.flatnonzero(forms.jumps.any(axis=0))[:20], 3)
    middle = domain.corners[face, corner] + domain.corners[face, (corner + 1) % 3]
    sides = []
    for sign in (1, -1):
        x = made.orbifold.geometry.project(middle + sign * 1e-6 * domain.corners[face, (corner + 2) % 3])
        placed = np.einsum("fij,fj->fi", domain.placement[face], x)
        sides.append(forms.evaluate(Points(domain.patch[face], placed)))
    assert np.abs(sides[0] - sides[1]).max() < 2e-2 * np.abs(sides[0]).max()


def test_integrals_along_edges():
    """Differences of a function have no harmonic part; with the angle round the axis they have its periods."""
    mesh = torus().triangulation.polyhedron
    x = mesh.vertices
    angle = np.arctan2(x[:, 1], x[:, 0])
    step = angle[mesh.head] - angle[mesh.tail]
    step -= 2 * np.pi * np.round(step / (2 * np.pi))
    height = x[mesh.head, 2] - x[mesh.tail, 2]
    plain = hodge().decompose(edge_form(torus(), height))
    assert plain.squares["harmonic"] < 1e-4 * plain.squares["exact"]
    assert plain.squares["coexact"] < 1e-3 * plain.squares["exact"]
    turning = hodge().decompose(edge_form(torus(), step + height)).harmonic / (2 * np.pi)
    np.testing.assert_allclose(turning, np.rint(turning), atol=2e-3)
    assert np.abs(turning).max() > 0.5


def test_whitneys_form_has_its_integrals():
    """Along an edge of the map the form has a constant speed in barycentric coordinates: Gauss's rule finds it."""
    made = torus()
    mesh = made.triangulation.polyhedron
    random = np.random.default_rng(3).normal(size=len(mesh.tail))
    integrals = random - random[mesh.twin]
    form = edge_form(made, integrals)
    triangles = np.arange(10)
    t, weight = np.polynomial.legendre.leggauss(8)
    share = (t + 1) / 2
    total, small = np.zeros(10), 1e-5
    for s, w in zip(share, weight / 2, strict=True):
        ends = []
        for moved in (s - small, s + small):
            place = np.tile([1 - moved, moved, 0.0], (10, 1))
            ends.append(made.triangulation.locate(triangles, place).x)
        middle = made.triangulation.locate(triangles, np.tile([1 - s - 1e-9, s, 1e-9], (10, 1)))
        frame = made.orbifold.geometry.frame(middle.x)
        speed = np.einsum("nik,ni->nk", frame, (ends[1] - ends[0]) / (2 * small))
        total += w * np.einsum("nk,nk->n", form(middle), speed)
    np.testing.assert_allclose(total, integrals[3 * triangles], atol=1e-6 * np.abs(integrals).max())


def test_what_does_not_fit_is_said():
    made = torus()
    with pytest.raises(FitError, match="bernstein"):
        HarmonicForms.on_x(made.basis)
    with pytest.raises(FitError, match="1-form has values of shape"):
        hodge().decompose(np.zeros((3, 2)))
    with pytest.raises(FitError, match="at point 1"):
        hodge().decompose(np.where(np.arange(len(hodge().forms.weights))[:, None] == 1, np.nan, np.zeros((1, 2))))
    with pytest.raises(FitError, match="halfedge"):
        edge_form(made, np.zeros(4))
    with pytest.raises(FitError, match="opposite"):
        edge_form(made, np.ones(len(made.triangulation.polyhedron.tail)))


@pytest.mark.long
def test_a_surface_with_creases_has_its_forms_too():
    """The functions are continuous anyway; corners only make the error larger."""
    creased = config(300, "basis.name=ps2", "data.creases=30")
    made = fit(DATASETS / "plate_genus2_coarse.off", creased, REGISTRY).surface
    assert made.basis.domain.crease is not None
    found = period_matrix(HarmonicForms.on_surface(made, degree=4))
    assert found.forms.count == 4
    assert np.linalg.eigvalsh(found.matrix.imag).min() > 0
    assert found.error < 0.05
