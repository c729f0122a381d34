"""The laws of a plane of constant curvature."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from orbiframe.planes.geometry import Geometry
from orbiframe.testing.lab import Lab

Floats = NDArray[np.float64]
Component = Callable[[], Geometry]

# sin, the identity, sinh by curvature; written out because they are the anchor outside of the component.
_SINE: dict[int, Callable[[Floats], Floats]] = {1: np.sin, 0: np.asarray, -1: np.sinh}

# Points are tried up to this distance from the origin; rounding errors grow like cosh^2 of it.
_REACH = 1.4
_TOLERANCE = 1e-12


def points_have_no_defect(component: Component, lab: Lab) -> None:
    """Points made by polar coordinates, projection, settling and geodesics lie on X; other points do not."""
    geometry = component()
    x = _points(geometry, lab, 20)
    _small(geometry.point_defect(x))
    _close(geometry.project(x * lab.rng.uniform(0.5, 2.0, (20, 1))), x)
    _close(geometry.settle(x * (1 + 1e-14)), x)
    _small(geometry.point_defect(geometry.exp(x, _tangents(geometry, lab, x))))
    assert (geometry.point_defect(1.1 * x) > 0.01).all(), "a point 10 % off X has no defect"


def distance_is_a_metric(component: Component, lab: Lab) -> None:
    """Distance is symmetric, zero only between equal points, and keeps the triangle inequality."""
    geometry = component()
    x, y, z = (_points(geometry, lab, 40) for _ in range(3))
    y[:8] = geometry.geodesic(x[:8], z[:8], 0.5)
    _close(geometry.distance(x, y), geometry.distance(y, x))
    assert (geometry.distance(x, x) == 0).all(), "a point has a distance from itself"
    assert (geometry.distance(x, y) > 0).all(), "two points have no distance"
    assert (geometry.distance(x, z) <= geometry.distance(x, y) + geometry.distance(y, z) + _TOLERANCE).all()


def versine_is_the_smooth_distance(component: Component, lab: Lab) -> None:
    """The versine is 1 - cos d, d^2/2 or cosh d - 1, also for points 1e-9 apart."""
    geometry = component()
    x = _points(geometry, lab, 20)
    length = np.geomspace(1e-9, 1.5, 20)
    y = geometry.exp(x, length[:, None] * _directions(geometry, lab, x))
    _close(geometry.versine(x, y) / (2 * _sine(geometry, length / 2) ** 2), np.ones(20), 1e-6)


def small_distances_keep_their_digits(component: Component, lab: Lab) -> None:
    """Points from 1e-9 to 1 apart have that distance to twelve digits at the origin, and to rounding elsewhere."""
    geometry = component()
    length = np.geomspace(1e-9, 1.0, 20)
    near = geometry.from_polar(length, lab.rng.uniform(-np.pi, np.pi, 20))
    _close(geometry.distance(geometry.origin, near) / length, np.ones(20), 1e-12)
    x = _points(geometry, lab, 20)
    y = geometry.exp(x, length[:, None] * _directions(geometry, lab, x))
    # A point of size e^r that is rounded is off by 1e-16 e^r.
    _close(np.abs(geometry.distance(x, y) - length), np.zeros(20), 1e-14)


def distance_is_the_length_of_the_geodesic(component: Component, lab: Lab) -> None:
    """The steps of a finely divided geodesic, measured by the scalar product, add up to the distance of its ends."""
    geometry = component()
    x, y = (_points(geometry, lab, 10) for _ in range(2))
    path = geometry.geodesic(x, y, np.linspace(0, 1, 401)[:, None])
    _close(path[-1], y)
    # A chord is tangent in the middle of its points.
    step, middle = np.diff(path, axis=0), geometry.project(path[1:] + path[:-1])
    steps = np.sqrt(geometry.inner(middle, step, step))
    _close(steps.sum(axis=0), geometry.distance(x, y), 1e-5)


def log_inverts_exp(component: Component, lab: Lab) -> None:
    """exp(x, log(x, y)) = y, log(x, exp(x, v)) = v, and log(x, y) is tangent and as long as the distance."""
    geometry = component()
    x, y = (_points(geometry, lab, 20) for _ in range(2))
    v = _tangents(geometry, lab, x)
    _close(geometry.exp(x, geometry.log(x, y)), y)
    _close(geometry.log(x, geometry.exp(x, v)), v)
    _close(geometry.norm(x, geometry.log(x, y)), geometry.distance(x, y))


def polar_radius_is_distance(component: Component, lab: Lab) -> None:
    """from_polar(r, a) is (C(r), S(r) cos a, S(r) sin a) with the cosine and sine of the curvature, at distance r."""
    geometry = component()
    r, a = lab.rng.uniform(0, _REACH, 20), lab.rng.uniform(-4, 4, 20)
    cosine = 1 - 2 * geometry.curvature * _sine(geometry, r / 2) ** 2
    sine = _sine(geometry, r)
    _close(geometry.from_polar(r, a), np.stack([cosine, sine * np.cos(a), sine * np.sin(a)], axis=-1))
    _close(geometry.distance(geometry.origin, geometry.from_polar(r, a)), r)


def angle_excess_is_curvature_times_area(component: Component, lab: Lab) -> None:
    """The angles of a triangle exceed pi by curvature times area, the area being summed from small Heron triangles."""
    geometry = component()
    x, y, z = (_points(geometry, lab, 1)[0] for _ in range(3))
    excess = sum(abs(float(geometry.angle(*corner))) for corner in ((x, y, z), (y, z, x), (z, x, y))) - np.pi
    area = _heron_sum(geometry, x, y, z, 40)
    _close(np.array(excess), np.array(geometry.curvature * area), 2e-2 * area)
    _close(np.abs(geometry.triangle_area(x, y, z)), np.array(area), 2e-2 * area)


def turn_is_a_quarter_turn(component: Component, lab: Lab) -> None:
    """turn is a rotation of the tangent plane by +90 degrees: an isometry, perpendicular, minus one when repeated."""
    geometry = component()
    x = _points(geometry, lab, 20)
    v = _tangents(geometry, lab, x)
    turned = geometry.turn(x, v)
    _small(geometry.inner(x, v, turned))
    _close(geometry.norm(x, turned), geometry.norm(x, v))
    _close(geometry.turn(x, turned), -v)
    _close(geometry.turn(geometry.origin, [0.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0]))
    _close(geometry.turn(x, geometry.frame(x)[..., 0]), geometry.frame(x)[..., 1])


def isometries_preserve_distance(component: Component, lab: Lab) -> None:
    """Translations, rotations and reflections preserve distance; inverse and nearest_isometry belong to them."""
    geometry = component()
    x, y = (_points(geometry, lab, 20) for _ in range(2))
    g = _isometries(geometry, lab, 20)
    _small(geometry.isometry_defect(g))
    _close(geometry.distance(geometry.act(g, x), geometry.act(g, y)), geometry.distance(x, y))
    _close(geometry.inverse(g) @ g, np.broadcast_to(np.eye(3), g.shape))
    _close(geometry.nearest_isometry(g), g)
    _small(geometry.isometry_defect(geometry.nearest_isometry(g + 1e-6 * lab.rng.standard_normal(g.shape))))
    assert (geometry.isometry_defect(1.01 * g) > 1e-3).all(), "a matrix 1 % off has no defect"


def operations_broadcast(component: Component, lab: Lab) -> None:
    """Leading axes broadcast: a column of 4 points and a row of 5 give a table of 4 by 5."""
    geometry = component()
    x, y = _points(geometry, lab, 4)[:, None], _points(geometry, lab, 5)
    v = _tangents(geometry, lab, x)
    for name in ("distance", "versine"):
        _shape(name, getattr(geometry, name)(x, y), (4, 5))
    for name in ("log", "chord"):
        _shape(name, getattr(geometry, name)(x, y), (4, 5, 3))
    _shape("inner", geometry.inner(x, v, np.stack([v[:, 0]] * 5, axis=1)), (4, 5))
    _shape("exp", geometry.exp(x, np.zeros((5, 3))), (4, 5, 3))
    _shape("turn", geometry.turn(x, np.zeros((5, 3))), (4, 5, 3))
    _shape("from_polar", geometry.from_polar(np.ones((4, 1)), np.ones(5)), (4, 5, 3))
    for name in ("project", "settle"):
        _shape(name, getattr(geometry, name)(x), (4, 1, 3))
    _shape("inverse", geometry.inverse(_isometries(geometry, lab, 6).reshape(2, 3, 3, 3)), (2, 3, 3, 3))


LAWS: tuple[Callable[[Component, Lab], None], ...] = (
    points_have_no_defect,
    distance_is_a_metric,
    versine_is_the_smooth_distance,
    small_distances_keep_their_digits,
    distance_is_the_length_of_the_geodesic,
    log_inverts_exp,
    polar_radius_is_distance,
    angle_excess_is_curvature_times_area,
    turn_is_a_quarter_turn,
    isometries_preserve_distance,
    operations_broadcast,
)


# ---- mutants --------------------------------------------------------------------------------------------------------


def _altered(**methods: Callable[..., Any]) -> Callable[[Component], Component]:
    """A mutation that replaces methods; each replacement gets the original method first."""

    def mutate(component: Component) -> Component:
        base = type(component())
        return type(f"Altered{base.__name__}", (base,), {name: _method(base, name, f) for name, f in methods.items()})

    return mutate


def _method(base: type, name: str, replacement: Callable[..., Any]) -> Callable[..., Any]:
    return lambda self, *args: replacement(lambda *a: getattr(base, name)(self, *a), *args)


# A geometry of four times the curvature that agrees with itself: only the laws with an outside anchor can tell.
_four_times_curved = _altered(
    distance=lambda distance, x, y: distance(x, y) / 2,
    inner=lambda inner, x, v, w: inner(x, v, w) / 4,
    from_polar=lambda from_polar, r, a: from_polar(2 * np.asarray(r), a),
)


def _from_the_product(_: Callable[..., Any], x: Floats, y: Floats) -> Floats:
    """The distance as textbooks have it: arccos and arccosh of a product, a root in the plane; half the digits go."""
    if np.allclose(np.asarray(x)[..., 0], 1) and np.allclose(np.asarray(y)[..., 0], 1):
        a, b = np.asarray(x)[..., 1:], np.asarray(y)[..., 1:]
        square = (a**2).sum(axis=-1) + (b**2).sum(axis=-1) - 2 * (a * b).sum(axis=-1)
        return np.asarray(np.sqrt(np.maximum(square, 0)))
    on_sphere = np.allclose((np.asarray(x) ** 2).sum(axis=-1), 1)
    product = np.sum(x * y * np.array([1, 1, 1] if on_sphere else [1, -1, -1]), axis=-1)
    return np.asarray(np.arccos(np.minimum(product, 1)) if on_sphere else np.arccosh(np.maximum(product, 1)))


MUTANTS: dict[str, Callable[[Component], Component]] = {
    "small_distances_keep_their_digits": _altered(distance=_from_the_product),
    "points_have_no_defect": _altered(project=lambda _, x: np.array(x)),
    "distance_is_a_metric": _altered(distance=lambda distance, x, y: distance(x, y) ** 2),
    "versine_is_the_smooth_distance": _altered(versine=lambda versine, x, y: 2 * versine(x, y)),
    "distance_is_the_length_of_the_geodesic": _altered(distance=lambda distance, x, y: distance(x, y) / 2),
    "log_inverts_exp": _altered(log=lambda log, x, y: 1.01 * log(x, y)),
    "polar_radius_is_distance": _four_times_curved,
    "angle_excess_is_curvature_times_area": _four_times_curved,
    "turn_is_a_quarter_turn": _altered(turn=lambda turn, x, v: -turn(x, v)),
    "isometries_preserve_distance": _altered(inverse=lambda _, g: np.array(g)),
    "operations_broadcast": _altered(distance=lambda distance, x, y: distance(x, y).ravel()),
}


# ---- things to try --------------------------------------------------------------------------------------------------


def _points(geometry: Geometry, lab: Lab, count: int) -> Floats:
    return geometry.from_polar(_REACH * np.sqrt(lab.rng.uniform(0, 1, count)), lab.rng.uniform(-np.pi, np.pi, count))


def _directions(geometry: Geometry, lab: Lab, x: Floats) -> Floats:
    angle = lab.rng.uniform(-np.pi, np.pi, x.shape[:-1])
    return np.asarray(np.sum(geometry.frame(x) * np.stack([np.cos(angle), np.sin(angle)], -1)[..., None, :], axis=-1))


def _tangents(geometry: Geometry, lab: Lab, x: Floats) -> Floats:
    return np.asarray(lab.rng.uniform(0.01, _REACH, (*x.shape[:-1], 1)) * _directions(geometry, lab, x))


def _isometries(geometry: Geometry, lab: Lab, count: int) -> Floats:
    angle, length, mirror = (lab.rng.uniform(0, _REACH, count) for _ in range(3))
    g = geometry.rotation(angle) @ geometry.translation(length, mirror)
    return np.where((np.arange(count) % 2)[:, None, None], g, g @ geometry.reflection(mirror))


def _sine(geometry: Geometry, x: Floats) -> Floats:
    return _SINE[geometry.curvature](x)


def _heron_sum(geometry: Geometry, x: Floats, y: Floats, z: Floats, n: int) -> float:
    """Area of a triangle from n^2 small ones, each measured by its sides alone, all taken through exp and log."""
    sides = np.linspace(0, 1, n + 1)
    rows = geometry.geodesic(geometry.geodesic(x, y, sides)[:, None], geometry.geodesic(x, z, sides)[:, None], sides)
    a, b, c, d = rows[:-1, :-1], rows[1:, :-1], rows[1:, 1:], rows[:-1, 1:]
    return _heron(geometry, a, b, c) + _heron(geometry, a, c, d)


def _heron(geometry: Geometry, x: Floats, y: Floats, z: Floats) -> float:
    a, b, c = geometry.distance(x, y), geometry.distance(y, z), geometry.distance(z, x)
    s = (a + b + c) / 2
    return float(np.sqrt(np.maximum(s * (s - a) * (s - b) * (s - c), 0.0)).sum())


def _small(defect: Floats) -> None:
    assert np.abs(defect).max() <= 10 * _TOLERANCE, f"defect {np.abs(defect).max():.3g}"


def _close(found: Floats, wanted: Floats, tolerance: float = 10 * _TOLERANCE) -> None:
    error = np.abs(np.asarray(found) - wanted).max()
    assert error <= tolerance, f"off by {error:.3g}, allowed is {tolerance:.3g}"


def _shape(name: str, found: Floats, wanted: tuple[int, ...]) -> None:
    assert np.shape(found) == wanted, f"{name} gives the shape {np.shape(found)}, wanted is {wanted}"
