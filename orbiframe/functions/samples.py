"""Samples: values of functions at points of X/H, with weights; those of a mesh."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from orbiframe.components.one_line import one_line
from orbiframe.errors import FitError
from orbiframe.meshes.edge_paths import covering_points, dijkstra_forest, edge_graph
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.meshes.sizes import vector_areas
from orbiframe.orbifolds.atlas import Points
from orbiframe.triangulations.triangulation import Triangulation

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]

# So many samples are taken of each part; what a product lacks to a whole number by rounding.
_PER_PART, _WHOLE = 10, 1e-9
# How much fairness counts on triangles that only close a mesh, and how little they count for the stretch beside them.
_BEYOND, _TRACE = 1e-2, 1e-9


@dataclass(frozen=True, eq=False)
class Samples:
    """What a fitter approximates: d functions at n points of X/H, and where it asks for fairness.

    points: n points of X/H; values: (n, d); weights: (n,), how much each value counts, of any scale (area in space,
    say), 0 where only fairness is asked for; stretch: (n,), area in X per area in space near each point, which turns
    derivatives on X/H into those on the surface.

    area: (n,), the area in space that each sample stands for in integrals of fairness; as the weights if not given;
    length: (n,), the length in space from which on the functions are to be fair, None for the distance between
    neighbouring functions; order: the order of the derivatives that are to be small between the values, 2 where the
    samples are all that is known, 3 where they lie on a smooth surface; noise: the root mean square error of each
    coordinate of these points, None where it is to be found from them.

    normals: (n, 3), the unit normal of what each sample of a surface lies on, nan where it is that of the surface to be
    found; still: (n,), the samples that do not slide along the surface, as where creases would be crossed; None for
    none; held: (n,), the samples that the surface passes through at their own parameters, all coordinates of which
    count alike, as those of a boundary; None for none.

    slopes: (n, d, 2), the derivatives of the functions along the frame of X at each point, nan where they are not
    known; fixed: (n,), the samples that are met exactly, with their slopes, and those of a surface with their normals
    where these are known; None for none, and only fitters that say so know of them. Raises FitError if the shapes do
    not fit, for a value that is not finite, and for another number that is negative or not finite.
    """

    points: Points
    values: Floats
    weights: Floats
    stretch: Floats
    area: Floats | None = None
    length: Floats | None = None
    order: int = 2
    noise: float | None = None
    normals: Floats | None = None
    still: Bools | None = None
    held: Bools | None = None
    slopes: Floats | None = None
    fixed: Bools | None = None

    __repr__ = one_line

    def __post_init__(self) -> None:
        count = len(self.points.patch)
        shapes = [np.shape(a) for a in (self.points.x, self.values, self.weights, self.stretch)]
        if shapes != [(count, 3), (count, *shapes[1][1:2]), (count,), (count,)] or len(shapes[1]) != 2:
            raise FitError(
                f"{count} samples have points, values, weights and stretch of shapes {shapes}; they must be (n, 3), "
                "(n, d), (n,) and (n,)"
            )
        _require("value", np.all(np.isfinite(self.values), axis=1), self.values, "finite")
        for name in ("weight", "stretch", "area", "length"):
            numbers = getattr(self, "weights" if name == "weight" else name)
            if numbers is not None:
                _require(name, np.isfinite(numbers) & (numbers >= 0), numbers, "finite and not negative")
        marks = (self.normals, self.still, self.held, self.fixed)
        sizes = [np.shape(table) for table in marks if table is not None]
        if any(size not in ((count, 3), (count,)) for size in sizes):
            raise FitError(f"{count} samples have normals and flags of shapes {sizes}; they must be (n, 3) and (n,)")
        if self.slopes is not None and np.shape(self.slopes) != (count, shapes[1][1], 2):
            raise FitError(
                f"{count} samples have slopes of shape {np.shape(self.slopes)}; it must be (n, d, 2), two "
                "derivatives of each function"
            )

    @property
    def shares(self) -> Floats:
        """The area that each sample stands for, (n,)."""
        return self.weights if self.area is None else self.area

    def take(self, chosen: Ints) -> Samples:
        """Some of the samples, in the order of the indices `chosen`."""
        points = Points(self.points.patch[chosen], self.points.x[chosen])
        numbers = self.values[chosen], self.weights[chosen], self.stretch[chosen]
        area, length = _taken(self.area, chosen), _taken(self.length, chosen)
        tables = self.normals, self.still, self.held, self.slopes, self.fixed
        marks = (_taken(table, chosen) for table in tables)
        return Samples(points, *numbers, area, length, self.order, self.noise, *marks)


def joined(a: Samples, b: Samples) -> Samples:
    """The samples of both, with what only one of them knows as unknown, or as not marked, at those of the other.

    Lengths, order and noise are those of the first, if it has any.
    """
    unknown = {"normals": np.nan, "slopes": np.nan, "still": False, "held": False, "fixed": False}
    tables: dict[str, Any] = {name: _both(a, b, name, value) for name, value in unknown.items()}
    tables |= {name: np.concatenate([getattr(a, name), getattr(b, name)]) for name in ("values", "weights", "stretch")}
    tables |= {"area": np.concatenate([a.shares, b.shares]), "length": a.length}
    if a.length is not None:
        tables["length"] = np.concatenate([a.length, np.zeros(len(b.weights)) if b.length is None else b.length])
    points = Points(np.concatenate([a.points.patch, b.points.patch]), np.concatenate([a.points.x, b.points.x]))
    return Samples(points, order=a.order, noise=a.noise, **tables)


def _both(a: Samples, b: Samples, name: str, unknown: float) -> Any:
    """A table of both, with a value where one of them has none."""
    tables = [getattr(samples, name) for samples in (a, b)]
    known = [table for table in tables if table is not None]
    if not known:
        return None
    counts = [len(samples.weights) for samples in (a, b)]
    filled = (np.full((count, *known[0].shape[1:]), unknown, known[0].dtype) for count in counts)
    return np.concatenate([fill if table is None else table for table, fill in zip(tables, filled, strict=True)])


def _taken(table: Any, chosen: Ints) -> Any:
    """The chosen rows of a table, if there is one."""
    return None if table is None else table[chosen]


def _require(name: str, good: NDArray[np.bool_] | np.bool_, numbers: Floats, what: str) -> None:
    bad = np.flatnonzero(~good)
    if len(bad):
        raise FitError(f"sample {bad[0]} has the {name} {numbers[bad[0]]}; it must be {what}: check the mesh")


def coordinate_samples(triangulation: Triangulation, most: int | None = None) -> Samples:
    """The positions in space at the vertices and the face centroids that have some area, weighted by area in space.

    A vertex has a twelfth of the area of each of its triangles, a centroid three quarters: exact for quadratic
    functions on each triangle. The stretch at a vertex is that of its faces together.

    most: where there are more, as on fans of thousands of needles, about so many stand for all, with their areas.
    """
    samples = places(triangulation)
    if most is not None and len(samples.weights) > most:
        samples = _evenly(samples, triangulation.polyhedron, most)
    return samples.take(np.flatnonzero(samples.shares > 0))


def _evenly(samples: Samples, mesh: Polyhedron, most: int) -> Samples:
    """About `most` of the samples at vertices and centroids, as many on every part of the surface as its area asks for.

    Parts are what is nearest to vertices that are spread evenly, by the lengths of edges. Of those of one part as many
    are left out between any two that are kept.
    """
    graph, area = edge_graph(mesh), samples.shares.sum()
    parts = covering_points(graph, float(np.sqrt(_PER_PART * area / most)))
    owner = dijkstra_forest(graph, parts).owner
    part = np.concatenate([owner, owner[mesh.triangles[:, 0]]])
    weight, count = np.bincount(part, weights=samples.shares), np.bincount(part)
    wanted = np.minimum(np.ceil(most * weight / area), count)
    order = np.argsort(part, kind="stable")
    place = np.arange(len(part)) - np.repeat(np.cumsum(count) - count, count)
    share = (wanted / count)[part[order]]
    kept = np.sort(order[np.floor((place + 1) * share + _WHOLE) > np.floor(place * share + _WHOLE)])
    left = np.bincount(part[kept], weights=samples.shares[kept], minlength=len(count))
    factor = weight / np.maximum(left, np.finfo(float).tiny)
    found, factor = samples.take(kept), factor[part[kept]]
    area_of_each = None if found.area is None else found.area * factor
    return replace(found, weights=found.weights * factor, area=area_of_each)


def places(triangulation: Triangulation) -> Samples:
    """The same at all vertices, then all centroids, those without area too.

    Triangles that only close the mesh have no values, and ask for fairness a hundred times less.
    """
    mesh, inside = triangulation.polyhedron, triangulation.inside
    area = np.linalg.norm(vector_areas(mesh), axis=1)
    # The stretch at a boundary is that of the mesh.
    counted = np.ones(mesh.face_count) if inside is None else np.where(inside, 1.0, _TRACE)
    around = _around(mesh, area * counted)
    image = _around(mesh, triangulation.areas * counted)
    centroids = triangulation.locate(np.arange(mesh.face_count), np.full((mesh.face_count, 3), 1 / 3))
    points = Points(
        np.concatenate([triangulation.patch, centroids.patch]), np.concatenate([triangulation.points, centroids.x])
    )
    values = np.concatenate([mesh.vertices, mesh.vertices[mesh.triangles].mean(axis=1)])
    tiny = np.finfo(float).tiny
    stretch = np.concatenate([image / np.maximum(around, tiny), triangulation.areas / np.maximum(area, tiny)])
    if inside is None:
        return Samples(points, values, _shared(mesh, area), stretch)
    return Samples(points, values, _shared(mesh, area * inside), stretch, _shared(mesh, area * fair_shares(inside)))


def fair_shares(inside: Bools) -> Floats:
    """How much triangles ask for fairness, (F,): those that only close the mesh a hundred times less."""
    return np.where(inside, 1.0, _BEYOND)


def _shared(mesh: Polyhedron, area: Floats) -> Floats:
    """The areas of triangles shared out to their corners and centroids, (V + F,)."""
    return np.concatenate([_around(mesh, area) / 12, 0.75 * area])


def _around(mesh: Polyhedron, of_face: Floats) -> Floats:
    """The sum of a quantity of triangles over those about each vertex, (V,)."""
    return np.asarray(np.bincount(mesh.tail, weights=np.repeat(of_face, 3), minlength=len(mesh.vertices)), dtype=float)
