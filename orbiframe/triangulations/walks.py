"""Walks: points of X go from triangle to triangle, across the edge that they are farthest beyond."""

from __future__ import annotations

import numpy as np

from orbiframe.compiled.decorator import compiled
from orbiframe.compiled.matrices import copy

_MOST_STEPS = 1_000_000
# A point this far beyond an edge, in barycentric coordinates, still counts as inside: no point goes back and forth.
_ON_EDGE = 1e-12


@compiled(may_divide_by_zero=True, inline=True)
def _way_out(inverse, face, x0, x1, x2):  # type: ignore[no-untyped-def]
    """The barycentric coordinates of a point, and the edge that it is farthest beyond; -1: inside, -2: not finite."""
    a = inverse[face, 0, 0] * x0 + inverse[face, 0, 1] * x1 + inverse[face, 0, 2] * x2
    b = inverse[face, 1, 0] * x0 + inverse[face, 1, 1] * x1 + inverse[face, 1, 2] * x2
    c = inverse[face, 2, 0] * x0 + inverse[face, 2, 1] * x1 + inverse[face, 2, 2] * x2
    total = abs(a + b + c)
    least = min(a, min(b, c))
    # Edge c lies opposite corner c + 2.
    way = 1 if least == a else 2 if least == b else 0
    if least >= -_ON_EDGE * total:
        way = -1
    elif not total < np.inf:
        way = -2
    return a, b, c, way


@compiled(may_divide_by_zero=True, inline=True)
def _carried(g, x0, x1, x2):  # type: ignore[no-untyped-def]
    """g x, as three numbers."""
    return (
        g[0, 0] * x0 + g[0, 1] * x1 + g[0, 2] * x2,
        g[1, 0] * x0 + g[1, 1] * x1 + g[1, 2] * x2,
        g[2, 0] * x0 + g[2, 1] * x1 + g[2, 2] * x2,
    )


@compiled(may_divide_by_zero=True, inline=True)
def settled(curvature, x0, x1, x2):  # type: ignore[no-untyped-def]
    """A point that has drifted off X by rounding, put back: as `Geometry.settle` does it."""
    if curvature < 0:
        x0 = np.sqrt(1 + x1 * x1 + x2 * x2)
    elif curvature > 0:
        scale = 1 / np.sqrt(x0 * x0 + x1 * x1 + x2 * x2)
        x0, x1, x2 = x0 * scale, x1 * scale, x2 * scale
    return x0, x1, x2


@compiled(may_divide_by_zero=True)
def _settle_frame(curvature, first, columns):  # type: ignore[no-untyped-def]
    """Make columns `first` to `first` + 2 an orthonormal frame again, a point of X and two tangent vectors there.

    The turn from the frame that the translation from the origin carries to the point, found from the two vectors, is
    made a turn again: so errors are those of the point and of one angle, and do not grow from step to step.
    """
    p0, p1, p2 = settled(curvature, columns[0, first], columns[1, first], columns[2, first])
    columns[0, first], columns[1, first], columns[2, first] = p0, p1, p2
    if curvature > 0 and p0 < 0:
        # The translation from the origin is uncertain near its antipode; there the frame is turned over.
        _settle_by_products(columns, first)
        return
    # The columns of the translation: t_i = e_i - K p_i e_0 - K p_i (p - e_0) ... / (1 + p_0), in closed form.
    share = curvature / (1 + p0)
    a0, a1, a2 = -curvature * p1, 1 - share * p1 * p1, -share * p1 * p2
    b0, b1, b2 = -curvature * p2, -share * p1 * p2, 1 - share * p2 * p2
    u0, u1, u2 = columns[0, first + 1], columns[1, first + 1], columns[2, first + 1]
    v0, v1, v2 = columns[0, first + 2], columns[1, first + 2], columns[2, first + 2]
    k = curvature
    cosine = k * u0 * a0 + u1 * a1 + u2 * a2
    sine = k * u0 * b0 + u1 * b1 + u2 * b2
    side = cosine * (k * v0 * b0 + v1 * b1 + v2 * b2) - sine * (k * v0 * a0 + v1 * a1 + v2 * a2)
    length = np.sqrt(cosine * cosine + sine * sine)
    cosine, sine = cosine / length, sine / length
    turn = 1.0 if side > 0 else -1.0
    columns[0, first + 1] = cosine * a0 + sine * b0
    columns[1, first + 1] = cosine * a1 + sine * b1
    columns[2, first + 1] = cosine * a2 + sine * b2
    columns[0, first + 2] = turn * (cosine * b0 - sine * a0)
    columns[1, first + 2] = turn * (cosine * b1 - sine * a1)
    columns[2, first + 2] = turn * (cosine * b2 - sine * a2)


@compiled(may_divide_by_zero=True)
def _settle_by_products(columns, first):  # type: ignore[no-untyped-def]
    """Gram and Schmidt's orthonormal vectors on the sphere, where no number is large."""
    for later in (1, 2):
        for before in range(later):
            product = 0.0
            for row in range(3):
                product += columns[row, first + before] * columns[row, first + later]
            for row in range(3):
                columns[row, first + later] -= product * columns[row, first + before]
        length = 0.0
        for row in range(3):
            length += columns[row, first + later] ** 2
        for row in range(3):
            columns[row, first + later] /= np.sqrt(length)


@compiled
def _walk_one(face, columns, inverse, twin, across, curvature):  # type: ignore[no-untyped-def]
    """Move columns (3, m), the first a point, from triangle to triangle until it is inside; the last one, or -1.

    The point is settled at every step: else it drifts off X the faster the farther it is from where it began.
    """
    for _ in range(_MOST_STEPS):
        _, _, _, way = _way_out(inverse, face, columns[0, 0], columns[1, 0], columns[2, 0])
        if way < 0:
            return face if way == -1 else -1
        edge = 3 * face + way
        for k in range(columns.shape[1]):
            columns[0, k], columns[1, k], columns[2, k] = _carried(
                across[edge], columns[0, k], columns[1, k], columns[2, k]
            )
        columns[0, 0], columns[1, 0], columns[2, 0] = settled(curvature, columns[0, 0], columns[1, 0], columns[2, 0])
        face = twin[edge] // 3
    return -1


@compiled(may_divide_by_zero=True, inline=True)
def square_of(x0, x1, x2, half_width, squares):  # type: ignore[no-untyped-def]
    """The square of the grid, of `squares` times `squares`, in which a point of a patch lies, or the nearest one."""
    scale = squares / (2 * half_width * (1 + abs(x0)))
    i = min(max(int(x1 * scale + squares / 2), 0), squares - 1)
    j = min(max(int(x2 * scale + squares / 2), 0), squares - 1)
    return i, j


@compiled(may_divide_by_zero=True, inline=True)
def walk(face, x0, x1, x2, inverse, twin, across, curvature):  # type: ignore[no-untyped-def]
    """From triangle to triangle until the point is inside: face, the point in its frame, barycentric coordinates.

    The face is -1 where no triangle holds the point.
    """
    for _ in range(_MOST_STEPS):
        a, b, c, way = _way_out(inverse, face, x0, x1, x2)
        if way == -1:
            return face, x0, x1, x2, a, b, c
        if way < 0:
            break
        x0, x1, x2 = _carried(across[3 * face + way], x0, x1, x2)
        x0, x1, x2 = settled(curvature, x0, x1, x2)
        face = twin[3 * face + way] // 3
    return -1, x0, x1, x2, 0.0, 0.0, 0.0


@compiled
def order_by_square(patch, x, half_width, shape, order):  # type: ignore[no-untyped-def]
    """Sort the numbers of the points by the squares of the grid, counting."""
    sides, squares = shape[1], shape[2]
    key = np.empty(len(patch), dtype=np.int32)
    start = np.zeros(shape[0] * sides * squares * squares + 1, dtype=np.int64)
    for n in range(len(patch)):
        x0, x1, x2 = x[n, 0], x[n, 1], x[n, 2]
        i, j = 0, 0
        if np.isfinite(x0) and np.isfinite(x1) and np.isfinite(x2):
            i, j = square_of(x0, x1, x2, half_width[patch[n]], squares)
        side = 1 if sides > 1 and x0 < 0 else 0
        key[n] = ((patch[n] * sides + side) * squares + i) * squares + j
        start[key[n] + 1] += 1
    for k in range(1, len(start)):
        start[k] += start[k - 1]
    for n in range(len(patch)):
        order[start[key[n]]] = n
        start[key[n]] += 1


@compiled
def walk_all(patch, face, moved, steps, grid):  # type: ignore[no-untyped-def]
    """Locate every point; returns the first that has no triangle, or -1."""
    grid_face, grid_isometry, half_width = grid
    inverse, twin, across, curvature = steps
    squares, width = grid_face.shape[2], moved.shape[2]
    for n in range(len(patch)):
        p, columns = patch[n], moved[n]
        if not (np.isfinite(columns[0, 0]) and np.isfinite(columns[1, 0]) and np.isfinite(columns[2, 0])):
            return n
        i, j = square_of(columns[0, 0], columns[1, 0], columns[2, 0], half_width[p], squares)
        side = 1 if grid_face.shape[1] > 1 and columns[0, 0] < 0 else 0
        g = grid_isometry[p, side, i, j]
        for k in range(width):
            a, b, c = columns[0, k], columns[1, k], columns[2, k]
            for row in range(3):
                columns[row, k] = g[row, 0] * a + g[row, 1] * b + g[row, 2] * c
        columns[0, 0], columns[1, 0], columns[2, 0] = settled(curvature, columns[0, 0], columns[1, 0], columns[2, 0])
        face[n] = _walk_one(grid_face[p, side, i, j], columns, inverse, twin, across, curvature)
        if face[n] < 0:
            return n
        if width == 3:
            _settle_frame(curvature, 0, columns)
    return -1


@compiled
def _centre(curvature, i, j, squares, half_width):  # type: ignore[no-untyped-def]
    """The middle of a square as a point of X; in H^2 and E^2 not beyond the patch, in S^2 on the side x0 > 0."""
    u = ((2 * i + 1) / squares - 1) * half_width
    v = ((2 * j + 1) / squares - 1) * half_width
    radius = np.sqrt(u * u + v * v)
    if radius > half_width:
        u, v, radius = u * half_width / radius, v * half_width / radius, half_width
    square = curvature * radius * radius
    if curvature == 0:
        return 1.0, 2 * u, 2 * v
    return (1 - square) / (1 + square), 2 * u / (1 + square), 2 * v / (1 + square)


@compiled
def fill_grid(seed, isometry, steps, grid_face, grid_isometry, half_width):  # type: ignore[no-untyped-def]
    """The triangle at the centre of every square: every row starts from the row before, so that no walk is long.

    The isometries are products along the rows, and made isometries again at every square.
    """
    inverse, twin, across, curvature = steps
    squares = grid_face.shape[2]
    columns, g, row_isometry = np.empty((3, 4)), np.empty((3, 3)), np.empty((3, 3))
    for p in range(len(seed)):
        for side in range(grid_face.shape[1]):
            row_face = seed[p]
            copy(isometry[p], row_isometry)
            for i in range(squares):
                face = row_face
                copy(row_isometry, g)
                for j in range(squares):
                    x0, x1, x2 = _centre(curvature, i, j, squares, half_width[p])
                    x0 = -x0 if side else x0
                    for row in range(3):
                        columns[row, 0] = g[row, 0] * x0 + g[row, 1] * x1 + g[row, 2] * x2
                        columns[row, 1], columns[row, 2], columns[row, 3] = g[row, 0], g[row, 1], g[row, 2]
                    columns[0, 0], columns[1, 0], columns[2, 0] = settled(
                        curvature, columns[0, 0], columns[1, 0], columns[2, 0]
                    )
                    face = _walk_one(face, columns, inverse, twin, across, curvature)
                    _settle_frame(curvature, 1, columns)
                    for row in range(3):
                        g[row, 0], g[row, 1], g[row, 2] = columns[row, 1], columns[row, 2], columns[row, 3]
                    grid_face[p, side, i, j] = face
                    copy(g, grid_isometry[p, side, i, j])
                    if j == 0:
                        row_face = face
                        copy(g, row_isometry)


@compiled
def refill(source, known, steps, grid_face, grid_isometry, half_width):  # type: ignore[no-untyped-def]
    """Reach the squares that are not known from others, whose rows and columns `source` holds, (2, n, n)."""
    inverse, twin, across, curvature = steps
    squares = len(grid_face)
    columns = np.empty((3, 4))
    for i in range(squares):
        for j in range(squares):
            if known[i, j]:
                continue
            g, face = grid_isometry[source[0, i, j], source[1, i, j]], grid_face[source[0, i, j], source[1, i, j]]
            x0, x1, x2 = _centre(curvature, i, j, squares, half_width)
            for row in range(3):
                columns[row, 0] = g[row, 0] * x0 + g[row, 1] * x1 + g[row, 2] * x2
                columns[row, 1], columns[row, 2], columns[row, 3] = g[row, 0], g[row, 1], g[row, 2]
            columns[0, 0], columns[1, 0], columns[2, 0] = settled(
                curvature, columns[0, 0], columns[1, 0], columns[2, 0]
            )
            grid_face[i, j] = _walk_one(face, columns, inverse, twin, across, curvature)
            _settle_frame(curvature, 1, columns)
            for row in range(3):
                for k in range(3):
                    grid_isometry[i, j, row, k] = columns[row, k + 1]
