"""Field table: a mesh with named columns of numbers at its vertices, written as PLY, VTU or CSV."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from orbiframe import FormatError, Polyhedron
from orbiframe.components import did_you_mean
from orbiframe.files import require_output, write_bytes

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class FieldTable:
    """Numbers at the vertices of a mesh.

    columns: (V,) numbers or (V, 3) vectors by name, in the order in which they are written.
    """

    mesh: Polyhedron
    columns: Mapping[str, Floats]

    @property
    def scalars(self) -> dict[str, Floats]:
        """All columns as numbers: a vector is its three coordinates, with _x, _y and _z after its name."""
        found: dict[str, Floats] = {}
        for name, values in self.columns.items():
            if values.ndim == 1:
                found[name] = values
            else:
                found |= {f"{name}_{axis}": values[:, k] for k, axis in enumerate("xyz")}
        return found


def require_field_file(path: Path) -> None:
    """Raise FormatError unless fields are written to files of this suffix, and the file can be made."""
    if path.suffix.lower() not in WRITERS:
        known = " ".join(WRITERS)
        said = did_you_mean(path.suffix.lower(), list(WRITERS))
        raise FormatError(f"{path}: numbers at vertices are written to {known}; give the file one of these.{said}")
    require_output(path)


def write_table(path: Path, table: FieldTable) -> None:
    """Write the table in the format of the suffix; see `require_field_file`."""
    require_field_file(path)
    write_bytes(path, WRITERS[path.suffix.lower()](table))


def _csv(table: FieldTable) -> bytes:
    """A line of names, then a line for each vertex with its number, its place and its numbers, to all their digits."""
    names = ["vertex", "x", "y", "z", *table.scalars]
    columns = [*table.mesh.vertices.T.tolist(), *(values.tolist() for values in table.scalars.values())]
    rows = zip(range(len(table.mesh.vertices)), *columns, strict=True)
    return "\n".join([",".join(names), *(",".join(map(repr, row)) for row in rows), ""]).encode("ascii")


def _ply(table: FieldTable) -> bytes:
    """Binary PLY with a property of the vertices for each column; a vector called normal is nx, ny and nz."""
    mesh = table.mesh
    scalars = {
        "nxnynz"[2 * "xyz".index(n[-1]) :][:2] if n[:-1] == "normal_" else n: v for n, v in table.scalars.items()
    }
    vertex = {**dict(zip("xyz", mesh.vertices.T, strict=True)), **scalars}
    count = "u1" if mesh.face_sizes.max(initial=0) < 256 else "u4"
    header = [
        "ply",
        "format binary_little_endian 1.0",
        f"element vertex {len(mesh.vertices)}",
        *(f"property double {name}" for name in vertex),
        f"element face {mesh.face_count}",
        f"property list {'uchar' if count == 'u1' else 'uint'} int vertex_indices",
        "end_header",
        "",
    ]
    rows = np.stack(list(vertex.values()), axis=1).astype("<f8")
    faces = b"".join(
        np.array(len(corners), dtype=f"<{count}").tobytes() + corners.astype("<i4").tobytes()
        for corners in np.split(mesh.tail, mesh.offsets[1:-1])
    )
    return "\n".join(header).encode("ascii") + rows.tobytes() + faces


def _vtu(table: FieldTable) -> bytes:
    """An UnstructuredGrid of VTK in XML, numbers in base64."""
    from orbiframe_fields.vtu_text import vtu_text

    return vtu_text(table.mesh, table.columns).encode("ascii")


WRITERS: dict[str, Callable[[FieldTable], bytes]] = {".ply": _ply, ".vtu": _vtu, ".csv": _csv}
