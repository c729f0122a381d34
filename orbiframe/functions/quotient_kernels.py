"""Compiled jets of orbit sums over the sum of all: row by row, from pairs of a point and a lift that reaches it.

A row has the jets of f(c / c_i) for each pair, from D c and Hess c = (1 - K c) g, adds those of several lifts of one
centre, and divides by the jets of the sum of all by the rules of Leibniz, as `divide_jets` does.
"""

from __future__ import annotations

import numpy as np

from orbiframe.compiled.decorator import compiled

# A sum of all functions smaller than this is none.
_TINY = np.finfo(np.float64).tiny


@compiled(arrays=False, may_divide_by_zero=True)
def quotient_rows(curvature, pairs, profile, place, there, column, jets, total):  # type: ignore[no-untyped-def]
    """The jets of all functions at each point; returns the first row that no function reaches, or -1.

    pairs: start (r + 1,), column (p,), versine (p,), slope (p, 2), support (N,); profile: f, f', f'' and f''' (p,),
    those that are needed; place: (r + 1,), where each row begins in jets (m, q), m = 1, 3, 6 or 12 by the order; there:
    (r,), where it begins in column; total: room for m numbers.
    """
    for i in range(len(place) - 1):
        end = _merged_row(curvature, pairs, profile, i, there[i], column, place[i], jets)
        if not _divided(jets, place[i], end, total):
            return i
    return -1


@compiled(arrays=False, may_divide_by_zero=True)
def quotient_values(curvature, pairs, profile, rows, room, coefficients, values):  # type: ignore[no-untyped-def]
    """The jets of combinations of the functions, (m, n, q), in the given rows (r,); returns as `quotient_rows`.

    coefficients: (N, q); room: for the columns (w,) and the jets (m, w) of one row, and for their sum (m,).
    """
    column, jets, total = room
    for i in range(len(rows)):
        end = _merged_row(curvature, pairs, profile, i, 0, column, 0, jets)
        if not _divided(jets, 0, end, total):
            return i
        for kind in range(len(jets)):
            for d in range(coefficients.shape[1]):
                value = 0.0
                for k in range(end):
                    value += jets[kind, k] * coefficients[column[k], d]
                values[kind, rows[i], d] = value
    return -1


@compiled(arrays=False)
def merged_counts(start, column, count):  # type: ignore[no-untyped-def]
    """How many different columns, which stand side by side where they are equal, each row has."""
    for i in range(len(count)):
        count[i] = 0
        for k in range(start[i], start[i + 1]):
            if k == start[i] or column[k] != column[k - 1]:
                count[i] += 1


@compiled(arrays=False)
def put_rows(values, start, there, target):  # type: ignore[no-untyped-def]
    """Copy the rows of values, which begin at start (r + 1,), to where they begin in the target."""
    for i in range(len(there)):
        shift = there[i] - start[i]
        for k in range(start[i], start[i + 1]):
            target[k + shift] = values[k]


@compiled(arrays=False, may_divide_by_zero=True)
def _merged_row(curvature, pairs, profile, i, there, column, begin, jets):  # type: ignore[no-untyped-def]
    """Write columns from `there` on and jets from `begin` on, of the sums over lifts of row i; returns their end."""
    start, centre, versine, slope, support = pairs
    f, df, ddf, third = profile
    place = begin - 1
    for k in range(start[i], start[i + 1]):
        if k == start[i] or centre[k] != centre[k - 1]:
            place += 1
            column[there + place - begin] = centre[k]
            for kind in range(len(jets)):
                jets[kind, place] = 0.0
        jets[0, place] += f[k]
        if len(jets) == 1:
            continue
        c1, c2, share = slope[k, 0], slope[k, 1], 1 / support[centre[k]]
        first = df[k] * share
        jets[1, place] += first * c1
        jets[2, place] += first * c2
        if len(jets) == 3:
            continue
        second, turn = ddf[k] * share * share, 1 - curvature * versine[k]
        trace = first * turn
        jets[3, place] += second * c1 * c1 + trace
        jets[4, place] += second * c1 * c2
        jets[5, place] += second * c2 * c2 + trace
        if len(jets) == 6:
            continue
        # D_w Hess c = -K c_w g, so the derivative of the Hessian of f(c) is f''' c_u c_v c_w
        # + f'' (1 - K c)(c_w <u, v> + c_u <v, w> + c_v <u, w>) - f' K c_w <u, v>.
        bent, most = second * turn, third[k] * share * share * share
        drift = bent - curvature * first
        jets[6, place] += (most * c1 * c1 + drift + 2 * bent) * c1
        jets[7, place] += (most * c1 * c1 + bent) * c2
        jets[8, place] += (most * c2 * c2 + drift) * c1
        jets[9, place] += (most * c1 * c1 + drift) * c2
        jets[10, place] += (most * c2 * c2 + bent) * c1
        jets[11, place] += (most * c2 * c2 + drift + 2 * bent) * c2
    return place + 1


@compiled(arrays=False, may_divide_by_zero=True)
def _divided(jets, begin, end, w):  # type: ignore[no-untyped-def]
    """Divide the jets of one row by those of their sum, for which w (m,) is room; False where there is no sum."""
    for kind in range(len(jets)):
        w[kind] = 0.0
        for k in range(begin, end):
            w[kind] += jets[kind, k]
    if not w[0] >= _TINY:
        return False
    share = 1 / w[0]
    for kind in range(len(jets)):
        w[kind] *= share
        for k in range(begin, end):
            jets[kind, k] *= share
    for k in range(begin, end if len(jets) > 1 else begin):
        jets[1, k] -= jets[0, k] * w[1]
        jets[2, k] -= jets[0, k] * w[2]
    for k in range(begin, end if len(jets) > 3 else begin):
        jets[3, k] -= 2 * jets[1, k] * w[1] + jets[0, k] * w[3]
        jets[4, k] -= jets[1, k] * w[2] + jets[2, k] * w[1] + jets[0, k] * w[4]
        jets[5, k] -= 2 * jets[2, k] * w[2] + jets[0, k] * w[5]
    for k in range(begin, end if len(jets) > 6 else begin):
        one, other = _mixed(jets, w, k, 1, 3), _mixed(jets, w, k, 2, 5)
        across, along = _mixed(jets, w, k, 1, 4), _mixed(jets, w, k, 2, 4)
        jets[6, k] -= 3 * one + jets[0, k] * w[6]
        jets[7, k] -= 2 * across + _mixed(jets, w, k, 2, 3) + jets[0, k] * w[7]
        jets[8, k] -= 2 * along + _mixed(jets, w, k, 1, 5) + jets[0, k] * w[8]
        jets[9, k] -= 2 * across + _mixed(jets, w, k, 2, 3) + jets[0, k] * w[9]
        jets[10, k] -= 2 * along + _mixed(jets, w, k, 1, 5) + jets[0, k] * w[10]
        jets[11, k] -= 3 * other + jets[0, k] * w[11]
    return True


@compiled(inline=True)
def _mixed(jets, w, k, one, two):  # type: ignore[no-untyped-def]
    """What a first and a second derivative of the quotient and of the sum add to a third one."""
    return jets[one, k] * w[two] + jets[two, k] * w[one]
