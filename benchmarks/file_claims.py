"""Claims of speed about files: what is read and written beside meshio and Open3D."""

from __future__ import annotations

import atexit
import tempfile
from functools import cache, partial
from pathlib import Path

import formats
from claim import Action, Claim

from orbiframe import Polyhedron

_PAGE = "[formats](formats.md)"
_COUNT = 200_000
_NAMES = {"OFF": ".off", "OBJ": ".obj", "PLY, text": ".ply", "PLY, binary": ".ply"}


@cache
def mesh() -> Polyhedron:
    """A torus of so many triangles."""
    return formats.torus(_COUNT)


@cache
def folder() -> Path:
    """Where the files are, as long as this process lasts."""
    found = tempfile.TemporaryDirectory()
    atexit.register(found.cleanup)
    return Path(found.name)


def both(name: str, peer: str, way: int) -> tuple[Action, Action]:
    """Read (0) or write (1) a format, by orbiframe and by another library."""
    options = {"ascii": True} if name == "PLY, text" else {}
    path = folder() / f"{peer}{len(name)}{way}{_NAMES[name]}"
    ours, theirs = (formats.PEERS[each](path, mesh(), options)[way] for each in ("orbiframe", peer))
    formats.orbiframe_actions(path, mesh(), options)[1]()
    return ours, theirs


def _claim(name: str, peer: str, way: int, least: float) -> Claim:
    what = ("reading", "writing")[way]
    return Claim(f"{what} {name}, 200,000 triangles", peer, least, _PAGE, partial(both, name, peer, way))


CLAIMS = (
    _claim("OFF", "meshio", 0, 0.9),
    _claim("OFF", "meshio", 1, 2.5),
    _claim("OBJ", "meshio", 0, 4.0),
    _claim("OBJ", "Open3D", 0, 1.2),
    _claim("PLY, text", "meshio", 0, 3.0),
    _claim("PLY, text", "Open3D", 0, 0.4),
    _claim("PLY, binary", "meshio", 0, 2.0),
    _claim("PLY, binary", "Open3D", 0, 0.6),
)
