"""Reads a polyhedron from a NumPy archive."""

from __future__ import annotations

import zipfile
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from orbiframe import FormatError, OrbiframeError, Polyhedron

REQUIRED = ("vertices", "offsets", "corners")
OPTIONAL = ("normals", "colors", "face_colors")


def read(path: Path) -> Polyhedron:
    """The polyhedron in an archive with the arrays vertices (V, 3), offsets (F + 1,) and corners (H,).

    Face f has the corners offsets[f] to offsets[f + 1] - 1. Optional arrays: normals (V, 3), colors (V, 3 or 4),
    face_colors (F, 3 or 4). Raises FormatError for anything else.
    """
    arrays = _arrays(path)
    for name in REQUIRED:
        if name not in arrays:
            raise FormatError(f"{path}: no array named '{name}' in the archive; needed: {', '.join(REQUIRED)}")
    for name in ("offsets", "corners"):
        if arrays[name].dtype.kind not in "iu":
            raise FormatError(f"{path}: array '{name}' holds {arrays[name].dtype}; whole numbers are needed")
    try:
        extra = {name: arrays.get(name) for name in OPTIONAL}
        return Polyhedron.from_corners(arrays["vertices"], arrays["offsets"], arrays["corners"], **extra)
    except (ValueError, OrbiframeError) as error:
        raise FormatError(f"{path}: {error}") from error


def _arrays(path: Path) -> dict[str, NDArray[np.generic]]:
    try:
        with np.load(path, allow_pickle=False) as archive:
            return {name: archive[name] for name in archive.files}
    except (OSError, ValueError, EOFError, AttributeError, MemoryError, zipfile.BadZipFile) as error:
        raise FormatError(f"{path}: not a NumPy archive ({error})") from error
