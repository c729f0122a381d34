"""Shaded picture: a mesh in space as an image, made of points alone, without any library of graphics."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from orbiframe.errors import UsageError
from orbiframe.meshes.face_diagonals import triangulated
from orbiframe.meshes.polyhedron import Polyhedron

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
View = tuple[float, float, float]

VIEW: View = (0.42, -0.72, 0.85)
# Colours are means of _FINE x _FINE samples; samples of a triangle are so many samples of the picture apart, at most.
_FINE, _APART, _MARGIN = 2, 0.8, 0.03
_CLAY = np.array([195.0, 211.0, 226.0])
_LIGHT = np.array([-0.35, 0.55, 0.76]) / np.linalg.norm([-0.35, 0.55, 0.76])
_AMBIENT = 0.42
_LARGEST = 4096
# A line is drawn where nothing is nearer to the eye by more than this share of the extent, in samples so far apart.
_BEHIND, _STEP, _INK = 0.01, 0.7, np.array([0.12, 0.16, 0.2])
_SAMPLES_AT_ONCE = 1 << 21


@dataclass(frozen=True, eq=False)
class ShadedPicture:
    """An image with 4 channels, pixels (h, w, 4) from 0 to 255, transparent where there is nothing."""

    pixels: NDArray[np.uint8]

    def __repr__(self) -> str:
        return f"<ShadedPicture: {self.pixels.shape[1]} x {self.pixels.shape[0]} pixels>"

    @cached_property
    def png(self) -> bytes:
        """The image as a PNG file."""
        height, width = self.pixels.shape[:2]
        rows = np.zeros((height, 1 + 4 * width), dtype=np.uint8)
        rows[:, 1:] = self.pixels.reshape(height, -1)
        header = struct.pack(">IIBBBBB", width, height, 8, 6, 0, 0, 0)
        chunks = ((b"IHDR", header), (b"IDAT", zlib.compress(rows.tobytes(), 6)), (b"IEND", b""))
        return b"\x89PNG\r\n\x1a\n" + b"".join(_chunk(name, content) for name, content in chunks)

    def _repr_png_(self) -> bytes:
        return self.png

    def save(self, path: str | Path) -> None:
        """Write the PNG file; it appears whole or not at all. Raises UsageError for another suffix."""
        path = Path(path)
        if path.suffix.lower() != ".png":
            raise UsageError(f"{path}: a picture is written as .png; give it this suffix")
        unfinished = path.with_name(f".{path.name}.unfinished")
        unfinished.write_bytes(self.png)
        unfinished.replace(path)


def _chunk(name: bytes, content: bytes) -> bytes:
    return struct.pack(">I", len(content)) + name + content + struct.pack(">I", zlib.crc32(name + content))


def shaded_picture(
    mesh: Polyhedron,
    *,
    width: int = 480,
    view: View = VIEW,
    colours: Floats | None = None,
    lines: Sequence[Floats] = (),
) -> ShadedPicture:
    """A mesh seen from far away, lit from above on the left; smooth where the mesh has normals, else with its facets.

    width: of the image, in pixels; view: the direction from the mesh to the eye; the third axis points up. colours:
    (V, 3), red, green and blue from 0 to 1 at the vertices; lines: chains of points (n, 3) in space, dark where they
    are seen. Raises UsageError for a width that is not 1 to 4096, and a view that is no direction.
    """
    if not 1 <= width <= _LARGEST:
        raise UsageError(f"a picture {width} pixels wide; give 1 to {_LARGEST}")
    axes = _axes(np.asarray(view, dtype=np.float64))
    triangles = triangulated(mesh)
    corners, light = triangles.vertices[triangles.triangles] @ axes.T, _light(triangles, axes)
    frame = _Frame.of(corners, width * _FINE)
    place, height = frame.placed(corners), frame.height
    size = height * _FINE * width * _FINE
    # Brightness, and where there are colours red, green and blue, lit.
    seen = light[..., None] if colours is None else _lit(light, colours[triangles.triangles])
    depth, shade = np.full(size, -np.inf), np.zeros((size, seen.shape[2]))
    for count, part in _parts(place):
        _splat(count, place[part], seen[part], width * _FINE, depth, shade)
    for line in lines:
        _draw(frame.placed(np.asarray(line) @ axes.T), width * _FINE, depth, shade)
    return ShadedPicture(_coloured(depth, shade, height, width))


def _lit(light: Floats, colours: Floats) -> Floats:
    """Colours (F, 3, 3) at corners with a brightness (F, 3) each."""
    return np.asarray(np.clip(colours * (0.35 + 0.75 * light[..., None]), 0.0, 1.0))


def _axes(eye: Floats) -> Floats:
    """Right, up and towards the eye, as rows."""
    length = np.linalg.norm(eye)
    if eye.shape != (3,) or not (np.isfinite(length) and length > 0):
        raise UsageError(f"the view {eye.tolist()} is no direction; give three numbers such as {VIEW}")
    eye = eye / length
    right = np.cross([0.0, 0.0, 1.0] if np.hypot(eye[0], eye[1]) > 1e-6 else [0.0, 1.0, 0.0], eye)
    right /= np.linalg.norm(right)
    return np.stack([right, np.cross(eye, right), eye])


def _light(mesh: Polyhedron, axes: Floats) -> Floats:
    """The brightness at the corners of every triangle, (F, 3); both sides of a face are lit."""
    corners = mesh.vertices[mesh.triangles]
    flat = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals = np.repeat(flat[:, None], 3, axis=1) if mesh.normals is None else mesh.normals[mesh.triangles]
    length = np.linalg.norm(normals, axis=2, keepdims=True)
    seen = (normals / np.where(length > 0, length, 1.0)) @ axes.T
    seen = np.where(seen[..., 2:] < 0, -seen, seen)
    return np.asarray(_AMBIENT + (1 - _AMBIENT) * np.maximum(seen @ _LIGHT, 0.0))


class _Frame(NamedTuple):
    """Where points lie on the page, in samples: their middle, samples for a unit, the page's width; pixels high."""

    middle: Floats
    scale: float
    width: int
    height: int

    @classmethod
    def of(cls, corners: Floats, width: int) -> _Frame:
        """The frame of a page that corners (F, 3, 3) fill."""
        low, high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
        extent = max(float(high[0] - low[0]), float(high[1] - low[1]) / 4, np.finfo(float).tiny)
        scale = (1 - 2 * _MARGIN) * width / extent
        height = int(np.ceil((float(high[1] - low[1]) * scale + 2 * _MARGIN * width) / _FINE))
        return cls((low + high) / 2, scale, width, height)

    def placed(self, points: Floats) -> Floats:
        """Column, row and height above the page of points (…, 3)."""
        place = (points - self.middle) * self.scale * np.array([1.0, -1.0, 1.0])
        return np.asarray(place + np.array([self.width / 2, self.height * _FINE / 2, 0.0]))


def _parts(place: Floats) -> list[tuple[int, Ints]]:
    """The triangles that need the same number of samples along a side, in parts without too many samples."""
    count = _counts(place)
    parts: list[tuple[int, Ints]] = []
    for number in np.unique(count).tolist():
        chosen = np.flatnonzero(count == number)
        step = max(1, _SAMPLES_AT_ONCE // number**2)
        parts += [(number, chosen[start : start + step]) for start in range(0, len(chosen), step)]
    return parts


def _counts(place: Floats) -> Ints:
    """How many samples along a side every triangle needs, or up to a tenth more, so that many triangles are alike."""
    sides = np.linalg.norm(place[:, [1, 2, 0], :2] - place[:, :, :2], axis=2).max(axis=1)
    return np.asarray(np.ceil(1.1 ** np.ceil(np.log(np.maximum(sides / _APART, 1.0)) / np.log(1.1))), dtype=np.intp)


def _splat(count: int, place: Floats, light: Floats, width: int, depth: Floats, shade: Floats) -> None:
    """Set the samples of some triangles, `count` along a side, where they are nearer to the eye than what is there."""
    i, j = np.meshgrid(np.arange(count + 1), np.arange(count + 1), indexing="ij")
    inside = i + j <= count
    weights = np.stack([i[inside], j[inside], count - i[inside] - j[inside]], axis=1) / count
    points = np.einsum("sc,fci->fsi", weights, place).reshape(-1, 3)
    bright = np.einsum("sc,fck->fsk", weights, light).reshape(-1, light.shape[2])
    column, row = points[:, 0].astype(np.intp), points[:, 1].astype(np.intp)
    pixel = row * width + column
    order = np.argsort(points[:, 2], kind="stable")
    order = order[points[order, 2] > depth[pixel[order]]]
    # Of several values for one place the last is kept, the one nearest to the eye.
    depth[pixel[order]] = points[order, 2]
    shade[pixel[order]] = bright[order]


def _draw(at: Floats, width: int, depth: Floats, shade: Floats) -> None:
    """Darken the samples along a chain of points, two wide, where the chain is not behind something."""
    length = np.linalg.norm(np.diff(at[:, :2], axis=0), axis=1)
    along = np.concatenate([[0.0], np.cumsum(length)])
    steps = np.linspace(0.0, along[-1], 2 + int(along[-1] / _STEP))
    points = np.stack([np.interp(steps, along, column) for column in at.T], axis=1)
    allowed = points[:, 2] + _BEHIND * width
    for right, down in ((0, 0), (1, 0), (0, 1), (1, 1)):
        column, row = points[:, 0].astype(np.intp) + right, points[:, 1].astype(np.intp) + down
        inside = (column >= 0) & (column < width) & (row >= 0) & (row < len(depth) // width)
        pixel = (row * width + column)[inside]
        seen = pixel[(depth[pixel] <= allowed[inside]) & np.isfinite(depth[pixel])]
        shade[seen] = _INK if shade.shape[1] == 3 else _INK[0]


def _coloured(depth: Floats, shade: Floats, height: int, width: int) -> NDArray[np.uint8]:
    """The pixels, each the mean of its samples."""
    shape = (height, _FINE, width, _FINE)
    cover = np.isfinite(depth).reshape(shape)
    share = cover.mean(axis=(1, 3))
    total = (shade.reshape(*shape, -1) * cover[..., None]).mean(axis=(1, 3))
    mean = total / np.where(share > 0, share, 1.0)[..., None]
    if mean.shape[2] == 1:
        bright = 255 - (255 - _CLAY) * np.minimum(2 - 1.15 * mean, 1.6)
        mean = np.minimum(mean * 1.12, 1.0) * bright / 255
    pixels = np.empty((height, width, 4), dtype=np.uint8)
    pixels[..., :3] = np.clip(255 * mean, 0, 255) * (share > 0)[..., None]
    pixels[..., 3] = np.round(255 * share)
    return pixels
