"""Readers of packed files: one mesh in a .gz or a .zip, unpacked into a folder of its own and read from there."""

from __future__ import annotations

import os
import tempfile
import zipfile
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from functools import lru_cache
from pathlib import Path, PurePosixPath

from orbiframe import FormatError, PluginError, Polyhedron, Registry, read

# A file may grow so far when it is unpacked: for each of its bytes so many, and some more.
GROWTH, ROOM = 64, 2**24
BLOCK = 2**20
PACKED = (".gz", ".zip")
UNSOUND = (zipfile.BadZipFile, zlib.error, RuntimeError, NotImplementedError, EOFError, OSError, ValueError)


def read_gz(path: Path) -> Polyhedron:
    """The polyhedron of a file packed with gzip, by the reader of the suffix before .gz: cube.off.gz is OFF.

    Raises FormatError for a damaged file, and for one that swells beyond 64 times its size.
    """
    with _beside(path, path.stem) as place:
        with path.open("rb") as source, place.open("wb") as target:
            engine = zlib.decompressobj(wbits=31)
            left = ROOM + GROWTH * path.stat().st_size
            try:
                while block := (engine.unconsumed_tail or engine.unused_data or source.read(BLOCK)):
                    if engine.eof:  # several streams one after the other are one file
                        engine = zlib.decompressobj(wbits=31)
                    made = engine.decompress(block, BLOCK)
                    left -= len(made)
                    _require_room(path, left)
                    target.write(made)
                while made := engine.decompress(engine.unconsumed_tail, BLOCK):
                    left -= len(made)
                    _require_room(path, left)
                    target.write(made)
            except zlib.error as error:
                raise FormatError(f"{path}: this is no sound gzip: {error}") from error
            if not engine.eof:
                raise FormatError(f"{path}: the packed file ends too early; is it cut short?")
        return _read(path, place)


def read_zip(path: Path) -> Polyhedron:
    """The polyhedron of the one mesh in a .zip, by the reader of its suffix; what is no mesh is passed over.

    Raises FormatError for a damaged archive, for several meshes or none, and for one that swells beyond 64 times the
    size of the archive.
    """
    try:
        with zipfile.ZipFile(path) as archive:
            member = _only_mesh(path, archive.namelist())
            with _beside(path, PurePosixPath(member).name) as place:
                with archive.open(member) as source, place.open("wb") as target:
                    left = ROOM + GROWTH * path.stat().st_size
                    while made := source.read(BLOCK):
                        left -= len(made)
                        _require_room(path, left)
                        target.write(made)
                return _read(path, place)
    except UNSOUND as error:
        raise FormatError(f"{path}: this is no sound archive: {error}") from error


def _only_mesh(path: Path, names: list[str]) -> str:
    known = {s for c in Registry.discover().components("reader") for s in c.suffixes if s not in PACKED}
    meshes = [
        name
        for name in names
        if PurePosixPath(name).suffix.lower() in known and not name.startswith("__MACOSX/") and not name.endswith("/")
    ]
    if len(meshes) != 1:
        listed = ", ".join(name[:60] for name in meshes[:5]) or ", ".join(name[:60] for name in names[:5])
        raise FormatError(f"{path}: the archive holds {len(meshes)} meshes, but one is required (found {listed})")
    return meshes[0]


@contextmanager
def _beside(path: Path, name: str) -> Iterator[Path]:
    """A place for the unpacked file, in a folder where nothing else is."""
    if PurePosixPath(name).suffix.lower() in PACKED:
        raise FormatError(f"{path}: a packed file inside another is not read; unpack it first")
    with tempfile.TemporaryDirectory(prefix="orbiframe-") as folder:
        yield Path(folder) / ("".join(c if c.isprintable() and c not in "/\\:" else "_" for c in name[-200:]) or "mesh")


def _require_room(path: Path, left: int) -> None:
    if left < 0:
        raise FormatError(f"{path}: the file swells beyond {GROWTH} times its size when unpacked; it is not read")


@lru_cache(maxsize=2)
def _registry(_restriction: str | None) -> Registry:
    """What is installed, looked up once: that takes the longer the more packages there are."""
    return Registry.discover()


def _read(path: Path, place: Path) -> Polyhedron:
    """The polyhedron of the unpacked file; errors name the packed one, which the user knows."""
    try:
        # The gate looks at the packed file again, and knows what to allow.
        return read(place, _registry(os.environ.get("ORBIFRAME_PLUGINS")), degenerate=True)
    except (FormatError, PluginError) as error:
        raise type(error)(str(error).replace(str(place), str(path))) from error
