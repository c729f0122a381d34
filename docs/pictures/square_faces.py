"""Make the pictures of square-like faces: `python docs/pictures/square_faces.py [FOLDER]`; needs `.[pictures]`.

The mesh is a plate with two holes, stretched so that its squares are bricks of 3 : 1. Left the map as it comes, right
the map with regular faces: first the tessellation of the Poincare disc, then the smooth surface with its parameter
lines, geodesics of X/H that cut every face in three by three.
"""

from __future__ import annotations

import sys
from pathlib import Path

import matplotlib
import matplotlib.pyplot as plt
import numpy as np
import pyvista as pv
from matplotlib.collections import LineCollection
from numpy.typing import NDArray
from PIL import Image

from orbiframe import Config, OrbifoldSurface, Points, Polyhedron, Registry, fit
from orbiframe.files import gate
from orbiframe.meshes.face_diagonals import outline

Floats = NDArray[np.float64]

DATASETS = Path(__file__).parents[2] / "datasets"
STRETCH = np.array([3.0, 1.0, 1.0])
RADIUS = 4.6
LINE = 12
PARTS = 3
BLUE, GREY, ORANGE = "#1d4e89", "#b9c2cc", "#c8641e"


def lifted_faces(surface: OrbifoldSurface, polyhedron: Polyhedron) -> tuple[NDArray[np.intp], Floats]:
    """The patch of the first corner of every quadrilateral, (F,), and its corners in that frame, (F, 4, 3)."""
    triangulation = surface.triangulation
    steps = surface.refinement.composed(surface.orbifold.atlas.isometry[triangulation.transition])[outline(polyhedron)]
    steps = steps.reshape(-1, 4, 3, 3)
    vertices = polyhedron.tail.reshape(-1, 4)
    frame, corners = np.tile(np.eye(3), (len(vertices), 1, 1)), []
    for k in range(4):
        corners.append(np.einsum("fij,fj->fi", frame, triangulation.points[vertices[:, k]]))
        frame = frame @ steps[:, k]
    return triangulation.patch[vertices[:, 0]], np.stack(corners, axis=1)


def draw_disc(axes: plt.Axes, surface: OrbifoldSurface, polyhedron: Polyhedron, title: str) -> None:
    """All copies of the faces within a radius, one copy of each dark."""
    geometry = surface.orbifold.geometry
    patch, corners = lifted_faces(surface, polyhedron)
    copies, isometry = surface.orbifold.lifts(int(patch[0]), RADIUS)
    centre = geometry.project(corners.sum(axis=1))
    nearest = np.full(len(patch), np.inf)
    images = []
    for home, g in zip(copies, isometry, strict=True):
        here = np.flatnonzero(patch == home)
        far = geometry.distance(geometry.origin, geometry.act(g, centre[here]))
        images.append((here, far, geometry.act(g, corners[here])))
        nearest[here] = np.minimum(nearest[here], far)
    t = np.linspace(0, 1, LINE)[:, None]
    for dark in (False, True):
        lines = []
        for here, far, image in images:
            chosen = image[far <= nearest[here] + 1e-9 if dark else far > nearest[here] + 1e-9]
            for k in range(4):
                side = geometry.geodesic(chosen[:, k, None], chosen[:, (k + 1) % 4, None], t[:, 0])
                lines.extend(geometry.to_chart("conformal", side))
        axes.add_collection(LineCollection(lines, colors=BLUE if dark else GREY, linewidths=1.1 if dark else 0.35))
    axes.add_patch(plt.Circle((0, 0), 1, fill=False, color="black", linewidth=1))
    axes.set(xlim=(-1.02, 1.02), ylim=(-1.02, 1.02), aspect="equal", title=title)
    axes.axis("off")


def parameter_lines(surface: OrbifoldSurface, polyhedron: Polyhedron) -> tuple[Floats, Floats]:
    """The sides of all faces on the surface, and the lines between them, (lines, points, 3) each."""
    geometry = surface.orbifold.geometry
    patch, corners = lifted_faces(surface, polyhedron)
    found = []
    for inner in (False, True):
        lines = []
        for a, b, c, d in ((0, 1, 3, 2), (0, 3, 1, 2)):
            for t in np.arange(1, PARTS) / PARTS if inner else (0.0, 1.0):
                start = geometry.geodesic(corners[:, a], corners[:, b], np.full(len(patch), t))
                end = geometry.geodesic(corners[:, c], corners[:, d], np.full(len(patch), t))
                lines.append(geometry.geodesic(start[:, None], end[:, None], np.linspace(0, 1, LINE)))
        line = np.concatenate(lines)
        home = np.tile(patch, len(lines))
        points = in_nearest_patch(surface, np.repeat(home, LINE), line.reshape(-1, 3))
        found.append(surface.evaluate(points).reshape(-1, LINE, 3))
    return found[0], found[1]


def in_nearest_patch(surface: OrbifoldSurface, patch: NDArray[np.intp], x: Floats) -> Points:
    """The same points of X/H, each in the patch whose origin is nearest to it."""
    geometry, best = surface.orbifold.geometry, Points(patch.copy(), x.copy())
    for home in np.unique(patch):
        here = np.flatnonzero(patch == home)
        for other, g in zip(*surface.orbifold.lifts(int(home), 4.0), strict=True):
            moved = geometry.act(geometry.inverse(g), x[here])
            near = geometry.distance(geometry.origin, moved) < geometry.distance(geometry.origin, best.x[here])
            best.patch[here[near]] = other
            best.x[here[near]] = moved[near]
    return best


def draw_surface(plotter: pv.Plotter, column: int, smooth: Polyhedron, lines: tuple[Floats, Floats]) -> None:
    """The surface with the sides of the faces and the lines between them."""
    plotter.subplot(0, column)
    plotter.enable_anti_aliasing("ssaa")
    faces = np.column_stack([np.full(smooth.face_count, 3), smooth.triangles])
    plotter.add_mesh(pv.PolyData(smooth.vertices, faces.ravel()), color="#dfe7ee", smooth_shading=True, specular=0.2)
    for part, color, width in zip(lines, (ORANGE, BLUE), (0.03, 0.018), strict=True):
        joined = np.column_stack([np.full(len(part), LINE), np.arange(part[..., 0].size).reshape(-1, LINE)])
        plotter.add_mesh(pv.PolyData(part.reshape(-1, 3), lines=joined.ravel()).tube(radius=width), color=color)
    centre = (smooth.vertices.min(axis=0) + smooth.vertices.max(axis=0)) / 2
    plotter.camera_position = [centre + np.array([2, -15, 21]), centre, (0, 0, 1)]
    plotter.camera.zoom(1.55)


def make(folder: Path) -> None:
    """Both pictures."""
    matplotlib.use("agg")
    registry = Registry.discover()
    squares = gate.read(DATASETS / "plate_genus2_coarse.off", registry)
    polyhedron = squares.with_vertices(squares.vertices * STRETCH)
    words = {"the map of the mesh": [], "regular faces": ["shape.method=regular-faces"]}
    made = [fit(polyhedron, Config.load(overrides=["basis.size=600", *more]), registry) for more in words.values()]
    figure, axes = plt.subplots(1, 2, figsize=(10, 5.2))
    plotter = pv.Plotter(off_screen=True, shape=(1, 2), window_size=(1400, 360), border=False)
    plotter.set_background("white", all_renderers=True)
    for column, (title, result) in enumerate(zip(words, made, strict=True)):
        draw_disc(axes[column], result.surface, polyhedron, title)
        draw_surface(plotter, column, result.output, parameter_lines(result.surface, polyhedron))
    figure.tight_layout()
    figure.set_dpi(90)
    figure.canvas.draw()
    save(np.asarray(figure.canvas.buffer_rgba())[..., :3], folder / "square_faces_disc.png")
    save(plotter.screenshot(None, return_img=True), folder / "square_faces_space.png")
    plotter.close()


def save(image: NDArray[np.uint8], path: Path) -> None:
    """A picture with a palette, which makes small files of line drawings."""
    Image.fromarray(np.ascontiguousarray(image)).quantize(64).save(path, optimize=True)


if __name__ == "__main__":
    make(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent)
