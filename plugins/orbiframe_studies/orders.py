"""Orders: how fast errors fall with the number of unknowns, in series of fits that differ in nothing else."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from orbiframe_studies.plan import measured

_FREE = "basis.size"


@dataclass(frozen=True, slots=True)
class Series:
    """Errors of fits that differ in the number of unknowns alone.

    order: p, where the error falls like h^p with the distance h of neighbouring functions, that is like N^(-p/2): by
    least squares of the logarithms; None for less than two different numbers of unknowns.
    """

    name: str
    unknowns: tuple[int, ...]
    errors: tuple[float, ...]
    order: float | None


def series_of(rows: Iterable[dict[str, Any]], measure: str = "fit.rms") -> list[Series]:
    """The series of the rows of a study, in their order; fits that failed are left out."""
    found: dict[str, list[tuple[int, float]]] = defaultdict(list)
    for row in rows:
        error, size = measured(row, measure), measured(row, "fit.size")
        if error is not None and size is not None:
            found[_name(row)].append((int(size), error))
    return [_series(name, sorted(points)) for name, points in found.items()]


def fitted_order(unknowns: Iterable[float], errors: Iterable[float]) -> float | None:
    """The order p of errors that fall like N^(-p/2); see `Series`."""
    points = [(math.log(n), math.log(e)) for n, e in zip(unknowns, errors, strict=True) if n > 0 and e > 0]
    if len({x for x, _ in points}) < 2:
        return None
    x_mean = sum(x for x, _ in points) / len(points)
    y_mean = sum(y for _, y in points) / len(points)
    slope = sum((x - x_mean) * (y - y_mean) for x, y in points) / sum((x - x_mean) ** 2 for x, _ in points)
    return -2 * slope


def _series(name: str, points: list[tuple[int, float]]) -> Series:
    unknowns, errors = zip(*points, strict=True)
    return Series(name, unknowns, errors, fitted_order(unknowns, errors))


def _name(row: dict[str, Any]) -> str:
    """What the fits of a series have in common, in words."""
    parameters = {name: value for name, value in row["parameters"].items() if name != _FREE}
    parts = [row["mesh"], row["case"], *(_parameter(name, value) for name, value in parameters.items())]
    parts += [] if row["seed"] is None else [f"seed {row['seed']}"]
    return ", ".join(filter(None, parts))


def _parameter(name: str, value: Any) -> str:
    return str(value) if isinstance(value, str) else f"{name.partition('.')[2]} {value}"
