"""Content keys: sums of what a result depends on; equal content has equal keys, on every machine."""

from __future__ import annotations

import hashlib
import inspect
import json
from collections.abc import Callable, Mapping
from functools import lru_cache, partial
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from orbiframe.meshes.polyhedron import Polyhedron


def content_key(content: Mapping[str, Any]) -> str:
    """The SHA-256 of plain data and of the version of orbiframe, in hexadecimal digits."""
    text = json.dumps({"orbiframe": version("orbiframe"), **content}, sort_keys=True, default=str)
    return hashlib.sha256(text.encode()).hexdigest()


def mesh_key(polyhedron: Polyhedron) -> str:
    """The SHA-256 of the vertices and faces of a polyhedron, to the last bit."""
    found = hashlib.sha256()
    for array in (polyhedron.vertices, polyhedron.offsets, polyhedron.tail, polyhedron.twin, polyhedron.same):
        found.update(f"{array.dtype.str} {array.shape};".encode())
        found.update(np.ascontiguousarray(array).tobytes())
    return found.hexdigest()


def source_key(target: Callable[..., Any]) -> str:
    """The SHA-256 of the file in which a class or function is written; empty where there is none."""
    try:
        file = inspect.getsourcefile(inspect.unwrap(target.func if isinstance(target, partial) else target))
    except TypeError:
        return ""
    return file_key(Path(file)) if file and Path(file).is_file() else ""


def file_key(path: Path) -> str:
    """The SHA-256 of the bytes of a file."""
    status = path.stat()
    return _file_key(path, status.st_mtime_ns, status.st_size)


@lru_cache(maxsize=4096)
def _file_key(path: Path, _changed: int, _size: int) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
