"""Field data: named numbers at points in space, from a CSV file or from the attributes of a mesh file."""

from __future__ import annotations

import csv
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from orbiframe import FormatError, Notice, Polyhedron, UsageError
from orbiframe.components import did_you_mean
from orbiframe.files import confined_tables

Floats = NDArray[np.float64]

_PLACES = ("x", "y", "z")
# Marks data that are met exactly: 1 for yes, anything else for no.
_FIXED = "fixed"
_NUMBERED = ("vertex", "face")
_SKIPPED = {"distance", "normal_x", "normal_y", "normal_z"}


@dataclass(frozen=True, eq=False)
class FieldData:
    """Numbers at points in space.

    places: (n, 3); columns: numbers (n,) or vectors (n, k) by name; fixed: (n,), the data that are to be met exactly,
    None for none.
    """

    places: Floats
    columns: Mapping[str, Floats]
    fixed: NDArray[np.bool_] | None = None

    @property
    def table(self) -> Floats:
        """All numbers side by side, (n, q)."""
        return np.concatenate([values.reshape(len(self.places), -1) for values in self.columns.values()], axis=1)

    def unpacked(self, table: Floats) -> dict[str, Floats]:
        """Columns of these names from numbers side by side; vectors that are not of three numbers as k columns."""
        found, begin = {}, 0
        for name, values in self.columns.items():
            width = 1 if values.ndim == 1 else values.shape[1]
            part = table[:, begin : begin + width]
            begin += width
            if values.ndim == 1:
                found[name] = part[:, 0]
            elif width == 3:
                found[name] = part
            else:
                found |= {f"{name}_{k}": part[:, k] for k in range(width)}
        return found


def read_data(path: Path, mesh: Polyhedron, chosen: Sequence[str] = ()) -> FieldData:
    """The numbers of a file, those with the chosen names, or all.

    CSV: a line of names and lines of numbers, of which x, y and z are the place, or `vertex` or `face` the number in
    the mesh, from 0; without either, lines for all vertices or all faces in their order; 1 in a column `fixed`
    marks what is to be met exactly. Other files are read by
    meshio: data at points, or where there are none at the centroids of cells. Lines with a missing number are left
    out, and that is said. Raises FormatError with the line for anything else that is wrong, UsageError for a name that
    is not there.
    """
    data = _of_csv(path, mesh) if path.suffix.lower() in (".csv", ".txt") else _of_mesh(path)
    if not data.columns:
        raise FormatError(f"{path}: there are no numbers beside the places; a field needs a column with its values")
    return _complete(path, _chosen(path, data, chosen))


def _chosen(path: Path, data: FieldData, names: Sequence[str]) -> FieldData:
    for name in names:
        if name not in data.columns:
            known = ", ".join(data.columns)
            raise UsageError(f"{path} has no values {name!r}, but {known}.{did_you_mean(name, list(data.columns))}")
    return replace(data, columns={name: data.columns[name] for name in names or data.columns})


def _complete(path: Path, data: FieldData) -> FieldData:
    """The data without lines in which a number is missing."""
    bad = ~np.isfinite(np.concatenate([data.table, data.places], axis=1)).all(axis=1)
    if bad.all():
        raise FormatError(f"{path}: no line has all its numbers; mend the file, or choose values with --value")
    if bad.any():
        warnings.warn(f"{path}: {bad.sum()} of {len(bad)} lines lack a number and are left out", Notice, stacklevel=4)
    fixed = None if data.fixed is None else data.fixed[~bad]
    return FieldData(data.places[~bad], {name: values[~bad] for name, values in data.columns.items()}, fixed)


# ---- files of meshes ------------------------------------------------------------------------------------------------


def _of_mesh(path: Path) -> FieldData:
    if not path.is_file():
        raise FormatError(f"{path}: there is no such file; name a CSV file or a mesh with attributes")
    tables = confined_tables("orbiframe_fields.attributes:tables_of", path)
    for kind in ("point", "cell"):
        names = [str(name) for name in tables[f"{kind} names"]]
        if names:
            return FieldData(tables[f"{kind} places"], {n: tables[f"{kind} {k}"] for k, n in enumerate(names)})
    raise FormatError(f"{path}: it has no numbers at its points or cells; give a file with attributes, or a CSV file")


# ---- CSV ------------------------------------------------------------------------------------------------------------


def _of_csv(path: Path, mesh: Polyhedron) -> FieldData:
    names, table = _table(path)
    columns = dict(zip(names, table.T, strict=True))
    if all(name in columns for name in _PLACES):
        places = np.stack([columns[name] for name in _PLACES], axis=1)
    elif found := [name for name in _NUMBERED if name in columns]:
        places = _numbered(path, found[0], columns[found[0]], mesh)
    else:
        places = _in_order(path, len(table), mesh)
    apart = {*_PLACES, *_NUMBERED, *_SKIPPED, _FIXED}
    fixed = columns[_FIXED] == 1 if _FIXED in columns else None
    return FieldData(places, {name: values for name, values in columns.items() if name not in apart}, fixed)


def _table(path: Path) -> tuple[list[str], Floats]:
    """The names and the numbers; an empty place is nan."""
    if not path.exists():
        raise FormatError(
            f"{path}: there is no such file; name a CSV file with a line of names, or a mesh with attributes"
        )
    try:
        text = path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise FormatError(f"{path} cannot be read as text: {error}") from error
    rows = [(n, row) for n, row in enumerate(csv.reader(text.splitlines(), delimiter=_mark(text)), 1) if any(row)]
    if len(rows) < 2:
        raise FormatError(f"{path}: a line of names and a line of numbers are the least; {len(rows)} lines are there")
    names = [name.strip() for name in rows[0][1]]
    if len(set(names)) < len(names) or any(_number(name) is not None for name in names):
        raise FormatError(
            f"{path}, line {rows[0][0]}: the first line must hold a different name for each column, such as x,y,z,value"
        )
    table = np.empty((len(rows) - 1, len(names)))
    for k, (line, row) in enumerate(rows[1:]):
        if len(row) != len(names):
            raise FormatError(f"{path}, line {line}: {len(row)} columns, but the first line names {len(names)}")
        for j, word in enumerate(row):
            number = _number(word) if word.strip() else np.nan
            if number is None:
                raise FormatError(f"{path}, line {line}: {names[j]} is {word[:30]!r}; it must be a number or empty")
            table[k, j] = number
    return names, table


def _mark(text: str) -> str:
    """What parts the columns: the commonest of comma, semicolon and tabulator in the first line."""
    first = text.split("\n", 1)[0]
    return max(",;\t", key=first.count)


def _number(word: str) -> float | None:
    try:
        return float(word)
    except ValueError:
        return None


def _numbered(path: Path, name: str, numbers: Floats, mesh: Polyhedron) -> Floats:
    places = _places(name, mesh)
    bad = np.flatnonzero(~((numbers == np.floor(numbers)) & (numbers >= 0) & (numbers < len(places))))
    if len(bad):
        raise FormatError(
            f"{path}: {name} {numbers[bad[0]]:g} in row {bad[0] + 1} of the numbers; those of the mesh are 0 to "
            f"{len(places) - 1}"
        )
    return places[numbers.astype(np.intp)]


def _in_order(path: Path, count: int, mesh: Polyhedron) -> Floats:
    for name in _NUMBERED:
        if count == len(places := _places(name, mesh)):
            return places
    raise FormatError(
        f"{path}: {count} lines of numbers without places; name columns x, y and z, or vertex, or face, or give a line "
        f"for each of the {len(mesh.vertices)} vertices or {mesh.face_count} faces"
    )


def _places(name: str, mesh: Polyhedron) -> Floats:
    """The vertices, or the means of the corners of the faces."""
    if name == "vertex":
        return mesh.vertices
    total = np.zeros((mesh.face_count, 3))
    np.add.at(total, mesh.face, mesh.vertices[mesh.tail])
    return total / mesh.face_sizes[:, None]
