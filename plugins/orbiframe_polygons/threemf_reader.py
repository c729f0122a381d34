"""3MF reader: triangles of the 3D Manufacturing Format, XML in an archive."""

from __future__ import annotations

import warnings
import zipfile
import zlib
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from orbiframe import FormatError, Notice, Polyhedron
from orbiframe_polygons.faces import corners, whole
from orbiframe_polygons.floats import parsed
from orbiframe_polygons.parts import Part, polyhedron_of
from orbiframe_polygons.room import Budget
from orbiframe_polygons.xml_events import parse

Floats = NDArray[np.float64]

MODEL = "3D/3dmodel.model"
RELATIONS = "_rels/.rels"
MODEL_TYPE = "/3dmodel"
# An archive may grow so far: for each of its bytes so many, and some more.
GROWTH, ROOM = 64, 2**24
UNSOUND = (zipfile.BadZipFile, zlib.error, RuntimeError, NotImplementedError, EOFError, OSError, ValueError)
DEPTH = 32
MILLIMETRES = {"micron": 1e-3, "millimeter": 1.0, "centimeter": 10.0, "inch": 25.4, "foot": 304.8, "meter": 1000.0}
# Extensions that a file may require and that change no triangle: materials; production, whose paths are refused.
HARMLESS = ("/material/2015/02", "/production/2015/06")
# Words are kept with the unit separator, which XML cannot hold, after each. To be read it becomes a blank, and blanks
# inside words become what no number has.
UNIT, SPACES = "\x1f", " \t\n\v\f\r"
BLANKS = bytes.maketrans(b"\x1f \t\n\v\f\r", b" ______")


def read(path: Path) -> Polyhedron:
    """The triangles of all objects that a 3MF file builds, moved to their places, in millimetres.

    Another unit is converted, with a notice. Where a transform mirrors, faces are turned. Colours, materials and
    textures are skipped. Raises FormatError for archives that swell beyond 64 times their size and objects that repeat
    too often, for XML with entities, for models that stand in further parts, for required extensions that are not
    known, and where numbers and objects do not fit.

    Source: 3MF Consortium, Core Specification 1.3.0.
    """
    archive = _Archive(path)
    model = _Model(path)
    parse(path, archive.part(archive.model_name()), model.start, lambda _: None, model.end)
    model.require_room()
    parts = [part for number, transform in model.items for part in model.built(number, transform)]
    if not parts:
        raise FormatError(f"{path}: the model builds no object with triangles")
    if model.scale != 1:
        parts = [part.moved(model.scale * np.eye(3), np.zeros(3)) for part in parts]
    return polyhedron_of(parts, "millimetre")


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
            raise FormatError(f"{self._path}: the archive has no part {name[:60]!r}; is it a 3MF file?") from error
        except UNSOUND as error:
            raise FormatError(f"{self._path}: this is no sound archive: {error}") from error
        self._left -= len(data)
        if self._left < 0:
            raise FormatError(
                f"{self._path}: the part {name[:60]!r} swells beyond {GROWTH} times the file; it is not read"
            )
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
    scale: float = 1.0
    _objects: dict[str, _Object] = field(default_factory=dict)
    _parts: dict[str, Part] = field(default_factory=dict)
    _costs: dict[str, int] = field(default_factory=dict)
    _now: _Object | None = None

    def start(self, name: str, attributes: dict[str, str], line: int) -> None:
        try:
            self._element(name, attributes, line)
        except KeyError as error:
            raise FormatError(f"{self.path}, line {line}: the element {name[:40]!r} lacks {error}") from error

    def _element(self, name: str, attributes: dict[str, str], line: int) -> None:
        now = self._now
        if any(key.rpartition(":")[2] == "path" for key in attributes) and name in ("item", "component"):
            raise FormatError(f"{self.path}, line {line}: the {name} stands in another part, which is not read")
        if name == "model":
            self._head(attributes, line)
        elif name == "object":
            if attributes["id"] in self._objects:
                raise FormatError(f"{self.path}, line {line}: there is a second object {attributes['id'][:20]!r}")
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

    def _head(self, attributes: dict[str, str], line: int) -> None:
        """The unit, which is converted to millimetres, and the extensions that the file requires."""
        unit = attributes.get("unit", "millimeter")
        if unit not in MILLIMETRES:
            raise FormatError(f"{self.path}, line {line}: the unit {unit[:20]!r} is not known to 3MF")
        self.scale = MILLIMETRES[unit]
        if self.scale != 1:
            told = f"the unit is {unit}; coordinates are converted to millimetres (times {self.scale:g})"
            warnings.warn(f"{self.path.name}: {told}", Notice, stacklevel=2)
        for prefix in attributes.get("requiredextensions", "").split():
            space = attributes.get(f"xmlns:{prefix}", prefix)
            if not space.endswith(HARMLESS):
                raise FormatError(
                    f"{self.path}, line {line}: the file requires the extension {space[-60:]!r}, which is not read"
                )

    def require_room(self) -> None:
        """Raise FormatError where items and components repeat their parts too often, counted before any is made."""
        Budget(self.path, "the items and components of the model repeat their parts").spend(
            sum(self._cost(number) for number, _ in self.items)
        )

    def _cost(self, number: str, depth: int = 0) -> int:
        """How many calls and words the copies of an object take."""
        if number not in self._objects or depth > DEPTH:
            raise FormatError(f"{self.path}: the object {number[:20]!r} is not there, or is a part of itself")
        if number not in self._costs:
            found = self._objects[number]
            words = found.vertices.count(UNIT.encode()) + found.triangles.count(UNIT.encode())
            self._costs[number] = 1 + words + sum(self._cost(part, depth + 1) for part, _ in found.parts)
        return self._costs[number]

    def built(self, number: str, transform: str) -> list[Part]:
        """The meshes of an object and of its components, moved; they were counted before."""
        found = self._objects[number]
        if number not in self._parts and found.triangles:
            self._parts[number] = self._part(found)
        parts = [self._parts[number]] if number in self._parts else []
        for inner, place in found.parts:
            parts += self.built(inner, place)
        if not transform:
            return parts
        matrix = self._numbers(_row(*transform.split()), found)
        if matrix.size != 12:
            raise FormatError(f"{self.path}: a transform has {matrix.size} numbers, but 12 are required")
        matrix = matrix.reshape(4, 3)
        return [part.moved(matrix[:3], matrix[3]) for part in parts]

    def _part(self, found: _Object) -> Part:
        points = self._numbers(found.vertices, found).reshape(-1, 3)
        place = f"{self.path}, object at line {found.line}"
        numbers = whole(self._numbers(found.triangles, found), lambda k: f"{place}, triangle {k // 3}")
        sizes = np.full(len(numbers) // 3, 3, dtype=np.intp)
        return Part(points, sizes, corners(numbers, sizes, len(points), lambda _: place))

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
