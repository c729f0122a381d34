"""Length spectra against published lengths, lattices and Selberg's trace formula."""

from __future__ import annotations

import numpy as np
import pytest
from orbiframe_groups.finite import FiniteGroup
from orbiframe_groups.lattice import lattice_group
from orbiframe_invariants.closed_geodesics import length_spectrum, systole
from reference_geometries import GEOMETRIES
from scipy.integrate import quad

from orbiframe import GeometryError, Word
from orbiframe.groups import PolygonGroup, regular_polygon
from orbiframe.groups.conway_group import orbifold_group
from orbiframe.words import standard_word
from orbiframe.words.conway_symbol import ConwaySymbol

S2, E2, H2 = GEOMETRIES

# Eigenvalues of the Laplacian with multiplicities: Bolza's surface [Strohmaier and Uski 2013], the paper's octagon.
EIGENVALUES = {
    "abcdABCD": [
        *[(0.0, 1), (3.8388872588421995, 3), (5.3536013411890504, 4), (8.2495548152006581, 2), (14.726216787788832, 4)],
        *[(15.048916133267048, 3), (18.658819627260194, 3), (20.519859734142002, 4), (23.078558481381635, 1)],
        *[(28.079605737677729, 3), (30.833042737932550, 4)],
    ],
    "abABcdCD": [
        *[(0.0, 1), (1.724863804, 1), (3.838887259, 1), (4.035491714, 1), (5.372814500, 1), (7.160197861, 2)],
        *[(8.249554815, 2), (8.802898358, 1), (9.622961194, 1), (10.651869603, 1), (13.30983192, 2)],
    ],
}


def regular(text: str) -> PolygonGroup:
    return PolygonGroup(regular_polygon(H2, Word.parse(text)))


@pytest.mark.parametrize(
    ("text", "time", "up_to", "within"), [("abcdABCD", 0.8, 9.0, 1e-8), ("abABcdCD", 1.2, 9.5, 3e-6)]
)
def test_the_trace_formula_holds(text: str, time: float, up_to: float, within: float) -> None:
    """Selberg 1956 for exp(-t lambda): eigenvalues on one side; area and closed geodesics, both ways, on the other."""
    heat = sum(count * np.exp(-time * value) for value, count in EIGENVALUES[text])
    smooth = quad(lambda r: 2 * r * np.tanh(np.pi * r) * np.exp(-time * (r * r + 0.25)), 0, 12, epsabs=1e-13)[0]
    group = regular(text)
    found = length_spectrum(group, up_to)
    weight = np.exp(-time / 4 - found.length**2 / (4 * time)) / np.sqrt(4 * np.pi * time)
    geodesics = (2 * (found.length / found.power) / (2 * np.sinh(found.length / 2)) * weight).sum()
    assert heat == pytest.approx(group.area / (4 * np.pi) * smooth + geodesics, abs=within)


def test_the_lengths_of_bolzas_surface() -> None:
    """cosh(l/2) = m + n sqrt 2; multiplicities for both directions are 24, 24, 48, 96 [Aurich and Steiner 1988]."""
    found = length_spectrum(regular("abcdABCD"), 6.7)
    root = np.sqrt(2)
    lengths = 2 * np.arccosh([1 + root, 3 + 2 * root, 5 + 3 * root, (1 + root) ** 2 * 2 - 1, 7 + 5 * root])
    assert [count for _, count in found.multiplicities] == [12, 12, 24, 12, 48]
    np.testing.assert_allclose([length for length, _ in found.multiplicities], lengths, atol=1e-11)
    np.testing.assert_array_equal(found.power, np.repeat([1, 1, 1, 2, 1], [12, 12, 24, 12, 48]))
    assert found.error < 1e-11


def test_the_shortest_lengths_of_the_octagon_of_the_paper() -> None:
    found = length_spectrum(regular("abABcdCD"), 4.0).multiplicities
    np.testing.assert_allclose([length for length, _ in found], [2.256767930, 3.057141839, 3.797845915], atol=1e-9)


@pytest.mark.parametrize("genus", [2, 3, 7, 12, 20])
def test_systoles_of_the_standard_words(genus: int) -> None:
    """A side of the regular 4g-gon and the next but one: cosh(l/2) = 2 cos^2(pi/4g), two generators a handle."""
    found = systole(regular(str(standard_word(2 - 2 * genus, True))))
    assert found.length == pytest.approx(2 * np.arccosh(2 * np.cos(np.pi / (4 * genus)) ** 2), abs=1e-12)
    assert found.multiplicity == 2 * genus


def test_the_systole_of_bolzas_surface() -> None:
    found = systole(regular("abcdABCD"))
    assert found.length == pytest.approx(2 * np.arccosh(1 + np.sqrt(2)), abs=1e-13)
    assert found.multiplicity == 12


def klein_quartic() -> PolygonGroup:
    """Klein's 14-gon: side 2 k + 1 is glued to side 2 k + 6."""
    letters = [0] * 14
    for k in range(7):
        letters[2 * k + 1], letters[(2 * k + 6) % 14] = k + 1, -k - 1
    return PolygonGroup(regular_polygon(H2, Word(tuple(letters))))


def test_the_systole_of_kleins_quartic_and_of_its_orbifold() -> None:
    """21 geodesics of four times the shortest length of 237, 2 arccosh of half the trace [Schmutz 1993].

    The trace t of that length is 2 cos(2 pi/7) + 1 = 2 cosh(l/2): in Q(cos 2 pi/7), as all traces of 237.
    """
    short = 2 * np.arccosh(np.cos(2 * np.pi / 7) + 0.5)
    triangle = systole(orbifold_group(H2, ConwaySymbol.parse("237")))
    assert triangle.length == pytest.approx(short, abs=1e-12)
    found = systole(klein_quartic())
    assert (found.length, found.multiplicity) == (pytest.approx(4 * short, abs=1e-12), 21)


@pytest.mark.parametrize(
    ("symbol", "order", "share", "count"),
    [("442", 4, 1.0, 1), ("2222", 2, 1.0, 2), ("*442", 8, np.sqrt(0.5), 1), ("4*2", 8, 0.5, 1)],
)
def test_systoles_of_flat_orbifolds(symbol: str, order: int, share: float, count: int) -> None:
    """The side of the square lattice, whose torus covers with `order` sheets, or the part that a glide moves.

    p4m has glide reflections by half a diagonal of the square, p4g by half a side; turns join two classes.
    """
    group = orbifold_group(E2, ConwaySymbol.parse(symbol))
    found = systole(group)
    assert found.length == pytest.approx(share * np.sqrt(order * group.area), abs=1e-12)
    assert found.multiplicity == count


def test_words_have_the_lengths_of_their_classes() -> None:
    group = regular("aabbcc")
    found = length_spectrum(group, 5.0)
    for word, length, one_sided in zip(found.word, found.length, found.one_sided, strict=True):
        motion = H2.motion(group.element(word))
        assert motion.length == pytest.approx(length, abs=1e-9)
        assert motion.kind == ("glide" if one_sided else "translation")
    assert len({tuple(sorted(map(abs, word))) for word in found.word[:3]}) == 3


def test_one_sided_geodesics_of_three_crosscaps() -> None:
    """The crosscaps: neighbouring sides meet at the angle pi/3, so the glide a has sinh(l/2) = sinh(r) sin(pi/6)."""
    group = regular("aabbcc")
    found = length_spectrum(group, 4.0)
    short = 2 * np.arcsinh(np.sinh(group.polygon.inradius) * np.sin(np.pi / 6))
    np.testing.assert_allclose(found.length[:3], short, atol=1e-13)
    assert found.one_sided[:3].all()
    squares = np.abs(found.length - 2 * short) < 1e-9
    assert squares.sum() == 3
    assert (found.power[squares] == 2).all()
    assert not found.one_sided[squares].any()


@pytest.mark.parametrize("second", [(0.0, 1.0), (0.5, np.sqrt(0.75)), (12.3, 1.1)])
def test_the_torus_against_its_lattice(second: tuple[float, float]) -> None:
    up_to = 4.1
    m, n = np.meshgrid(np.arange(-60, 61), np.arange(-6, 7))
    half = (n > 0) | ((n == 0) & (m > 0))
    length = np.hypot(m + n * second[0], n * second[1])[half]
    power = np.gcd(m, n)[half][length <= up_to]
    found = length_spectrum(lattice_group(E2, Word.parse("abAB"), second=second), up_to)
    np.testing.assert_allclose(found.length, np.sort(length[length <= up_to]), atol=1e-11)
    assert sorted(found.power) == sorted(power)
    assert not found.one_sided.any()


def test_the_klein_bottle_in_closed_form() -> None:
    """Unit square, glide g along x, translation t along y: g^m and t g^m for odd m, and (2j, n) up to both signs."""
    found = length_spectrum(lattice_group(E2, Word.parse("abaB")), 5.05)
    glides = np.repeat([1.0, 3.0, 5.0], 2)
    straight = [np.hypot(2 * j, n) for j in range(3) for n in range(6) if 0 < np.hypot(2 * j, n) <= 5.05]
    np.testing.assert_allclose(found.length, np.sort([*glides, *straight]), atol=1e-12)
    np.testing.assert_allclose(found.length[found.one_sided], glides, atol=1e-12)
    np.testing.assert_array_equal(found.power[found.one_sided], np.repeat([1, 3, 5], 2))


@pytest.mark.parametrize(("word", "length", "count"), [("abaB", 1.0, 3), ("aabb", np.sqrt(0.5), 2)])
def test_systoles_of_klein_bottles(word: str, length: float, count: int) -> None:
    found = systole(lattice_group(E2, Word.parse(word)))
    assert (found.length, found.multiplicity) == (pytest.approx(length, abs=1e-14), count)


def test_the_projective_plane_has_one_class_of_half_great_circles() -> None:
    found = systole(FiniteGroup(S2, Word.parse("aa")))
    assert (found.length, found.multiplicity) == (pytest.approx(np.pi), 1)


def test_the_sphere_has_no_systole() -> None:
    with pytest.raises(GeometryError, match="contracted"):
        systole(FiniteGroup(S2, Word.parse("aA")))


def bent(amount: float) -> PolygonGroup:
    """Side pairings that obey the relation to `amount` only."""
    group = regular("abABcdCD")
    group.polygon.__dict__["heads"] = group.polygon.heads * [1.0, 1.0 + amount, 1.0]
    return group


def test_the_error_shows_pairings_that_are_no_group() -> None:
    assert length_spectrum(regular("abABcdCD"), 7.0).error < 1e-11
    assert 1e-10 < length_spectrum(bent(1e-10), 7.0).error < 1e-7
    with pytest.raises(GeometryError, match="Dirichlet domain"):
        length_spectrum(bent(1e-6), 7.0)
