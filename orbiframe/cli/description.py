"""Description: what there is to say of a mesh, as plain data and in lines."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from orbiframe.meshes.polyhedron import Polyhedron


def description(polyhedron: Polyhedron) -> dict[str, Any]:
    """The surface, counts, sizes, defects and notes of a polyhedron as plain data.

    Lengths are those of the file; unit: that of its format, null where it has none; volume: signed, null unless the
    polyhedron is closed and orientable.
    """
    import numpy as np

    from orbiframe.meshes import sizes as measure
    from orbiframe.meshes.defects import defects_of
    from orbiframe.meshes.surface_type import surface_type

    surface = surface_type(polyhedron)
    lengths, valences = measure.edge_lengths(polyhedron), measure.valences(polyhedron)
    return {
        "surface": surface.name,
        "vertices": len(polyhedron.vertices),
        "edges": polyhedron.edge_count,
        "faces": polyhedron.face_count,
        "face_sizes": _counts(polyhedron.face_sizes),
        "components": surface.components,
        "closed": surface.closed,
        "orientable": surface.orientable,
        "euler_characteristic": surface.euler_characteristic,
        "genus": surface.genus,
        "unit": polyhedron.unit,
        "box": [polyhedron.vertices.min(axis=0).tolist(), polyhedron.vertices.max(axis=0).tolist()],
        "area": measure.area(polyhedron),
        "volume": measure.signed_volume(polyhedron),
        "edge_lengths": {name: float(find(lengths)) for name, find in _spread(np)},
        "valences": {name: float(find(valences)) for name, find in _spread(np)},
        "defects": [asdict(defect) for defect in defects_of(polyhedron)],
        "boundary": _boundary(polyhedron),
        "notes": [asdict(note) for note in measure.notes(polyhedron)],
    }


def _boundary(polyhedron: Polyhedron) -> dict[str, Any] | None:
    """The boundary loops, the longest first, and the closed surface that caps make; None where there is none.

    None also where open edges make no loops, as where they touch.
    """
    from orbiframe.errors import TopologyError
    from orbiframe.meshes.closing import closed_by
    from orbiframe.meshes.loops import boundary_loops
    from orbiframe.meshes.surface_type import surface_type

    if (polyhedron.twin >= 0).all():
        return None
    try:
        loops = boundary_loops(polyhedron)
        closed = surface_type(closed_by(polyhedron, "cap", 0.0)).name
    except TopologyError:
        return None
    sizes = sorted(((loop.length(polyhedron), len(loop.vertices)) for loop in loops), reverse=True)
    return {
        "loops": len(sizes),
        "edges": [count for _, count in sizes],
        "lengths": [length for length, _ in sizes],
        "closed_to": closed,
    }


def lines(described: dict[str, Any]) -> Iterator[str]:
    """A description in lines; the first names the surface."""
    sizes = ", ".join(f"{count} of {size} corners" for size, count in described["face_sizes"].items())
    yield described["surface"]
    yield f"{described['vertices']} vertices, {described['edges']} edges, {described['faces']} faces ({sizes})"
    yield f"Euler characteristic {described['euler_characteristic']}"
    if described["unit"]:
        yield f"unit {described['unit']}"
    low, high = described["box"]
    sides = " x ".join(_number(b - a) for a, b in zip(low, high, strict=True))
    yield f"box {sides}, from {_point(low)} to {_point(high)}"
    yield f"area {_number(described['area'])}{_volume(described['volume'])}"
    yield f"edge lengths {_range(described['edge_lengths'])}; valences {_range(described['valences'])}"
    yield from _boundary_lines(described["boundary"])
    for defect in described["defects"]:
        remedy = f"; {defect['remedy']} helps" if defect["remedy"] else ""
        yield f"defect: {_title(defect)}: {defect['where']}{remedy}"
    for note in described["notes"]:
        yield f"note: {note['kind']}: {note['where']}"


def _boundary_lines(boundary: dict[str, Any] | None) -> Iterator[str]:
    if boundary is not None:
        shown = ", ".join(map(_number, boundary["lengths"][:5])) + (", …" if boundary["loops"] > 5 else "")
        loops = "1 boundary loop" if boundary["loops"] == 1 else f"{boundary['loops']} boundary loops"
        yield f"{loops}, of length {shown}; capped it is {boundary['closed_to']}"


def _title(defect: dict[str, Any]) -> str:
    from orbiframe.meshes.defects import Defect

    return str(Defect(**defect))


def _counts(values: Any) -> dict[str, int]:
    import numpy as np

    found, counts = np.unique(values, return_counts=True)
    return {str(value): int(count) for value, count in zip(found, counts, strict=True)}


def _spread(np: Any) -> Iterable[tuple[str, Any]]:
    return ("min", np.min), ("median", np.median), ("max", np.max)


def _range(spread: dict[str, float]) -> str:
    return f"{_number(spread['min'])} to {_number(spread['max'])}, median {_number(spread['median'])}"


def _volume(volume: float | None) -> str:
    if volume is None:
        return ""
    inward = " (faces look inward; --orient helps)" if volume < 0 else ""
    return f", volume {_number(volume)}{inward}"


def _point(coordinates: list[float]) -> str:
    return f"({', '.join(map(_number, coordinates))})"


def _number(value: float) -> str:
    return f"{value:.6g}"
