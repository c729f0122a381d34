"""OBJ tags: edges marked as sharp, as OpenSubdiv writes them."""

from __future__ import annotations

import numpy as np

from orbiframe.meshes import MarkedEdges
from orbiframe_polygons.text import Text, shown

_CREASE = b"crease"
_COUNTS = b"2/1/0"


def marks(tags: Text, vertex_count: int) -> MarkedEdges | None:
    """The edges of lines `t crease 2/1/0 v w sharpness`, with vertices from 0 on; other tags are skipped.

    Raises FormatError for a tag of another form, and for a vertex that is not there.
    """
    found = [_mark(tags, row, vertex_count) for row in range(len(tags)) if tags.line(row).split()[1:2] == [_CREASE]]
    table = np.array(found, dtype=np.float64).reshape(-1, 3)
    return MarkedEdges.of(table[:, :2].astype(np.intp), table[:, 2])


def _mark(tags: Text, row: int, vertex_count: int) -> tuple[int, int, float]:
    words = tags.line(row).split()[2:]
    try:
        counts, first, second, sharpness = words[0], int(words[1]), int(words[2]), float(words[3])
    except (IndexError, ValueError):
        counts = b""
    if counts != _COUNTS or len(words) != 4 or not np.isfinite(sharpness):
        tags.refuse(row, f"found {shown(b' '.join(words))}; a crease is written t crease 2/1/0 v w sharpness")
    for vertex in (first, second):
        if not 0 <= vertex < vertex_count:
            tags.refuse(row, f"found vertex {vertex} of a crease; they are 0 to {vertex_count - 1}")
    return first, second, sharpness
