"""Compiled evaluation of simplex splines with their derivatives, by programs of recursion steps."""

from __future__ import annotations

import numpy as np

from orbiframe.compiled import compiled

# Three knots count as spanning a point if they span the point a little beside it, at x + _BESIDE (e1 + 0.6 e2): one
# place for all cones, so that points on knots and on planes through knots lie in exactly one cone of each subdivision.
# A spline of class C^r changes by no more than the power r + 1 of this.
_BESIDE = 1e-10
_TURN = 0.6180339887498949
# The rows of a jet (values, gradient, second and third derivatives) that a row is one derivative more than, and along
# which frame vector.
_LOWER = np.array([0, 0, 0, 1, 2, 2, 3, 4, 5, 5])
_ALONG = np.array([0, 0, 1, 0, 0, 1, 0, 0, 0, 1])


@compiled(inline=True)
def _dot(row, columns, k):  # type: ignore[no-untyped-def]
    return row[0] * columns[0, k] + row[1] * columns[1, k] + row[2] * columns[2, k]


@compiled
def _reaches(bounds, columns):  # type: ignore[no-untyped-def]
    for b in range(len(bounds)):  # noqa: SIM110
        if _dot(bounds[b], columns, 0) < -1e-9:
            return False
    return True


@compiled
def _spanned(rows, first, columns):  # type: ignore[no-untyped-def]
    """Whether three knots span the place beside the point; column 3 holds it."""
    for t in range(first, first + 3):  # noqa: SIM110
        if _dot(rows[t], columns, 3) <= 0:
            return False
    return True


@compiled
def _run(program, rows, height, columns, entries, jets, live):  # type: ignore[no-untyped-def]
    """The jets (states, entries) of all states at one point: M_B = sum lambda_b M_(B - b) and its derivatives
    D_u M_B = (m - 3) sum mu_b M_(B - b), u = sum mu_b b."""
    start, child, orders = program
    for s in range(len(orders)):
        live[s] = False
        if orders[s] == 0:
            if height[s] > 0 and _spanned(rows, start[s], columns):
                live[s] = True
                jets[s, 0] = height[s]
                for e in range(1, entries):
                    jets[s, e] = 0.0
            continue
        for e in range(entries):
            jets[s, e] = 0.0
        for t in range(start[s], start[s + 1]):
            below = child[t]
            if not live[below]:
                continue
            live[s] = True
            jets[s, 0] += _dot(rows[t], columns, 0) * jets[below, 0]
            if entries > 1:
                mu1, mu2 = orders[s] * _dot(rows[t], columns, 1), orders[s] * _dot(rows[t], columns, 2)
                for e in range(1, entries):
                    jets[s, e] += (mu1 if _ALONG[e] == 0 else mu2) * jets[below, _LOWER[e]]


@compiled(inline=True)
def _run_where_reached(bounds, program, rows, height, columns, entries, jets, live):  # type: ignore[no-untyped-def]
    """Whether the functions of a knot set reach a point; if so, the jets of all states are there."""
    if not _reaches(bounds, columns):
        return False
    _run(program, rows, height, columns, entries, jets, live)
    return True


@compiled
def _times_linear(row, columns, jet, entries, out):  # type: ignore[no-untyped-def]
    """The jet of a linear function times F from the jet of F (rule of Leibniz)."""
    at = _dot(row, columns, 0)
    for e in range(entries):
        out[e] = at * jet[e]
    if entries == 1:
        return
    a, b = _dot(row, columns, 1), _dot(row, columns, 2)
    out[1] += a * jet[0]
    out[2] += b * jet[0]
    if entries > 3:
        out[3] += 2 * a * jet[1]
        out[4] += a * jet[2] + b * jet[1]
        out[5] += 2 * b * jet[2]
    if entries > 6:
        out[6] += 3 * a * jet[3]
        out[7] += 2 * a * jet[4] + b * jet[3]
        out[8] += a * jet[5] + 2 * b * jet[4]
        out[9] += 3 * b * jet[5]


@compiled
def _covariant(curvature, degree, jet, out):  # type: ignore[no-untyped-def]
    """Covariant derivatives on X, in the order of `DifferentiableBasis`, from those in R^3 along the frame.

    Hess(u, v) = F_uv - K d F <u, v>; its derivative along w is F_uvw - K (d - 1) (<u, w> F_v + <v, w> F_u) - K d <u, v>
    F_w.
    """
    kinds = len(out)
    for e in range(min(kinds, 6)):
        out[e] = jet[e]
    k = curvature * degree
    if kinds > 3:
        out[3] -= k * jet[0]
        out[5] -= k * jet[0]
    if kinds > 6:
        low = curvature * (degree - 1)
        out[6] = jet[6] - (2 * low + k) * jet[1]
        out[7] = jet[7] - low * jet[2]
        out[8] = jet[8] - k * jet[1]
        out[9] = jet[7] - k * jet[2]
        out[10] = jet[8] - low * jet[1]
        out[11] = jet[9] - (2 * low + k) * jet[2]


@compiled
def _beside(here):  # type: ignore[no-untyped-def]
    for i in range(3):
        here[i, 3] = here[i, 0] + _BESIDE * (here[i, 1] + _TURN * here[i, 2])


@compiled
def _moved(g, columns, here):  # type: ignore[no-untyped-def]
    for k in range(3):
        a, b, c = columns[0, k], columns[1, k], columns[2, k]
        for i in range(3):
            here[i, k] = g[i, 0] * a + g[i, 1] * b + g[i, 2] * c
    _beside(here)


@compiled
def _emit(knot_set, family, s, output, here, jets, entries, shape, product, out):  # type: ignore[no-untyped-def]
    """The covariant jet of one output of a set of knots at a point."""
    factor, lead = family
    jet = jets[s]
    if len(lead):
        _times_linear(lead[knot_set, output], here, jet, entries, product)
        jet = product
    _covariant(shape[0], shape[1], jet, out)
    for kind in range(len(out)):
        out[kind] *= factor[knot_set, output]


@compiled
def fill_columns(place, reach, knot_sets, program, family, row_start, slots, values):  # type: ignore[no-untyped-def]
    """The rows of design matrices: all functions that may be nonzero on the triangle of each point.

    place: number, triangle (n,), columns (n, 3, 3) (point and frame) of each point and (curvature, degree); reach:
    `Reach` as arrays; knot_sets: bounds, rows and heights; program: start, child, orders, outputs; family: factor (E,
    outputs), and rows of linear functions (E, outputs, 3) or (0, 0, 3); slots: where the outputs of a candidate stand
    in its row; values: (kinds, nonzeros), zero before.
    """
    order, face, columns, shape = place
    first, knot_set, isometry = reach
    bounds, rows, height = knot_sets
    start, child, orders, outputs = program
    kinds = len(values)
    entries = kinds if kinds < 12 else 10
    jets, live = np.empty((len(orders), entries)), np.empty(len(orders), dtype=np.bool_)
    here, product, out = np.empty((3, 4)), np.empty(entries), np.empty(kinds)
    for n in range(len(face)):
        for c in range(first[face[n]], first[face[n] + 1]):
            e = knot_set[c]
            _moved(isometry[c], columns[n], here)
            if not _run_where_reached(bounds[e], (start, child, orders), rows[e], height[e], here, entries, jets, live):
                continue
            for o in range(len(outputs)):
                if live[outputs[o]]:
                    _emit(e, family, outputs[o], o, here, jets, entries, shape, product, out)
                    where = row_start[order[n]] + slots[c, o]
                    for kind in range(kinds):
                        values[kind, where] += out[kind]


@compiled
def evaluate(place, reach, knot_sets, program, family, column, coefficients, values):  # type: ignore[no-untyped-def]
    """Jets of functions with given coefficients (size, q): values (kinds, points, q), zero before."""
    order, face, columns, shape = place
    first, knot_set, isometry = reach
    bounds, rows, height = knot_sets
    start, child, orders, outputs = program
    kinds, width = len(values), coefficients.shape[1]
    entries = kinds if kinds < 12 else 10
    jets, live = np.empty((len(orders), entries)), np.empty(len(orders), dtype=np.bool_)
    here, product, out = np.empty((3, 4)), np.empty(entries), np.empty(kinds)
    for n in range(len(face)):
        for c in range(first[face[n]], first[face[n] + 1]):
            e = knot_set[c]
            _moved(isometry[c], columns[n], here)
            if not _run_where_reached(bounds[e], (start, child, orders), rows[e], height[e], here, entries, jets, live):
                continue
            for o in range(len(outputs)):
                if live[outputs[o]]:
                    _emit(e, family, outputs[o], o, here, jets, entries, shape, product, out)
                    for kind in range(kinds):
                        for q in range(width):
                            values[kind, order[n], q] += out[kind] * coefficients[column[e, o], q]
