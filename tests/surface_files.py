"""Changed surface files."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np

Change = Callable[[dict[str, np.ndarray]], None]


def changed(path: Path, target: Path, change: Change) -> Path:
    """A copy of a surface file with other arrays."""
    with np.load(path) as archive:
        arrays = dict(archive)
    change(arrays)
    np.savez(target, **arrays)
    return target


def without_sums(arrays: dict[str, np.ndarray], **entries: object) -> None:
    """Make a file of version 1 of the arrays, whose laws are all that can tell what was changed."""
    about = json.loads(str(arrays["about"]))
    about.pop("sha256", None)
    arrays["about"] = np.array(json.dumps({**about, "version": 1, **entries}))


def with_about(path: Path, target: Path, **entries: object) -> Path:
    return changed(path, target, lambda arrays: without_sums(arrays, **entries))
