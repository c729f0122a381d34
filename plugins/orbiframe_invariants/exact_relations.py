"""Exact proof of the relations of a regular polygon's group, in a ring of algebraic integers.

The pairings of a regular polygon with l sides and V vertex cycles are, up to a real factor, elements of SU(1,1) with
entries in Z[zeta, t]: zeta is a primitive root of unity of order 4 l, of which i and all directions are powers, and
t^2 = 4 cos^2(pi V / l) - 4 sin^2(pi / l). For the inradius r has cosh r = cos(pi V / l) / sin(pi / l). So a product of
pairings is computed without rounding, and what is zero is seen to be zero.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from orbiframe import GeometryError, Word

# Coefficients of a polynomial in zeta of degree below 2 l: Python integers, which never overflow; zeta^(2 l) = -1.
Polynomial = Any


@dataclass(frozen=True, eq=False)
class ExactRing:
    """The ring Z[zeta, t] of the regular polygon with `sides` sides and `cycles` vertex cycles."""

    sides: int
    cycles: int

    def root(self, power: int) -> Polynomial:
        """zeta to some power."""
        half = 2 * self.sides
        found = np.zeros(half, dtype=object)
        found[power % half] = 1 if power % (2 * half) < half else -1
        return found

    def times(self, p: Polynomial, q: Polynomial) -> Polynomial:
        """The product of two polynomials in zeta."""
        half = 2 * self.sides
        full = np.convolve(p, q)
        full = np.concatenate([full, np.zeros(2 * half - len(full), dtype=object)])
        return full[:half] - full[half:]

    def conjugate(self, p: Polynomial) -> Polynomial:
        """zeta becomes its inverse."""
        found = -p[::-1]
        return np.concatenate([p[:1], found[:-1]])

    def is_zero(self, p: Polynomial) -> bool:
        """Whether a polynomial vanishes at zeta: it is a multiple of the cyclotomic polynomial of order 4 l."""
        return not any(_remainder(list(p), _cyclotomic(4 * self.sides)))

    @property
    def square(self) -> Polynomial:
        """t^2."""
        cosine = self.root(2 * self.cycles) + self.root(-2 * self.cycles)
        sine = self.root(2) - self.root(-2)
        return self.times(cosine, cosine) + self.times(sine, sine)


@dataclass(frozen=True, eq=False)
class ExactNumber:
    """u + v t."""

    ring: ExactRing
    u: Polynomial
    v: Polynomial

    def __add__(self, other: ExactNumber) -> ExactNumber:
        return ExactNumber(self.ring, self.u + other.u, self.v + other.v)

    def __sub__(self, other: ExactNumber) -> ExactNumber:
        return ExactNumber(self.ring, self.u - other.u, self.v - other.v)

    def __mul__(self, other: ExactNumber) -> ExactNumber:
        r = self.ring
        u = r.times(self.u, other.u) + r.times(r.times(self.v, other.v), r.square)
        return ExactNumber(r, u, r.times(self.u, other.v) + r.times(self.v, other.u))

    @property
    def conjugate(self) -> ExactNumber:
        """The complex conjugate; t is real, because the inradius is."""
        return ExactNumber(self.ring, self.ring.conjugate(self.u), self.ring.conjugate(self.v))

    @property
    def is_zero(self) -> bool:
        """u = v = 0: enough for a proof that the number is 0."""
        return self.ring.is_zero(self.u) and self.ring.is_zero(self.v)


@dataclass(frozen=True, eq=False)
class ExactElement:
    """z -> (a w + b) / (b' w + a'), where ' is the conjugate and w is z, or z' if the element reverses orientation."""

    a: ExactNumber
    b: ExactNumber
    reverses: bool

    def __matmul__(self, other: ExactElement) -> ExactElement:
        c, d = (n.conjugate if self.reverses else n for n in (other.a, other.b))
        a = self.a * c + self.b * d.conjugate
        return ExactElement(a, self.a * d + self.b * c.conjugate, self.reverses != other.reverses)

    @property
    def is_identity(self) -> bool:
        """b = 0, a is real and orientation is kept."""
        return self.b.is_zero and (self.a - self.a.conjugate).is_zero and not self.reverses


def exact_pairings(word: Word) -> list[ExactElement]:
    """The side pairings of the regular hyperbolic polygon of a word: h_s = Rot(phi_s) T(2 r) J Rot(-phi_mate).

    phi_s is the direction of the middle of side s, r the inradius and J the half turn, or the reflection z -> -z' for
    sides that run the same way. Raises GeometryError for a surface that is not hyperbolic, or vertex cycles of
    different lengths, for which no regular polygon has the right angles.
    """
    lengths = {len(cycle) for cycle in word.vertex_cycles}
    if word.euler_characteristic >= 0 or len(lengths) > 1:
        raise GeometryError(
            f"'{word}' is a {word.surface} with vertex cycles of {sorted(lengths)} corners; an exact proof is for "
            "regular hyperbolic polygons, with a negative Euler characteristic and cycles of one length"
        )
    ring = ExactRing(len(word), len(word.vertex_cycles))
    nothing = np.zeros(2 * ring.sides, dtype=object)
    cosine = ExactNumber(ring, ring.root(2 * ring.cycles) + ring.root(-2 * ring.cycles), nothing)
    across = ExactElement(cosine, ExactNumber(ring, nothing, ring.root(0)), False)
    found = []
    for side in range(len(word)):
        out, back = (_rotation(ring, power) for power in (2 * side + 1, -(2 * word.mate[side] + 1)))
        half_turn = ExactNumber(ring, ring.root(ring.sides), nothing)
        turn = ExactElement(half_turn, ExactNumber(ring, nothing, nothing), word.reverses(side))
        found.append(out @ across @ turn @ back)
    return found


def prove_relations(word: Word) -> list[str]:
    """Proves the cycle relations of the regular polygon's group exactly; the relations, one for each vertex cycle.

    Raises GeometryError where one is not proved, naming it, and as `exact_pairings` does.
    """
    pairings = exact_pairings(word)
    proved = []
    for relation in word.relations:
        product = pairings[relation[0]]
        for side in relation[1:]:
            product = product @ pairings[side]
        text = " ".join(map(str, relation))
        if not product.is_identity:
            raise GeometryError(f"the product of the pairings of sides {text} of '{word}' is not the identity")
        proved.append(text)
    return proved


def _rotation(ring: ExactRing, power: int) -> ExactElement:
    """The rotation about the origin by twice the angle of zeta^power."""
    nothing = np.zeros(2 * ring.sides, dtype=object)
    return ExactElement(ExactNumber(ring, ring.root(power), nothing), ExactNumber(ring, nothing, nothing), False)


@cache
def _cyclotomic(order: int) -> tuple[int, ...]:
    """The coefficients of the cyclotomic polynomial: x^n - 1 divided by those of all smaller divisors of n."""
    found = [-1, *[0] * (order - 1), 1]
    for divisor in range(1, order):
        if order % divisor == 0:
            found = _quotient(found, _cyclotomic(divisor))
    return tuple(found)


def _quotient(p: list[int], divisor: tuple[int, ...]) -> list[int]:
    """p divided by a polynomial with leading coefficient 1, without the remainder."""
    rest, found = list(p), [0] * (len(p) - len(divisor) + 1)
    for k in reversed(range(len(found))):
        found[k] = rest[k + len(divisor) - 1]
        for j, c in enumerate(divisor):
            rest[k + j] -= found[k] * c
    return found


def _remainder(p: list[int], divisor: tuple[int, ...]) -> list[int]:
    """What is left of p after division by a polynomial with leading coefficient 1."""
    rest = list(p)
    for k in reversed(range(len(rest) - len(divisor) + 1)):
        factor = rest[k + len(divisor) - 1]
        for j, c in enumerate(divisor):
            rest[k + j] -= factor * c
    return rest
