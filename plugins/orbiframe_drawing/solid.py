"""A surface in space: shaded as an image, with the lines on it that are not hidden."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from orbiframe import Polyhedron
from orbiframe.compiled import compiled
from orbiframe.meshes import triangulated
from orbiframe_drawing.colours import channels
from orbiframe_drawing.picture import Curve, Raster, polyline

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

VIEW = (0.42, -0.72, 0.85)
_PIXELS = 600  # along the longer side; colours are means of _FINE x _FINE samples
_FINE = 2
_CLAY = np.array(channels("#c3d3e2"), dtype=np.float64)
_LIGHT = np.array([-0.35, 0.55, 0.76])
_AMBIENT, _SHADES = 0.42, 36
# A point of a line is hidden behind a surface that is nearer to the eye by this share of the extent.
_BEHIND = 0.008
_STEPS = 4  # points of a line for every sample of depth across which it runs


@dataclass(frozen=True, eq=False)
class Solid3D:
    """A polyhedron seen from far away, in a window of a given width in points.

    view: the direction from the surface to the eye; the third axis points up on the page.
    """

    polyhedron: Polyhedron
    width: float
    view: tuple[float, float, float] = VIEW
    smooth: bool = False

    @cached_property
    def axes(self) -> Floats:
        """Right, up and towards the eye, as rows."""
        eye = np.array(self.view) / np.linalg.norm(self.view)
        up = np.array([0.0, 0.0, 1.0]) if np.hypot(eye[0], eye[1]) > 1e-6 else np.array([0.0, 1.0, 0.0])
        right = np.cross(up, eye)
        right /= np.linalg.norm(right)
        return np.stack([right, np.cross(eye, right), eye])

    @cached_property
    def _frame(self) -> tuple[Floats, float]:
        """The middle of the view, and points of the page for a unit of space."""
        at = self.polyhedron.vertices @ self.axes.T
        low, high = at.min(axis=0), at.max(axis=0)
        return (low + high) / 2, self.width / max(float(high[0] - low[0]), 1e-300)

    @cached_property
    def height(self) -> float:
        """Of the window, in points."""
        at = self.polyhedron.vertices @ self.axes[1]
        return float(at.max() - at.min()) * self._frame[1]

    def place(self, points: ArrayLike) -> Floats:
        """Right, up and towards the eye of points (n, 3), in points of the page about the middle."""
        middle, scale = self._frame
        return np.asarray((np.asarray(points) @ self.axes.T - middle) * scale)

    @property
    def box(self) -> tuple[float, float, float, float]:
        """The window: left, bottom, right, top."""
        return -self.width / 2, -self.height / 2, self.width / 2, self.height / 2

    @cached_property
    def _samples(self) -> float:
        """Samples of depth for a point of the page."""
        return _FINE * _PIXELS / max(self.width, self.height)

    @cached_property
    def _triangles(self) -> Ints:
        return triangulated(self.polyhedron).triangles

    @cached_property
    def _buffers(self) -> tuple[Floats, Floats]:
        """Depth (h, w), -inf where there is nothing, and brightness (h, w), from the top row down."""
        corner = np.array([-self.width / 2, self.height / 2, 0.0])
        at = (self.place(self.polyhedron.vertices) - corner) * self._samples * [1, -1, 1]
        size = [max(int(np.ceil(length * self._samples / _FINE)), 1) * _FINE for length in (self.height, self.width)]
        depth, brightness = np.full(size, -np.inf), np.zeros(size)
        _fill(np.ascontiguousarray(at[self._triangles]), self._brightness(), depth, brightness)
        return depth, brightness

    def _brightness(self) -> Floats:
        """Of the corners of every triangle, (F, 3): by the normal of its face, or of the vertices where smooth."""
        x = self.polyhedron.vertices[self._triangles]
        face = np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0])
        normal = np.repeat(face[:, None], 3, axis=1)
        if self.smooth:
            at_vertex = np.zeros_like(self.polyhedron.vertices)
            np.add.at(at_vertex, self._triangles, normal)
            normal = at_vertex[self._triangles]
        normal = normal / np.maximum(np.linalg.norm(normal, axis=2, keepdims=True), 1e-300)
        # Both sides of a face are lit, the one that is seen by the light: no matter how the faces run.
        toward = normal @ self.axes.T
        sign = np.where(toward[..., 2:] < 0, -1.0, 1.0)
        light = np.maximum(toward * sign @ (_LIGHT / np.linalg.norm(_LIGHT)), 0.0)
        return np.asarray(_AMBIENT + (1 - _AMBIENT) * light)

    def image(self) -> Raster:
        """The shaded surface; transparent where there is nothing."""
        depth, brightness = self._buffers
        rows, columns = depth.shape[0] // _FINE, depth.shape[1] // _FINE
        cover = np.isfinite(depth)
        share = cover.reshape(rows, _FINE, columns, _FINE).mean(axis=(1, 3))
        total = (brightness * cover).reshape(rows, _FINE, columns, _FINE).mean(axis=(1, 3))
        shade = np.round(total / np.where(share > 0, share, 1.0) * _SHADES) / _SHADES
        colours = np.empty((rows, columns, 4), dtype=np.uint8)
        bright = 255 - (255 - _CLAY) * np.minimum(2 - 1.15 * shade, 1.6)[..., None]
        colours[..., :3] = np.clip(np.minimum(shade * 1.12, 1.0)[..., None] * bright, 0, 255) * (share > 0)[..., None]
        colours[..., 3] = np.round(255 * share)
        left, _, _, top = self.box
        pixel = _FINE / self._samples
        return Raster(colours, (left, top - rows * pixel, left + columns * pixel, top))

    def lines(self, chains: Sequence[Floats], hidden: bool = False) -> list[list[Curve]]:
        """The parts of polygonal lines (n, 3) in space that are seen, or those that are hidden."""
        return [polyline(part) for chain in chains for part in self._parts(self.place(chain), hidden)]

    def _parts(self, at: Floats, hidden: bool) -> list[Floats]:
        """Runs of points of a chain that are on the wanted side, its own corners and the ends of the runs."""
        length = np.linalg.norm(np.diff(at[:, :2], axis=0), axis=1)
        counts = np.maximum(np.ceil(length * self._samples / _STEPS), 1).astype(np.intp)
        t = np.concatenate([k + np.arange(count) / count for k, count in enumerate(counts)] + [[float(len(counts))]])
        points = np.stack([np.interp(t, np.arange(len(at)), column) for column in at.T], axis=1)
        shown = self._seen(points) != hidden
        cuts = np.flatnonzero(np.diff(shown.astype(np.int8))) + 1
        corner = t == np.round(t)
        found = []
        for run in np.split(np.arange(len(t)), cuts):
            if shown[run[0]] and len(run) > 1:
                kept = corner[run]
                kept[[0, -1]] = True
                found.append(points[run[kept], :2])
        return found

    def _seen(self, points: Floats) -> NDArray[np.bool_]:
        """Which points (n, 3) of the page have nothing before them, nowhere in the samples round them."""
        depth, _ = self._buffers
        row = (self.height / 2 - points[:, 1]) * self._samples
        column = (points[:, 0] + self.width / 2) * self._samples
        nearest = np.full(len(points), np.inf)
        for down in (-1, 0, 1):
            for right in (-1, 0, 1):
                i = np.clip(row.astype(np.intp) + down, 0, depth.shape[0] - 1)
                j = np.clip(column.astype(np.intp) + right, 0, depth.shape[1] - 1)
                nearest = np.minimum(nearest, depth[i, j])
        allowed = _BEHIND * max(self.width, self.height) * self._samples
        return np.asarray(nearest <= points[:, 2] * self._samples + allowed)


@compiled
def _fill(at, light, depth, brightness):  # type: ignore[no-untyped-def]
    """Draw triangles at (F, 3, 3), in samples from the top left, with brightnesses (F, 3), nearest to the eye first."""
    rows, columns = depth.shape
    for f in range(len(at)):
        (x0, y0, z0), (x1, y1, z1), (x2, y2, z2) = at[f]
        area = (x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0)
        if area == 0.0:
            continue
        first_row, last_row = max(int(np.floor(min(y0, y1, y2))), 0), min(int(np.ceil(max(y0, y1, y2))), rows - 1)
        first, last = max(int(np.floor(min(x0, x1, x2))), 0), min(int(np.ceil(max(x0, x1, x2))), columns - 1)
        for i in range(first_row, last_row + 1):
            y = i + 0.5
            for j in range(first, last + 1):
                x = j + 0.5
                a = ((x1 - x) * (y2 - y) - (x2 - x) * (y1 - y)) / area
                b = ((x2 - x) * (y0 - y) - (x0 - x) * (y2 - y)) / area
                c = 1.0 - a - b
                if a < -1e-9 or b < -1e-9 or c < -1e-9:
                    continue
                z = a * z0 + b * z1 + c * z2
                if z > depth[i, j]:
                    depth[i, j] = z
                    brightness[i, j] = a * light[f, 0] + b * light[f, 1] + c * light[f, 2]
