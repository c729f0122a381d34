"""Results: what was measured, kept in a JSON file so that a run goes on where the last one stopped."""

from __future__ import annotations

import json
import os
import platform
from collections.abc import Iterable
from dataclasses import asdict, dataclass
from datetime import date
from pathlib import Path
from typing import Any


@dataclass(frozen=True)
class Result:
    """One method on one shape. Distances in diagonals, normals in degrees, curvature relative, processor seconds.

    meant: what peers were told that the mesh is; curvature is None without a truth; crossing: triangles of the output
    that meet others, None where the truth itself does; reason: why there is no surface.
    """

    shape: str
    kind: str
    meant: str
    surface: str
    vertices: int
    method: str
    seconds: float | None = None
    rms: float | None = None
    max: float | None = None
    normals: float | None = None
    curvature: float | None = None
    crossing: int | None = None
    reason: str | None = None
    day: str = ""


class Results:
    """All results of a folder, by shape and method."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.machine = _machine()
        self.rows: dict[tuple[str, str], Result] = {}
        if path.exists():
            for row in json.loads(path.read_text(encoding="utf-8"))["results"]:
                self.rows[row["shape"], row["method"]] = Result(**row)

    def add(self, result: Result) -> None:
        """Keep a result, and write all of them."""
        self.rows[result.shape, result.method] = result
        found = {"machine": self.machine, "results": [asdict(row) for row in self.rows.values()]}
        fresh = self.path.with_suffix(".new")
        fresh.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
        os.replace(fresh, self.path)

    def of(self, shapes: Iterable[str], methods: Iterable[str]) -> dict[str, dict[str, Result]]:
        """The results for shapes, in this order, by method."""
        methods = list(methods)
        found = {s: {m: self.rows[s, m] for m in methods if (s, m) in self.rows} for s in shapes}
        return {shape: row for shape, row in found.items() if row}


def _machine() -> dict[str, Any]:
    return {"processors": os.cpu_count(), "machine": platform.machine(), "python": platform.python_version()}


def today() -> str:
    """The date, as it is kept with a result."""
    return date.today().isoformat()
