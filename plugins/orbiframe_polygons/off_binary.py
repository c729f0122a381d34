"""Binary OFF: the Object File Format of Geomview with big-endian numbers after its header line."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from orbiframe import FormatError
from orbiframe_polygons.faces import corners, require_finite, require_sizes

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

MOST_COLOURS = 4


def parts(path: Path, data: bytes, at: int, width: int) -> tuple[Floats, Ints, Ints, Floats | None]:
    """The rows of the vertices, and the sizes, corners and colours of the faces, from a byte on.

    width: how many numbers a vertex has. Raises FormatError with the byte where counts and bytes do not fit.
    """
    vertices, faces, _ = _whole(path, data, at, 3).tolist()
    at += 12
    if vertices < 0 or faces < 0 or 4 * (vertices * width + 2 * faces) > len(data) - at:
        raise FormatError(
            f"{path}, byte {at - 12}: the file is binary; {vertices} vertices and {faces} faces are declared, but "
            f"{len(data) - at} bytes follow; is the file cut short?"
        )
    points = np.frombuffer(data, ">f4", vertices * width, at).astype(np.float64).reshape(vertices, width)
    require_finite(points, lambda row: f"{path}, byte {at + 4 * width * row}")
    return points, *_faces(path, data, at + 4 * vertices * width, faces, vertices)


def _whole(path: Path, data: bytes, at: int, count: int) -> NDArray[np.int32]:
    if at + 4 * count > len(data):
        raise FormatError(f"{path}, byte {at}: {count} whole numbers are required, but the file ends; is it cut short?")
    return np.frombuffer(data, ">i4", count, at).astype(np.int32)


def _faces(path: Path, data: bytes, at: int, count: int, vertices: int) -> tuple[Ints, Ints, Floats | None]:
    """Each face is its size, its corners, the size of its colour, and its colour."""
    if (len(data) - at) % 4:
        raise FormatError(f"{path}, byte {len(data)}: the file ends inside a number; is it cut short?")
    words = np.frombuffer(data, ">i4", offset=at).astype(np.int64)
    listed, end, first, sizes, colours = words.tolist(), 0, [], [], []
    for face in range(count):
        size = listed[end] if end < len(listed) else -1
        there = 0 <= size < len(listed) and end + size + 1 < len(listed)
        colour = listed[end + size + 1] if there else -1
        if not 0 <= colour <= MOST_COLOURS:
            raise FormatError(f"{path}, byte {at + 4 * end}: face {face} does not fit into the file")
        first.append(end + 1)
        sizes.append(size)
        colours.append(colour)
        end += size + 2 + colour
    if end != len(listed):
        raise FormatError(f"{path}, byte {at + 4 * end}: the file does not end with its last face; is it cut short?")
    lengths = np.array(sizes, dtype=np.intp)

    def place(face: int) -> str:
        return f"{path}, byte {at + 4 * (first[face] - 1)}"

    require_sizes(lengths, place)
    tail = np.concatenate([words[a : a + n] for a, n in zip(first, sizes, strict=True)] or [np.empty(0, np.int64)])
    return lengths, corners(tail, lengths, vertices, place), _colours(data, at, first, sizes, colours)


def _colours(data: bytes, at: int, first: list[int], sizes: list[int], colours: list[int]) -> Floats | None:
    if len(set(colours)) != 1 or colours[0] < 3:
        return None
    rows = [np.frombuffer(data, ">f4", colours[0], at + 4 * (a + n + 1)) for a, n in zip(first, sizes, strict=True)]
    return np.array(rows, dtype=np.float64)
