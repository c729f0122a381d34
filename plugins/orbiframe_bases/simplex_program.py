"""Programs for simplex splines: which recursion steps to take, the same for every set of knots in general position.

The homogeneous simplex spline of a set B of m >= 3 vectors in R^3 is M_B = chi_B / |det B| for m = 3, with chi_B the
indicator of the cone that B spans, and M_B(x) = sum lambda_b M_(B - b)(x) for m > 3 and any representation
x = sum lambda_b b. It is piecewise a homogeneous polynomial of degree m - 3, and does not depend on the order of B.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Knots = tuple[int, ...]

# Knots whose determinant is this small against the product of their lengths span no cone.
_FLAT = 1e-13


@dataclass(frozen=True, eq=False)
class Program:
    """Steps that compute simplex splines of subsets of some knots, each from smaller ones before it.

    states: the subsets, those of three knots first; start: (states + 1,), the terms of each; child: (terms,), the state
    that a term uses, -1 in the states of three knots; knot: (terms,), the knot whose coordinate it uses; outputs: the
    states that are wanted.
    """

    states: tuple[Knots, ...]
    start: Ints
    child: Ints
    knot: Ints
    outputs: Ints

    @property
    def orders(self) -> Ints:
        """The degree of every state: its number of knots less 3."""
        return np.array([len(state) - 3 for state in self.states], dtype=np.intp)

    def rows(self, knots: Floats) -> tuple[Floats, Floats]:
        """What the steps need for sets of knots (E, K, 3): rows (E, terms, 3) and 1/|det| of three knots, (E, states).

        The scalar products of the rows of a state with x are coordinates of x in its knots: those of least norm. Three
        knots in one plane with the origin have rows and 1/|det| zero.
        """
        rows = np.zeros((len(knots), len(self.child), 3))
        height = np.zeros((len(knots), len(self.states)))
        for s in range(len(self.states)):
            terms = slice(self.start[s], self.start[s + 1])
            basis = knots[:, self.knot[terms]]
            if basis.shape[1] == 3:
                rows[:, terms], height[:, s] = dual_basis(basis)
            else:
                rows[:, terms] = np.swapaxes(np.linalg.pinv(basis), 1, 2)
        return rows, height


def dual_basis(basis: Floats) -> tuple[Floats, Floats]:
    """The rows of the inverse of the matrix with columns `basis` (E, 3, 3), and 1/|det|; zero where they are flat.

    p x q is computed as p x (q - p), which is right to rounding for knots that are close.
    """
    p, q, r = np.moveaxis(basis, 1, 0)
    cross = np.stack([np.cross(q, r - q), np.cross(r, p - r), np.cross(p, q - p)], axis=1)
    volume = np.einsum("ei,ei->e", p, cross[:, 0])
    size = np.linalg.norm(basis, axis=2).prod(axis=1)
    inverse = np.divide(1.0, volume, out=np.zeros_like(volume), where=np.abs(volume) > _FLAT * size)
    return cross * inverse[:, None, None], np.abs(inverse)


@lru_cache(maxsize=8)
def subset_program(count: int) -> Program:
    """One simplex spline with `count` knots, by all of its subsets; coordinates of least norm, so no choice of a basis.

    Safe for any knots that span R^3.
    """
    states = tuple(s for size in range(3, count + 1) for s in combinations(range(count), size))
    children = {state: {b: tuple(k for k in state if k != b) for b in state} for state in states}
    return _compiled(states, children, [tuple(range(count))])


@lru_cache(maxsize=8)
def cloud_program(degree: int) -> Program:
    """All DMS splines of a triangle (Dahmen, Micchelli, Seidel 1992), with shared steps.

    Knot (degree + 1) i + k is knot k of corner i. Output beta, in the order of the exponents (b1, b2, b3), has the
    knots 0, ..., b_i of every corner i. A step uses the last knot of every corner that has some left; when a corner has
    run out, the first and the last of the larger cloud and the last of the other.
    """
    outputs = [_prefix(degree, (degree - s, s - k, k)) for s in range(degree + 1) for k in range(s + 1)]
    children: dict[Knots, dict[int, Knots]] = {}
    waiting = list(outputs)
    while waiting:
        state = waiting.pop()
        if state not in children:
            chosen = _step_basis(state, degree + 1)
            children[state] = {b: tuple(k for k in state if k != b) for b in chosen}
            waiting += children[state].values() if len(state) > 3 else []
    states = tuple(sorted(children, key=lambda state: (len(state), state)))
    return _compiled(states, children, outputs)


def _prefix(degree: int, beta: tuple[int, int, int]) -> Knots:
    return tuple((degree + 1) * i + k for i, b in enumerate(beta) for k in range(b + 1))


def _step_basis(state: Knots, cloud: int) -> Knots:
    """Three knots that are independent in general position: see `cloud_program`."""
    groups = [[k for k in state if k // cloud == i] for i in range(3)]
    groups = sorted((g for g in groups if g), key=len)
    if len(groups) == 3:
        return tuple(sorted(g[-1] for g in groups))
    if len(groups) == 2:
        return tuple(sorted((groups[1][0], groups[1][-1], groups[0][-1])))
    return groups[0][0], groups[0][1], groups[0][-1]


def _compiled(states: tuple[Knots, ...], children: dict[Knots, dict[int, Knots]], outputs: list[Knots]) -> Program:
    number = {state: n for n, state in enumerate(states)}
    start, child, knot = [0], [], []
    for state in states:
        for b, rest in children[state].items():
            child.append(number[rest] if len(state) > 3 else -1)
            knot.append(b)
        start.append(len(child))
    arrays = (np.array(x, dtype=np.intp) for x in (start, child, knot, [number[o] for o in outputs]))
    return Program(states, *arrays)
