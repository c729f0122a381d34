"""Multivalued functions and their energy: constants, jumps, and condensation against the whole equations."""

from __future__ import annotations

import numpy as np
import pytest
from fitted import REGISTRY

from orbiframe.delaunay.polygon_fan import polygon_triangulation
from orbiframe.errors import FitError
from orbiframe.orbifolds.atlas import Points
from orbiframe.splines.condensation import least_energy
from orbiframe.splines.galerkin import stiffness
from orbiframe.splines.multivalued import branches, jumping, one
from orbiframe.triangulations.cocycles import cohomology
from orbiframe.words.word import Word


def space(text: str, degree: int):
    word = Word.parse(text)
    name = "lattice" if word.euler_characteristic == 0 else "regular-polygon"
    group = REGISTRY.load("group", name)(REGISTRY.geometry(word.euler_characteristic), word)
    domain = polygon_triangulation(group).refined()
    return REGISTRY.load("basis", "bernstein")(domain.orbifold, domain, degree=degree)


@pytest.mark.parametrize(("text", "degree"), [("abAB", 3), ("abAB", 4), ("abcdABCD", 2), ("aabbcc", 6)])
def test_the_coefficients_of_the_constant(text, degree):
    basis = space(text, degree)
    found = branches(basis)
    rng = np.random.default_rng(0)
    face = rng.integers(basis.domain.face_count, size=50)
    x = np.einsum("nc,nci->ni", rng.dirichlet([1, 1, 1], 50), basis.domain.corners[face])
    placed = basis.orbifold.geometry.project(np.einsum("nij,nj->ni", basis.domain.placement[face], x))
    values = found.values(Points(basis.domain.patch[face], placed), one(basis).reshape(-1, 1))
    np.testing.assert_allclose(values, 1, atol=1e-12)


@pytest.mark.parametrize(("text", "degree"), [("abcdABCD", 4), ("aabbcc", 2), ("abaB", 3)])
def test_branches_differ_by_the_jumps_along_edges(text, degree):
    """The polynomials of both triangles of an edge, at points of the edge."""
    basis = space(text, degree)
    domain, jumps = basis.domain, cohomology(basis.domain)
    net = jumping(basis, jumps).reshape(domain.face_count, -1, len(jumps))
    from orbiframe.splines.bernstein import bernstein_values

    for share in (0.2, 0.7):
        place = np.zeros((3 * domain.face_count, 3))
        here = np.arange(len(place))
        place[here, here % 3], place[here, (here + 1) % 3] = 1 - share, share
        x = np.einsum("hc,hci->hi", place, domain.corners[here // 3])
        norm = basis.orbifold.geometry.project(x)[:, :1] / x[:, :1]
        mine = np.einsum("ha,hak->hk", bernstein_values(degree, norm * place), net[here // 3])
        across = basis.orbifold.geometry.act(basis.orbifold.geometry.inverse(domain.gluing), norm * x)
        other = np.linalg.solve(np.swapaxes(domain.corners, 1, 2)[domain.twin // 3], across[..., None])[..., 0]
        theirs = np.einsum("ha,hak->hk", bernstein_values(degree, other), net[domain.twin // 3])
        np.testing.assert_allclose(mine - theirs, jumps.T, atol=1e-9)


@pytest.mark.parametrize(("text", "degree"), [("abcdABCD", 4), ("aabbcc", 2), ("abAB", 1)])
def test_condensed_equations_have_the_solution_of_the_whole_ones(text, degree):
    basis = space(text, degree)
    energy, start = stiffness(branches(basis)), jumping(basis, cohomology(basis.domain))
    found = least_energy(basis, energy, start)
    added = basis.matrix.toarray()
    full = energy.toarray()
    moved = np.linalg.lstsq(added.T @ full @ added, -added.T @ full @ start, rcond=1e-11)[0]
    difference = found - (start + added @ moved)
    np.testing.assert_allclose(full @ difference, 0, atol=1e-9)
    # What was added is a function of the basis.
    rest = found - start
    np.testing.assert_allclose(added @ np.linalg.lstsq(added, rest, rcond=None)[0], rest, atol=1e-9)


def test_functions_without_constants_are_refused():
    with pytest.raises(FitError, match="bernstein"):
        branches(space("abcdABCD", 3))
