"""Compiled values of splines: points are located and evaluated in blocks, without arrays of all points in between."""

from __future__ import annotations

import numpy as np

from orbiframe.compiled.decorator import compiled
from orbiframe.splines.bernstein_kernels import fan_triangle, micro_heights, micro_triangle
from orbiframe.triangulations.walks import settled, square_of, walk


@compiled(arrays=False, may_divide_by_zero=True)
def spline_values(points, grid, steps, split, nets, form, work, values):  # type: ignore[no-untyped-def]
    """Values of functions with given Bernstein coefficients; returns the first point without a triangle, or -1.

    points: patches (n,) and x (n, 3); grid and steps: see `Locator`; split: inverses and fans of the micro triangles,
    see `fan_triangle`; nets: (F m, n_d, q); form: the degree, multinomials (n_d,) and whether the last function is W,
    by which the others are divided; work: room for the micro triangles (b,) and coordinates (b, 3) of a block, for n_d
    factors and for powers (3, d + 1); values: (n, q), or (n, q - 1) with W. Each step is a loop of its own over a
    block: while one point waits for memory, or for a branch that could not be foretold, the next ones are under way.
    """
    room = len(work[0])
    for begin in range(0, len(values), room):
        end = min(begin + room, len(values))
        failed = _locate(begin, end, points, grid, steps, split, work)
        if failed >= 0:
            return failed
        _evaluate(begin, end, nets, form, work, values)
    return -1


@compiled(arrays=False, may_divide_by_zero=True)
def _locate(begin, end, points, grid, steps, split, work):  # type: ignore[no-untyped-def]
    """The micro triangles of a block of points, with the barycentric coordinates in them."""
    patch, x = points
    grid_face, g, half_width = grid
    inverse, twin, across, curvature = steps
    micro_inverse, fan, micro_count = split
    micro, coordinates = work[0], work[1]
    sides, squares = grid_face.shape[1], grid_face.shape[2]
    for n in range(begin, end):
        p, x0, x1, x2, k = patch[n], x[n, 0], x[n, 1], x[n, 2], n - begin
        if not abs(x0) + abs(x1) + abs(x2) < np.inf:
            return n
        i, j = square_of(x0, x1, x2, half_width[p], squares)
        s = 1 if sides > 1 and x0 < 0 else 0
        micro[k] = grid_face[p, s, i, j]
        for row in range(3):
            y = g[p, s, i, j, row, 0] * x0 + g[p, s, i, j, row, 1] * x1 + g[p, s, i, j, row, 2] * x2
            coordinates[k, row] = y
    for k in range(end - begin):
        y0, y1, y2 = settled(curvature, coordinates[k, 0], coordinates[k, 1], coordinates[k, 2])
        f, y0, y1, y2, a, b, c = walk(micro[k], y0, y1, y2, inverse, twin, across, curvature)
        if f < 0:
            return begin + k
        if fan.shape[1] == 0:
            m = micro_triangle(micro_inverse, f, y0, y1, y2)
            a, b, c = micro_heights(micro_inverse, f, m, y0, y1, y2)
            micro[k] = f * micro_count + m
        else:
            micro[k] = f
        coordinates[k, 0], coordinates[k, 1], coordinates[k, 2] = a, b, c
    if fan.shape[1] > 0:
        for k in range(end - begin):
            f = micro[k]
            m, a, b, c = fan_triangle(fan, f, coordinates[k, 0], coordinates[k, 1], coordinates[k, 2])
            micro[k] = f * micro_count + m
            coordinates[k, 0], coordinates[k, 1], coordinates[k, 2] = a, b, c
    return -1


@compiled(arrays=False, may_divide_by_zero=True)
def _evaluate(begin, end, nets, form, work, values):  # type: ignore[no-untyped-def]
    """The values at a block of points by tabulated powers of their coordinates."""
    degree, multinomials, rational = form
    micro, coordinates, factors, powers = work
    count, width = nets.shape[1], values.shape[1]
    powers[0, 0] = powers[1, 0] = powers[2, 0] = 1.0
    for n in range(begin, end):
        f = micro[n - begin]
        a, b, c = coordinates[n - begin, 0], coordinates[n - begin, 1], coordinates[n - begin, 2]
        for k in range(degree):
            powers[0, k + 1] = powers[0, k] * a
            powers[1, k + 1] = powers[1, k] * b
            powers[2, k + 1] = powers[2, k] * c
        k = 0
        for total in range(degree + 1):
            for third in range(total + 1):
                product = powers[0, degree - total] * powers[1, total - third] * powers[2, third]
                factors[k] = multinomials[k] * product
                k += 1
        scale = 1.0
        if rational:
            weight = 0.0
            for k in range(count):
                weight += factors[k] * nets[f, k, width]
            scale = 1 / weight
        for q in range(width):
            value = 0.0
            for k in range(count):
                value += factors[k] * nets[f, k, q]
            values[n, q] = value * scale
