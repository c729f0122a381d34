"""Small studies for tests: fits of a cube that take no time."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

DATASETS = Path(__file__).parents[1] / "datasets"
QUICK = """
[study]
meshes = ["cube.off"]

[fitter]
name = "least-squares"

[output]
refine = 1
"""


def written(folder: Path, text: str, name: str = "quick.toml") -> Path:
    """A study file with these tables after those of a quick fit, and its mesh beside it."""
    cube = folder / "cube.off"
    if not cube.exists():
        cube.write_bytes((DATASETS / "cube.off").read_bytes())
    path = folder / name
    path.write_text(QUICK + text)
    return path


def lines(path: Path) -> list[dict[str, Any]]:
    return [json.loads(line) for line in path.read_text().splitlines()]
