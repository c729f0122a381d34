"""Period matrices against closed forms: lattices, published matrices, and symmetries that leave one choice alone."""

from __future__ import annotations

import json

import numpy as np
import pytest
from fitted import REGISTRY
from orbiframe_invariants.named_words import klein_quartic, opposite_sides
from orbiframe_invariants.periods import group_periods, standard_classes

from orbiframe.delaunay.polygon_fan import polygon_triangulation
from orbiframe.errors import TopologyError
from orbiframe.groups.fundamental_polygon import FundamentalPolygon, regular_polygon
from orbiframe.groups.polygon_group import PolygonGroup
from orbiframe.surfaces.complex_structure import period_matrix
from orbiframe.surfaces.harmonic_forms import HarmonicForms
from orbiframe.triangulations.cocycles import refined_jumps, require_cocycles
from orbiframe.triangulations.symplectic_basis import standard_form
from orbiframe.words.word import Word


def family(domain, degree):
    return REGISTRY.load("basis", "bernstein")(domain.orbifold, domain, degree=degree)


def regular(word: Word) -> PolygonGroup:
    geometry = REGISTRY.geometry(int(np.sign(word.euler_characteristic)))
    return PolygonGroup(regular_polygon(geometry, word))


def parallelogram(tau: complex) -> PolygonGroup:
    """The torus with the lattice 1, tau."""
    corners = np.array([0, 1, 1 + tau, tau]) - (1 + tau) / 2
    vertices = np.stack([np.ones(4), corners.real, corners.imag], axis=1)
    return PolygonGroup(FundamentalPolygon(REGISTRY.geometry(0), vertices, Word.parse("abAB")))


@pytest.mark.parametrize("tau", [1j, 0.25j, 3j, 0.3 + 0.9j, -0.45 + 0.2j, np.exp(1j * np.pi / 3)])
def test_a_torus_has_the_modulus_of_its_lattice(tau):
    found = group_periods(parallelogram(tau), family)
    assert abs(found.matrix[0, 0] - tau) < 1e-12
    assert found.error < 1e-12


def test_bolza_has_the_published_matrix():
    """y^2 = x (x^4 - 1): eta on the diagonal and (eta - 1) / 2 beside it, eta = (1 + 2 sqrt(2) i) / 3.

    Birkenhake and Lange, Complex Abelian Varieties, 11.7; here less the unit matrix, which is another choice of b.
    """
    eta = (1 + 2j * np.sqrt(2)) / 3
    found = group_periods(regular(opposite_sides(8)), family)
    wanted = np.array([[eta, (eta - 1) / 2], [(eta - 1) / 2, eta]]) - np.eye(2)
    assert np.abs(found.matrix - wanted).max() < 1e-11


def symmetric_energy(word: Word) -> np.ndarray:
    """The scalar products of the harmonic forms from the turn by one side of the polygon, without any equation.

    It acts on whole classes by a matrix with different eigenvalues, and * is i or -i on each of its eigenvectors,
    whichever makes the energy positive.
    """
    values = standard_classes(word)
    turn = np.linalg.lstsq(values.T.astype(float), np.roll(values, 1, axis=1).T.astype(float), rcond=None)[0]
    assert np.abs(turn - np.rint(turn)).max() < 1e-9
    eigenvalues, vectors = np.linalg.eig(np.rint(turn))
    assert np.abs(np.subtract.outer(eigenvalues, eigenvalues) + np.eye(len(turn))).min() > 1e-3
    form = standard_form(len(values) // 2)
    signs = np.sign(np.real(1j * np.einsum("ik,ij,jk->k", vectors.conj(), form, vectors)))
    star = vectors @ np.diag(1j * signs) @ np.linalg.inv(vectors)
    assert np.abs(star.imag).max() < 1e-12
    return form @ star.real


@pytest.mark.long
@pytest.mark.parametrize("sides", [8, 10, 12, 14, 16])
def test_polygons_with_opposite_sides_glued_have_the_matrix_of_their_symmetry(sides):
    found = group_periods(regular(opposite_sides(sides)), family)
    energy = symmetric_energy(opposite_sides(sides))
    assert np.abs(found.forms.gram - energy).max() < 1e-10
    half = len(energy) // 2
    imaginary = np.linalg.inv(energy[half:, half:])
    assert np.abs(found.matrix - (-energy[:half, half:] + 1j * np.eye(half)) @ imaginary).max() < 1e-10
    assert found.error < 1e-10


@pytest.mark.long
def test_kleins_quartic_has_numbers_of_the_field_of_the_root_of_minus_7():
    """Its Jacobian is a power of the curve with multiplication by (1 + sqrt(-7)) / 2: all entries lie in that field."""
    found = group_periods(regular(klein_quartic()), family).matrix
    imaginary, real = found.imag / np.sqrt(7) * 6, found.real * 6
    np.testing.assert_allclose(imaginary, np.rint(imaginary), atol=1e-9)
    np.testing.assert_allclose(real, np.rint(real), atol=1e-9)


@pytest.mark.parametrize("text", ["abABcdCD", "abcdABCD"])
def test_riemanns_relations_and_the_error_under_refinement(text):
    """Symmetric and with a positive imaginary part; the bound falls like h^(2 d), and holds."""
    word = Word.parse(text)
    domain, values = polygon_triangulation(regular(word)), standard_classes(word)
    jumps = np.zeros((4, 3 * domain.face_count), dtype=int)
    jumps[:, ::3] = values
    require_cocycles(domain, jumps)
    best = group_periods(regular(word), family).matrix
    assert np.linalg.eigvalsh(best.imag).min() > 0
    errors = []
    for _ in range(3):
        found = period_matrix(HarmonicForms.on_x(family(domain, 4), jumps))
        assert np.array_equal(found.matrix, found.matrix.T)
        assert np.abs(found.matrix - best).max() <= found.error
        errors.append(found.error)
        domain, jumps = domain.refined(), refined_jumps(jumps)
    # The first triangles are too large for the order to be seen.
    assert errors[1] / errors[2] > 2**7
    assert errors[0] / errors[1] > 2**4


def test_classes_are_one_on_their_letter():
    """The commutator word: the loops along the sides are the letters, their pairings others."""
    for text in ("abAB", "abABcdCD", "abcABC", "abcdeABCDE"):
        values = standard_classes(Word.parse(text))
        assert values.shape[0] == 2 - Word.parse(text).standard.euler_characteristic
        mates = Word.parse(text).mate
        assert (values[:, list(mates)] == -values).all()


def test_without_an_orientation_there_is_none():
    word = Word.parse("aabb")
    group = REGISTRY.load("group", "lattice")(REGISTRY.geometry(0), word)
    with pytest.raises(TopologyError, match="nonorientable"):
        group_periods(group, family)


def test_command_line(orbiframe):
    ran = orbiframe("group", "bolza", "--periods", "--json")
    assert (ran.status, ran.err) == (0, "")
    told = json.loads(ran.out)["periods"]
    assert told["matrix"][0][0] == pytest.approx([-2 / 3, 2 * np.sqrt(2) / 3], abs=1e-10)
    assert told["error"] < 1e-10
    assert "periods   0 + 1i\n" in orbiframe("group", "abAB", "--periods").out
    assert "periods   0 + 1i\n" in orbiframe("group", "o", "--periods").out
    for word, said in (("aa", "nonorientable"), ("aA", "a sphere has no harmonic"), ("*2222", "")):
        ran = orbiframe("group", word, "--periods")
        assert ran.status == 1
        assert said in ran.err
