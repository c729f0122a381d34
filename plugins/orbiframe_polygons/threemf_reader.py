"""3MF reader: triangles of the 3D Manufacturing Format, XML in an archive."""

from __future__ import annotations

import zipfile
import zlib
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from orbiframe import FormatError, Polyhedron
from orbiframe_polygons.faces import corners, whole
from orbiframe_polygons.floats import parsed
from orbiframe_polygons.xml_events import parse

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Mesh = tuple[Floats, Ints]

MODEL = "3D/3dmodel.model"
RELATIONS = "_rels/.rels"
MODEL_TYPE = "/3dmodel"
# An archive may grow so far: for each of its bytes so many, and some more.
GROWTH, ROOM = 64, 2**24
UNSOUND = (zipfile.BadZipFile, zlib.error, RuntimeError, NotImplementedError, EOFError, OSError, ValueError)
DEPTH = 32
# Words are kept with the unit separator, which XML cannot hold, after each. To be read it becomes a blank, and blanks
# inside words become what no number has.
UNIT, SPACES = "\x1f", " \t\n\v\f\r"
BLANKS = bytes.maketrans(b"\x1f \t\n\v\f\r", b" ______")


def read(path: Path) -> Polyhedron:
    """The triangles of all objects that a 3MF file builds, in its own unit, moved to their places.

    Colours, materials and textures are skipped. Raises FormatError for archives that swell beyond 64 times their size,
    for XML with entities, for models that stand in further parts, and where numbers and objects do not fit.

    Source: 3MF Consortium, Core Specification 1.3.0.
    """
    archive = _Archive(path)
    model = _Model(path)
    parse(path, archive.part(archive.model_name()), model.start, lambda _: None, model.end)
    meshes = [mesh for number, matrix in model.items for mesh in model.built(number, matrix)]
    if not meshes:
        raise FormatError(f"{path}: the model builds no object with triangles")
    starts = np.cumsum([0, *(len(points) for points, _ in meshes)])
    faces = [triangles + start for (_, triangles), start in zip(meshes, starts, strict=False)]
    return Polyhedron.from_faces(np.concatenate([points for points, _ in meshes]), np.concatenate(faces))


class _Archive:
    """Parts of the archive, with a running cap on what comes out."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._left = ROOM + GROWTH * path.stat().st_size

    def part(self, name: str) -> bytes:
        try:
            with zipfile.ZipFile(self._path) as archive, archive.open(name) as file:
                data = file.read(self._left + 1)
        except KeyError as error:
            raise FormatError(f"{self._path}: the archive has no part '{name}'; is it a 3MF file?") from error
        except UNSOUND as error:
            raise FormatError(f"{self._path}: this is no sound archive: {error}") from error
        self._left -= len(data)
        if self._left < 0:
            raise FormatError(f"{self._path}: the part '{name}' swells beyond {GROWTH} times the file; it is not read")
        return data

    def model_name(self) -> str:
        """Where the relations of the archive say that the model is."""
        names: list[str] = []

        def start(name: str, attributes: dict[str, str], _: int) -> None:
            if name == "Relationship" and attributes.get("Type", "").endswith(MODEL_TYPE):
                names.append(attributes.get("Target", MODEL).lstrip("/"))

        parse(self._path, self.part(RELATIONS), start, lambda _: None, lambda _: None)
        return names[0] if names else MODEL


@dataclass(slots=True)
class _Object:
    line: int
    vertices: bytearray = field(default_factory=bytearray)
    triangles: bytearray = field(default_factory=bytearray)
    parts: list[tuple[str, str]] = field(default_factory=list)


@dataclass(slots=True)
class _Model:
    """What is met on the way through the model; items: what is built, by number, and how it is moved."""

    path: Path
    items: list[tuple[str, str]] = field(default_factory=list)
    _objects: dict[str, _Object] = field(default_factory=dict)
    _meshes: dict[str, Mesh] = field(default_factory=dict)
    _now: _Object | None = None

    def start(self, name: str, attributes: dict[str, str], line: int) -> None:
        try:
            self._element(name, attributes, line)
        except KeyError as error:
            raise FormatError(f"{self.path}, line {line}: the element '{name}' lacks {error}") from error

    def _element(self, name: str, attributes: dict[str, str], line: int) -> None:
        now = self._now
        if any(key.rpartition(":")[2] == "path" for key in attributes) and name in ("item", "component"):
            raise FormatError(f"{self.path}, line {line}: the {name} stands in another part, which is not read")
        if name == "object":
            self._now = self._objects[attributes["id"]] = _Object(line)
        elif name == "item":
            self.items.append((attributes["objectid"], attributes.get("transform", "")))
        elif now is not None and name == "vertex":
            now.vertices += _row(attributes["x"], attributes["y"], attributes["z"])
        elif now is not None and name == "triangle":
            now.triangles += _row(attributes["v1"], attributes["v2"], attributes["v3"])
        elif now is not None and name == "component":
            now.parts.append((attributes["objectid"], attributes.get("transform", "")))

    def end(self, name: str) -> None:
        if name == "object":
            self._now = None

    def built(self, number: str, transform: str, depth: int = 0) -> list[Mesh]:
        """The meshes of an object and of its components, moved."""
        if number not in self._objects or depth > DEPTH:
            raise FormatError(f"{self.path}: the object {number[:20]!r} is not there, or is a part of itself")
        found = self._objects[number]
        if number not in self._meshes and found.triangles:
            self._meshes[number] = self._mesh(found)
        meshes = [self._meshes[number]] if number in self._meshes else []
        for part, inner in found.parts:
            meshes += self.built(part, inner, depth + 1)
            self._require_room(meshes)
        matrix = self._numbers(_row(*transform.split()), found).reshape(-1, 3) if transform else np.eye(4, 3)
        if matrix.shape != (4, 3):
            raise FormatError(f"{self.path}: a transform has {matrix.size} numbers, but 12 are required")
        return [(points @ matrix[:3] + matrix[3], faces) for points, faces in meshes] if transform else meshes

    def _require_room(self, meshes: list[Mesh]) -> None:
        # Components of components can double again and again.
        if sum(len(points) for points, _ in meshes) > GROWTH * self.path.stat().st_size:
            raise FormatError(f"{self.path}: the components of the model repeat their parts too often")

    def _mesh(self, found: _Object) -> Mesh:
        points = self._numbers(found.vertices, found).reshape(-1, 3)
        place = f"{self.path}, object at line {found.line}"
        numbers = whole(self._numbers(found.triangles, found), lambda k: f"{place}, triangle {k // 3}")
        sizes = np.full(len(numbers) // 3, 3, dtype=np.intp)
        return points, corners(numbers, sizes, len(points), lambda _: place).reshape(-1, 3)

    def _numbers(self, words: bytes | bytearray, found: _Object) -> Floats:
        """Numbers with a unit separator after each."""
        unit = UNIT.encode()
        empty = words.startswith(unit) or 2 * unit in words
        values = parsed(np.frombuffer(words.translate(BLANKS), dtype=np.uint8), words.count(unit))
        if values is None or empty or not np.isfinite(values).all():
            raise FormatError(f"{self.path}, object at line {found.line}: a word is no finite decimal number")
        return values


def _row(*words: str) -> bytes:
    """Words of numbers as a part of a text, which takes less memory than words."""
    return "".join([word.strip(SPACES) + UNIT for word in words]).encode()
