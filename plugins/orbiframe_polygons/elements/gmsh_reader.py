"""Gmsh reader: triangles and quadrilaterals of .msh, versions 1, 2, 4.0 and 4.1, as text or binary."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from orbiframe import FormatError, Polyhedron
from orbiframe_polygons.elements.gmsh_cells import BELOW, CURVED, FACES, NAMES, SIZES
from orbiframe_polygons.elements.gmsh_source import Bytes, Source, Words
from orbiframe_polygons.elements.numbered import Numbered, tell_passed
from orbiframe_polygons.parts import polyhedron_of
from orbiframe_polygons.text import plain, shown, table

Ints = NDArray[np.intp]

SECTION = re.compile(rb"^[ \t]*\$(\w+)[^\n]*\n", re.MULTILINE)
FORMAT = re.compile(rb"\s*\$MeshFormat\s+([\d.]+)\s+([01])\s+([48])[ \t\r]*\n")
# Sections that leave the mesh as it is.
HARMLESS = frozenset(
    b"MeshFormat MeshVersion PhysicalNames Entities PartitionedEntities Periodic NodeData ElementData ElementNodeData "
    b"InterpolationScheme GhostElements Parametrizations Comments Comment NSides Partitions".split()
)
VERSIONS = ("1", "2", "2.0", "2.1", "2.2", "4", "4.0", "4.1")


def read(path: Path) -> Polyhedron:
    """The triangles and quadrilaterals of a Gmsh mesh, of all its entities.

    Points, lines and solids are passed over with a warning, as long as there are faces; data, names, periodic nodes and
    the parameters of nodes are skipped. Raises FormatError with the line or byte for sections that are not known, for
    faces of higher order, and where counts and numbers do not fit.

    Source: C. Geuzaine, J.-F. Remacle, Gmsh Reference Manual, "MSH file format".
    """
    data = path.read_bytes()
    head = FORMAT.match(data)
    block = Numbered(path)
    if head is not None and head[2] == b"1":
        _binary(path, data, head, block)
    else:
        _text(path, plain(path, data), block)
    tell_passed(path, [block])
    return polyhedron_of([block.part()])


# ---- sections -----------------------------------------------------------------------------------------------------


def _text(path: Path, text: bytes, block: Numbered) -> None:
    at, line, version, met = 0, 1, "1", set()
    while text[at:].strip():
        found = SECTION.search(text, at)
        if found is None or text[at : found.start()].strip():
            raise FormatError(
                f"{path}, line {line}: found {shown(text[at:].split(None, 1)[0])}, but a section must come"
            )
        name = found[1]
        line += text.count(b"\n", at, found.end())
        end = _end(path, text, name, found.end())
        body = text[found.end() : end]
        if name == b"MeshFormat":
            version = _version(path, body.split(None, 1)[0] if body.split() else b"")
        reader = _reader(path, name, version)
        if reader is not None:
            if name in met:
                raise FormatError(f"{path}, line {line - 1}: there is a second section ${name.decode()}")
            met.add(name)
            words = table(path, body, line=line)
            source = Words(path, words, words.numbers())
            reader(source, block)
            source.require_end()
        stop = text.find(b"\n", end)
        stop = len(text) if stop < 0 else stop + 1
        line += text.count(b"\n", found.end(), stop)
        at = stop


def _end(path: Path, text: bytes, name: bytes, start: int) -> int:
    ends = b"END" + name if name in (b"NOD", b"ELM") else b"End" + name
    found = re.compile(rb"^[ \t]*\$" + ends + rb"\b", re.MULTILINE).search(text, start)
    if found is None:
        raise FormatError(f"{path}: the section ${name.decode()} has no end (${ends.decode()}); is the file cut short?")
    return found.start()


def _binary(path: Path, data: bytes, head: re.Match[bytes], block: Numbered) -> None:
    version, size = _version(path, head[1]), int(head[3])
    one = data[head.end() : head.end() + 4]
    if one not in (b"\1\0\0\0", b"\0\0\0\1"):
        raise FormatError(f"{path}, byte {head.end()}: the number 1 is required, which tells the order of the bytes")
    order = "<" if one[0] else ">"
    at, met = _end(path, data, b"MeshFormat", head.end()), set()
    while True:
        at = data.find(b"\n", at) + 1 or len(data)
        if not data[at:].strip():
            return
        found = SECTION.match(data, at)
        if found is None:
            raise FormatError(
                f"{path}, byte {at}: found {shown(data[at : at + 20])}, but a section such as $Nodes is required"
            )
        name = found[1]
        reader = _reader(path, name, version)
        if reader is not None:
            if name in met:
                raise FormatError(f"{path}, byte {at}: there is a second section ${name.decode()}")
            met.add(name)
            source = Bytes(path, data, found.end(), order, size)
            if version[0] == "2":
                _binary_2(name, source, block)
            else:
                reader(source, block)
            at = source.at
            if not re.compile(rb"\s*\$End" + name).match(data, at):
                source.refuse(f"the section ${name.decode()} does not end after what its counts say")
            at = data.index(b"$End", at)
        else:
            at = _end(path, data, name, found.end())


def _version(path: Path, word: bytes) -> str:
    version = word.decode("ascii", errors="replace")
    if version not in VERSIONS:
        raise FormatError(f"{path}: this is MSH of version {version[:20]!r}; versions 1, 2, 4.0 and 4.1 are read")
    return version


def _reader(path: Path, name: bytes, version: str) -> Callable[[Source, Numbered], None] | None:
    """What reads a section; None for one that leaves the mesh as it is. Raises FormatError for all others."""
    key = "4.1" if version == "4.1" else version[0]
    readers = {
        (b"NOD", "1"): _nodes_2, (b"ELM", "1"): _elements_1, (b"Nodes", "2"): _nodes_2, (b"Elements", "2"): _elements_2,
        (b"ParametricNodes", "2"): _parametric_2, (b"Nodes", "4"): _nodes_40, (b"Elements", "4"): _elements_40,
        (b"Nodes", "4.1"): _nodes_41, (b"Elements", "4.1"): _elements_41,
    }  # fmt: skip
    if (name, key) in readers:
        return readers[name, key]
    if name in HARMLESS:
        return None
    if name == b"ParametricNodes" or name in (b"Nodes", b"Elements", b"NOD", b"ELM"):
        raise FormatError(f"{path}: the section ${name.decode()} does not belong to MSH of version {version}")
    raise FormatError(
        f"{path}: the section {shown(b'$' + name)} is not known, or changes what others mean; it is not read"
    )


def _points(x: NDArray[np.float64], y: NDArray[np.float64], z: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.stack([x, y, z], axis=1)


def _add(source: Source, block: Numbered, kind: int, names: Ints, corners: Ints) -> None:
    """Add elements of one type: faces, or others that are passed over."""
    if kind in FACES:
        block.add_faces(names, corners)
    elif kind in CURVED:
        source.refuse(f"found faces of the type {kind}, of higher order; save the mesh with order 1")
    else:
        block.skip(NAMES[kind], len(names), solid=kind not in BELOW)


def _size(source: Source, kind: int) -> int:
    if kind not in SIZES:
        source.refuse(f"found the element type {kind}, which is not known")
    return SIZES[kind]


# ---- versions 1 and 2 ---------------------------------------------------------------------------------------------


def _nodes_2(source: Source, block: Numbered) -> None:
    count = int(source.take("i")[0][0])
    numbers, *xyz = source.take("iddd", count)
    block.add_nodes(numbers, _points(*xyz))


def _parametric_2(source: Source, block: Numbered) -> None:
    """Nodes with the entity that they lie on, and one or two parameters for a curve or a surface."""
    count = int(source.take("i")[0][0])
    for _ in range(count):
        number, x, y, z, dimension, _ = source.take("idddii")
        block.add_nodes(number, _points(x, y, z))
        if not 0 <= dimension[0] <= 3:
            source.refuse(f"found the dimension {dimension[0]}, but 0 to 3 is required")
        source.take("d" * (int(dimension[0]) % 3))


def _elements_1(source: Source, block: Numbered) -> None:
    _listed(source, block, first_version=True)


def _elements_2(source: Source, block: Numbered) -> None:
    _listed(source, block, first_version=False)


def _listed(source: Source, block: Numbered, *, first_version: bool) -> None:
    """Elements one by one, each with its type and its tags; runs of one type are added together."""
    assert isinstance(source, Words)
    count = int(source.take("i")[0][0])
    run: list[list[int]] = []
    last = 0

    def add() -> None:
        if run:
            rows = np.array(run, dtype=np.intp)
            _add(source, block, last, rows[:, 0], rows[:, 1:])
            run.clear()

    for _ in range(count):
        number, kind = (int(column[0]) for column in source.take("ii"))
        size = _size(source, kind)
        if first_version:
            tags, stated = 2, True
        else:
            tags, stated = int(source.take("i")[0][0]), False
        if not 0 <= tags < 1000:
            source.refuse(f"found {tags} as the number of tags")
        source.take("i" * tags)
        if stated and int(source.take("i")[0][0]) != size:
            source.refuse(f"an element of the type {kind} has {size} nodes, but another number is said")
        corners = [int(column[0]) for column in source.take("i" * size)]
        if kind != last:
            add()
            last = kind
        run.append([number, *corners])
    add()


def _binary_2(name: bytes, source: Bytes, block: Numbered) -> None:
    """The count of a section of version 2 is text."""
    end = source.data.find(b"\n", source.at)
    word = source.data[source.at : max(end, source.at)].strip()
    if not word.isdigit() or len(word) > 15:
        source.refuse(f"found {shown(word)}, but a count is required")
    count = int(word)
    source.at = end + 1
    if name == b"Nodes":
        numbers, *xyz = source.take("iddd", count)
        block.add_nodes(numbers, _points(*xyz))
        return
    if name != b"Elements":
        source.refuse(f"the section ${name.decode()} is not read in binary files of version 2")
    while count > 0:
        kind, rows, tags = (int(column[0]) for column in source.take("iii"))
        size = _size(source, kind)
        if not 0 < rows <= count or not 0 <= tags < 1000:
            source.refuse(f"found {rows} elements with {tags} tags, where {count} elements are left")
        columns = source.take("i" * (1 + tags + size), rows)
        _add(source, block, kind, columns[0], np.stack(columns[1 + tags :], axis=1))
        count -= rows


# ---- version 4 ----------------------------------------------------------------------------------------------------


def _nodes_40(source: Source, block: Numbered) -> None:
    blocks, total = (int(column[0]) for column in source.take("ss"))
    for _ in range(blocks):
        _, dimension, parametric, count = (int(column[0]) for column in source.take("iiis"))
        width = _parameters(source, dimension, parametric)
        numbers, x, y, z, *_ = source.take("iddd" + "d" * width, count)
        block.add_nodes(numbers, _points(x, y, z))
        total -= count
    _require_none_left(source, total, "nodes")


def _nodes_41(source: Source, block: Numbered) -> None:
    blocks, total, _, _ = (int(column[0]) for column in source.take("ssss"))
    for _ in range(blocks):
        dimension, _, parametric, count = (int(column[0]) for column in source.take("iiis"))
        width = _parameters(source, dimension, parametric)
        numbers = source.take("s", count)[0]
        x, y, z, *_ = source.take("ddd" + "d" * width, count)
        block.add_nodes(numbers, _points(x, y, z))
        total -= count
    _require_none_left(source, total, "nodes")


def _parameters(source: Source, dimension: int, parametric: int) -> int:
    """How many parameters each node of an entity has."""
    if not 0 <= dimension <= 3 or parametric not in (0, 1):
        source.refuse(
            f"found nodes of the dimension {dimension} with the mark {parametric}; is it the version it says?"
        )
    return dimension * parametric


def _elements_40(source: Source, block: Numbered) -> None:
    blocks, total = (int(column[0]) for column in source.take("ss"))
    for _ in range(blocks):
        _, dimension, kind, count = (int(column[0]) for column in source.take("iiis"))
        total -= _entity(source, block, dimension, kind, count, "i")
    _require_none_left(source, total, "elements")


def _elements_41(source: Source, block: Numbered) -> None:
    blocks, total, _, _ = (int(column[0]) for column in source.take("ssss"))
    for _ in range(blocks):
        dimension, _, kind, count = (int(column[0]) for column in source.take("iiis"))
        total -= _entity(source, block, dimension, kind, count, "s")
    _require_none_left(source, total, "elements")


def _entity(source: Source, block: Numbered, dimension: int, kind: int, count: int, number: str) -> int:
    """Add the elements of one entity; how many they are."""
    size = _size(source, kind)
    of = 0 if kind == 15 else 1 if kind in BELOW else 2 if kind in FACES or kind in CURVED else 3
    if dimension != of:
        source.refuse(f"found elements of the type {kind} in the dimension {dimension}, but {of} is required")
    names, *columns = source.take(number * (1 + size), count)
    _add(source, block, kind, names, np.stack(columns, axis=1))
    return count


def _require_none_left(source: Source, left: int, what: str) -> None:
    if left:
        source.refuse(f"the number of {what} differs by {abs(left)} from the sum over the entities")
