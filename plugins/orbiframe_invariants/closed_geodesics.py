"""Closed geodesics of X/H: the length spectrum, and the systole, the shortest one that cannot be contracted."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from orbiframe import GeometryError, Group
from orbiframe.groups import DirichletDomain, Elements, dirichlet_domain_of, elements_of_domain
from orbiframe.planes import PreciseIsometry

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]

# An axis that comes this near to a corner of the domain, as a sine, meets the sides there; one that comes half as near
# is followed across them. Rounding is far below, so that its image is among the axes that meet the domain.
_NEAR = 1e-5
# Matrices that agree to this, relative to their size, are one element.
_SAME = 1e-8
# Lengths that agree to this are equal; no two classes may differ by as little as a hundred times this.
_EQUAL = 1e-8


@dataclass(frozen=True, slots=True)
class Systole:
    """The length of the shortest closed geodesics that cannot be contracted, and how many there are."""

    length: float
    multiplicity: int


@dataclass(frozen=True, eq=False)
class LengthSpectrum:
    """Closed geodesics of X/H: conjugacy classes of the group, a class and its inverse counted once, by length.

    length: (n,), rising; power: (n,), how often it runs through a shorter one, 1 for a primitive class; one_sided:
    (n,), going round it reverses orientation; word: n words in the letters of the group, one of each class; error: the
    largest difference between the lengths of two elements of one class, which is what rounding has done.
    """

    length: Floats
    power: Ints
    one_sided: Bools
    word: tuple[tuple[int, ...], ...]
    error: float

    @property
    def multiplicities(self) -> list[tuple[float, int]]:
        """Every length with the number of closed geodesics that have it, powers included."""
        starts = np.flatnonzero(np.concatenate([[True], np.diff(self.length) > _EQUAL]))[: len(self.length)]
        counts = np.diff(np.append(starts, len(self.length)))
        return [(float(self.length[k]), int(count)) for k, count in zip(starts, counts, strict=True)]


def length_spectrum(group: Group, up_to: float) -> LengthSpectrum:
    """All closed geodesics of X/H up to a length, as classes of freely homotopic curves.

    A closed geodesic runs through the Dirichlet domain, so that some element of its class has an axis that meets the
    domain: it moves the origin by d with cosh(d/2) <= cosh(R) cosh(L/2) at most, R the circumradius of the domain. Two
    such elements are conjugate if and only if one follows from the other by moving along the axis from tile to tile. In
    E^2 parallel closed geodesics are one class, in S^2 those of the projective plane are.

    Raises GeometryError where rounding decides: where the conjugates of an element are not found, lengths of one class
    differ by more than 1e-8, or those of two by less than 1e-6 and more than that; and for too many elements.
    """
    return _spectrum(group, dirichlet_domain_of(group), up_to)


def systole(group: Group) -> Systole:
    """The shortest closed geodesics of X/H that cannot be contracted: length and number, opposite directions once.

    On an orbifold with singular points, those that cannot be drawn into one of them either. Raises GeometryError for
    the sphere, where every curve can be contracted.
    """
    domain = dirichlet_domain_of(group)
    lengths = translation_lengths(domain.precise)
    lengths = lengths[lengths > _EQUAL]
    if group.geometry.curvature > 0 and not len(lengths):
        raise GeometryError("every closed curve on the sphere can be contracted: there is no systole")
    up_to = float(lengths.min()) if len(lengths) else domain.circumradius
    while not len((found := _spectrum(group, domain, up_to * (1 + 1e-7))).length):
        up_to *= 2
    return Systole(*found.multiplicities[0])


def translation_lengths(precise: PreciseIsometry) -> Floats:
    """How far isometries (n,) move the points of their axes, (n,); 0 for rotations and reflections.

    A translation has |Re a| = cosh(l/2), a glide reflection |Re b| = sinh(l/2); in E^2 |b| or |Re b| = l/2. The
    antipodal map of S^2 moves all points by pi; other isometries of S^2 have fixed points, or powers that do.
    """
    a, b, reverses, k = precise.a, precise.b, precise.reverses, precise.curvature
    if k > 0:
        return np.where(reverses & (np.abs(a) < _EQUAL), np.pi, 0.0)
    straight = np.sqrt(np.maximum((np.abs(a.real) - 1) * (np.abs(a.real) + 1), 0))
    if k == 0:
        straight = np.where(np.abs(a.imag) < _EQUAL, np.abs(b), 0)
    half = np.where(reverses, np.abs(b.real), straight)
    return np.asarray(2 * (np.arcsinh(half) if k else half), dtype=np.float64)


def axes(precise: PreciseIsometry) -> Floats:
    """The axes of translations and glide reflections of H^2 and E^2 as covectors (n, 3).

    covector @ x is the sine of the distance of x (H^2: sinh, E^2: the distance). Of a translation of E^2 the axis
    through the origin.
    """
    a, b, reverses = precise.a, precise.b, precise.reverses
    first, second = np.where(reverses, b, a), np.where(reverses, a, b)
    normals = np.stack([-first.imag, -second.imag, second.real], axis=-1)
    square = precise.curvature * normals[:, 0] ** 2 + normals[:, 1] ** 2 + normals[:, 2] ** 2
    return np.asarray(normals / np.sqrt(square)[:, None], dtype=np.float64)


def _spectrum(group: Group, domain: DirichletDomain, up_to: float) -> LengthSpectrum:
    found = elements_of_domain(domain, group.area, _reach(domain, up_to))
    length = translation_lengths(_doubles(found))
    limit = up_to + _EQUAL
    if (np.abs(length - limit) < _EQUAL / 10).any():
        raise GeometryError(f"rounding decides whether a length is {up_to:.12g} or less; give another limit")
    number = np.flatnonzero((length > _EQUAL) & (length <= limit))
    if domain.geometry.curvature <= 0:
        number = number[_meets_domain(domain, found, number)]
    label = _classes(domain, found.precise(number), length[number])
    return _listed(found, number, length[number], label)


def _doubles(found: Elements) -> PreciseIsometry:
    return PreciseIsometry(found.generators.geometry.curvature, found.a, found.b, found.reverses)  # type: ignore[arg-type]


def _reach(domain: DirichletDomain, length: float) -> float:
    """How far an isometry of this translation length, or less, moves the origin if its axis meets the domain."""
    k, far = domain.geometry.curvature, domain.circumradius + 3 * _NEAR
    if k > 0:
        return float(np.pi)
    glides = bool(domain.precise.reverses.any())
    if k == 0:
        return float(np.hypot(length, 2 * far)) if glides else length * (1 + _EQUAL)
    if glides:
        return float(2 * np.arccosh(np.cosh(far) * np.cosh(length / 2)))
    return float(2 * np.arcsinh(np.cosh(far) * np.sinh(length / 2)))


def _sides_met(domain: DirichletDomain, precise: PreciseIsometry, near: float) -> Bools:
    """Which sides an axis meets, or comes near to at a corner, (n, side_count)."""
    height = axes(precise) @ domain.vertices.T
    after = np.roll(height, -1, axis=1)
    met = ~((np.minimum(height, after) > near) | (np.maximum(height, after) < -near))
    # Translations of E^2 have no axis of their own: all lines of one direction are.
    return met | (~precise.reverses[:, None] if domain.geometry.curvature == 0 else False)


def _meets_domain(domain: DirichletDomain, found: Elements, number: Ints) -> Bools:
    parts = np.array_split(number, 1 + len(number) // 100_000)
    return np.concatenate([_sides_met(domain, found.precise(part), 2 * _NEAR).any(axis=1) for part in parts])


def _classes(domain: DirichletDomain, precise: PreciseIsometry, length: Floats) -> Ints:
    """The number of the class of each element, (n,): joined to its inverse and to its conjugates along the axis."""
    size = len(length)
    if domain.geometry.curvature > 0:
        return np.arange(size)
    tree = cKDTree(_flat(precise))
    rows, partners = [np.arange(size)], [_partners(tree, precise.inverse, length, length)]
    met = _sides_met(domain, precise, _NEAR)
    for side in range(domain.side_count):
        (row,) = np.nonzero(met[:, side])
        step = domain.precise[np.full(len(row), side)]
        rows.append(row)
        partners.append(_partners(tree, step.inverse @ precise[row] @ step, length[row], length))
    links = np.concatenate(rows), np.concatenate(partners)
    graph = coo_array((np.ones(len(links[0])), links), shape=(size, size))
    return np.asarray(connected_components(graph, directed=False)[1], dtype=np.intp)


def _flat(precise: PreciseIsometry) -> Floats:
    """Isometries as points (n, 9): their matrices, scaled."""
    flat = precise.matrix.reshape(-1, 9)
    return np.asarray(flat / np.abs(flat).max(axis=1, keepdims=True))


def _partners(tree: cKDTree, wanted: PreciseIsometry, length: Floats, lengths: Floats) -> Ints:
    """The numbers of elements that must be in the list. Raises GeometryError where one is not."""
    if not len(length):
        return np.zeros(0, dtype=np.intp)
    apart, number = tree.query(_flat(wanted), p=np.inf)
    number = np.asarray(number, dtype=np.intp)
    lost = np.asarray(~(apart < _SAME))
    if lost.any() or (np.abs(lengths[number] - length) > _EQUAL).any():
        raise GeometryError(
            f"a conjugate of an element of length {length[int(np.argmax(lost))]:.9g} is not found: its digits are lost "
            "to rounding; ask for shorter geodesics"
        )
    return number


def _listed(found: Elements, number: Ints, length: Floats, label: Ints) -> LengthSpectrum:
    """One element of each class, that which moves the origin least, by length."""
    order = np.lexsort((np.abs(found.b[number]), label))
    first = order[np.unique(label[order], return_index=True)[1]]
    first = first[np.argsort(length[first], kind="stable")]
    gaps = np.diff(length[first])
    if ((gaps > _EQUAL) & (gaps < 100 * _EQUAL)).any():
        raise GeometryError("two lengths agree to 1e-6, but not to 1e-8; ask for shorter geodesics")
    precise = found.precise(number)
    return LengthSpectrum(
        length[first],
        _powers(precise, length, first),
        precise.reverses[first],
        tuple(found.word(int(number[k])) for k in first),
        _spread(length, label),
    )


def _spread(value: Floats, label: Ints) -> float:
    """The largest difference of two values with one label."""
    order = np.lexsort((value, label))
    starts = np.flatnonzero(np.diff(label[order], prepend=-1))
    return float(max(np.ptp(part) for part in np.split(value[order], starts[1:]))) if len(value) else 0.0


def _powers(precise: PreciseIsometry, length: Floats, first: Ints) -> Ints:
    """How many times some elements run through the shortest element with the same axis: 1 for those without a root."""
    if precise.curvature > 0:
        return np.ones(len(first), dtype=np.intp)
    order = np.argsort(length)
    rising, line = length[order], axes(precise)
    power = np.ones(len(first), dtype=np.intp)
    for row, k in enumerate(first):
        for p in range(2, int(length[k] / rising[0] + _EQUAL) + 1):
            low, high = np.searchsorted(rising, length[k] / p + np.array([-_EQUAL, _EQUAL]))
            roots = order[low:high]
            roots = roots[(precise.reverses[roots] & (p % 2 == 1)) == precise.reverses[k]]
            if _one_axis(line[roots], line[k], precise.curvature == 0 and not precise.reverses[k]).any():
                power[row] = p
    return power


def _one_axis(lines: Floats, line: Floats, parallel: bool) -> Bools:
    """Which lines (n, 3) are the line (3,), or only parallel to it in E^2; covectors have one sign or the other."""
    columns = slice(int(parallel), 3)
    apart = [np.abs(lines - sign * line)[:, columns].max(axis=1, initial=0.0) for sign in (1, -1)]
    return np.asarray(np.minimum(*apart) < _SAME * np.abs(line).max())
