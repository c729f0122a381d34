"""Pictures: a tile for every surface, and sheets of tiles, a row for every shape."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
import pyvista as pv
from numpy.typing import NDArray

from orbiframe import Polyhedron
from orbiframe.meshes import triangulated

Floats = NDArray[np.float64]

_SIDE = 420
_ROWS = 6
_CLAY = {"color": "#c9d6e4", "specular": 0.5, "specular_power": 30, "diffuse": 0.8, "ambient": 0.1}


View = list[tuple[float, ...]]


def tile(vertices: Floats, triangles: NDArray[np.intp], path: Path, view: View, *, flat: bool = False) -> None:
    """A picture of a surface; flat: its faces with their edges."""
    plotter = pv.Plotter(off_screen=True, window_size=(_SIDE, _SIDE))
    plotter.set_background("white")
    mesh = pv.PolyData.from_regular_faces(vertices, triangles)
    style = {"show_edges": True, "line_width": 1} if flat else {"smooth_shading": True, "split_sharp_edges": False}
    plotter.add_mesh(mesh, **_CLAY, **style)
    plotter.camera_position = view
    plotter.camera.zoom(1.45)
    plotter.screenshot(path)
    plotter.close()


def input_tile(mesh: Polyhedron, path: Path) -> None:
    """The mesh itself."""
    cut = triangulated(mesh)
    tile(cut.vertices, cut.triangles, path, view_of(mesh), flat=True)


def view_of(mesh: Polyhedron) -> View:
    """A view of a mesh and of all its surfaces, from above its thinnest side."""
    vertices = mesh.vertices
    middle = (vertices.max(axis=0) + vertices.min(axis=0)) / 2
    _, axes = np.linalg.eigh(np.cov((vertices - middle).T))
    sight = axes[:, 0] + 0.55 * axes[:, 1] + 0.25 * axes[:, 2]
    sight *= np.sign(sight[np.argmax(np.abs(sight))])
    return [tuple(middle + 2 * mesh.diagonal * sight / np.linalg.norm(sight)), tuple(middle), tuple(axes[:, 1])]


def sheets(
    folder: Path, shapes: Sequence[str], methods: Sequence[str], labels: dict[tuple[str, str], str]
) -> list[Path]:
    """Sheets of the tiles that are there, some shapes on each."""
    made = []
    for number, start in enumerate(range(0, len(shapes), _ROWS)):
        rows = shapes[start : start + _ROWS]
        figure, axes = plt.subplots(
            len(rows), len(methods) + 1, figsize=(2.3 * (len(methods) + 1), 2.5 * len(rows)), squeeze=False
        )
        for axis in axes.ravel():
            axis.axis("off")
        for i, shape in enumerate(rows):
            for j, method in enumerate(("mesh", *methods)):
                _show(
                    axes[i, j],
                    folder / tile_name(shape, method),
                    f"{shape if j == 0 else method}\n{labels.get((shape, method), '')}",
                )
        figure.subplots_adjust(0, 0, 1, 0.97, 0, 0.1)
        made.append(folder / f"sheet_{number + 1}.png")
        figure.savefig(made[-1], dpi=80)
        plt.close(figure)
    return made


def _show(axis: plt.Axes, path: Path, title: str) -> None:
    if path.exists():
        axis.imshow(plt.imread(path))
    axis.set_title(title, fontsize=8)


def tile_name(shape: str, method: str) -> str:
    """The file of a tile."""
    return "".join(c if c.isalnum() else "_" for c in f"{shape}__{method}") + ".png"
