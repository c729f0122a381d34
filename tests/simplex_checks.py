"""What bases of simplex splines are checked with: polynomials by blossoms, jumps along geodesics."""

from __future__ import annotations

from collections.abc import Callable
from itertools import permutations

import mpmath
import numpy as np
from orbiframe_bases.simplex_kernels import _beside, _run
from orbiframe_bases.simplex_splines import SimplexSplines

from orbiframe import Points
from orbiframe.compiled import compiled

Arguments = Callable[[int, int], list[int]]


def recursion(x: np.ndarray, knots: np.ndarray, *, absolute: bool = True) -> float:
    """The definition, step by step in many digits: the first three independent knots are the basis of a step.

    absolute: False divides by the signed determinant, as the paper has it.
    """
    with mpmath.workdps(40):
        return float(_recursion(mpmath.matrix(x.tolist()), [mpmath.matrix(k.tolist()) for k in knots], absolute))


def _recursion(x: mpmath.matrix, knots: list[mpmath.matrix], absolute: bool) -> mpmath.mpf:
    for t in [(i, j, k) for k in range(len(knots)) for j in range(k) for i in range(j)]:
        basis = mpmath.matrix(3, 3)
        for column, b in enumerate(t):
            basis[:, column] = knots[b]
        volume = mpmath.det(basis)
        if abs(volume) > 1e-25:
            break
    else:
        return mpmath.mpf(0)
    coordinates = mpmath.lu_solve(basis, x)
    if len(knots) == 3:
        return 1 / (abs(volume) if absolute else volume) if min(coordinates) > 0 else mpmath.mpf(0)
    parts = [(c, knots[:b] + knots[b + 1 :]) for c, b in zip(coordinates, t, strict=True)]
    return sum((c * _recursion(x, rest, absolute) for c, rest in parts), mpmath.mpf(0))


def polynomial(forms: np.ndarray, x: np.ndarray) -> np.ndarray:
    """The product of linear forms (d, 3) at x (..., 3)."""
    return np.prod(x @ forms.T, axis=-1)


def polarised(forms: np.ndarray, arguments: np.ndarray) -> float:
    """The blossom of that product at d arguments (d, 3)."""
    table = forms @ arguments.T
    orders = list(permutations(range(len(forms))))
    return float(np.mean([np.prod(table[np.arange(len(forms)), list(order)]) for order in orders]))


def reproduction_error(basis: SimplexSplines, arguments: Arguments, rng: np.random.Generator) -> float:
    """How far the function whose coefficients are blossoms is from its polynomial, on triangles where it can be told.

    The polynomial is one of the frame of a triangle; the functions that reach that triangle are seen from there. Where
    one function reaches it through two lifts it has no one coefficient, and the triangle is left out.
    """
    domain, sets = basis.domain, basis.knot_sets
    first, element, isometry = basis._reach
    back = domain.geometry.inverse(isometry)
    errors = []
    for face in rng.permutation(domain.face_count)[:6]:
        forms = rng.normal(size=(basis.degree, 3))
        coefficients, clear = np.full(basis.size, np.nan), True
        for c in range(first[face], first[face + 1]):
            knots = sets.knots[element[c]] @ back[c].T
            for o in range(sets.column.shape[1]):
                column = sets.column[element[c], o]
                if sets.factor[element[c], o] == 0:
                    continue
                value = polarised(forms, knots[arguments(element[c], o)])
                clear &= bool(np.isnan(coefficients[column]) or abs(coefficients[column] - value) < 1e-6)
                coefficients[column] = value
        if clear:
            x = domain.geometry.project(rng.dirichlet(np.ones(3), 20) @ domain.corners[face])
            there = Points(np.full(20, domain.patch[face]), x @ domain.placement[face].T)
            weights, basis.weights = basis.weights, None
            found = basis.values(there, np.nan_to_num(coefficients)[:, None])[:, 0]
            basis.weights = weights
            exact = polynomial(forms, x)
            errors.append(np.abs(found - exact).max() / np.abs(exact).max())
    assert errors, "on no triangle is it clear what the coefficients are"
    return float(max(errors))


def jump(basis: SimplexSplines, order: int) -> float:
    """The largest change of a derivative along geodesics within 1e-6, against the largest within 1e-3.

    The place where it changes most within 1e-3 is looked at a thousand times as closely: about 1e-3 for a derivative
    that has a derivative, 1 for a jump.
    """
    rng = np.random.default_rng(3)
    coefficients = rng.normal(size=(basis.size, 1))
    found = []
    for face in rng.permutation(basis.domain.face_count)[:4]:
        t = np.arange(0, 0.5, 1e-3)
        coarse = np.abs(np.diff(_along(basis, coefficients, face, t, order)))
        worst = int(coarse.argmax())
        fine = np.abs(np.diff(_along(basis, coefficients, face, t[worst] + 1e-6 * np.arange(1001), order)))
        found.append((coarse.max(), fine.max()))
    coarse, fine = max(found)
    return float(fine / coarse)


def _along(basis: SimplexSplines, coefficients: np.ndarray, face: int, t: np.ndarray, order: int) -> np.ndarray:
    """The derivative of one order, at times t, along the geodesic that leaves the middle of a triangle."""
    domain, geometry = basis.domain, basis.domain.geometry
    start = geometry.project(domain.corners[face].sum(axis=0)) @ domain.placement[face].T
    direction = geometry.frame(start) @ np.array([0.8, 0.6])
    x = geometry.exp(start, t[:, None] * direction)
    jets = basis.jets(Points(np.full(len(x), domain.patch[face]), x), coefficients, order)[..., 0]
    ahead = geometry.log(x, geometry.exp(start, (t + 0.1)[:, None] * direction))
    frame = np.swapaxes(geometry.frame(x), 1, 2)
    speed = geometry.inner(x[:, None], frame, ahead[:, None]) / geometry.norm(x, ahead)[:, None]
    a, b = speed.T

    def second(first: int) -> np.ndarray:
        return a * a * jets[first] + 2 * a * b * jets[first + 1] + b * b * jets[first + 2]

    if order < 2:
        return np.asarray(jets[0] if order == 0 else a * jets[1] + b * jets[2])
    return second(3) if order == 2 else a * second(6) + b * second(9)


@compiled
def simplex_splines(program, rows, height, columns, values):
    """The jets in R^3 of the outputs of a program for one set of knots: values (n, outputs, 1, 3, 6 or 10).

    columns: (n, 3, 3), points and two directions; rows and heights of the one set.
    """
    start, child, orders, outputs = program
    entries = values.shape[2]
    jets, live = np.empty((len(orders), entries)), np.empty(len(orders), dtype=np.bool_)
    here = np.empty((3, 4))
    for n in range(len(columns)):
        for i in range(3):
            for j in range(3):
                here[i, j] = columns[n, i, j]
        _beside(here)
        _run((start, child, orders), rows, height, here, entries, jets, live)
        for o in range(len(outputs)):
            for e in range(entries):
                values[n, o, e] = jets[outputs[o], e] if live[outputs[o]] else 0.0
