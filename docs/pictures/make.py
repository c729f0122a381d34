"""Make the pictures of the documentation: `python docs/pictures/make.py [FOLDER]`; needs `pip install .[pictures]`."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pyvista as pv

from orbiframe import Config, Polyhedron, Registry, fit
from orbiframe.files import gate

DATASETS = Path(__file__).parents[2] / "datasets"
VIEW = [(5, -9, 11), (0, 0, 0), (0, 0, 1)]
CLAY = {"color": "#c9d6e4", "specular": 0.35, "specular_power": 25, "diffuse": 0.85, "ambient": 0.12}
EDGES = {"show_edges": True, "line_width": 2, "edge_color": "#34495e"}


def before_and_after(name: str, sizes: Sequence[int], target: Path) -> None:
    """The input polyhedron beside its smooth surfaces of so many functions."""
    registry = Registry.discover()
    polyhedron = gate.read(DATASETS / name, registry)
    plotter = pv.Plotter(off_screen=True, shape=(1, 1 + len(sizes)), window_size=(1500, 420), border=False)
    plotter.set_background("white", all_renderers=True)
    _show(plotter, 0, polyhedron, **EDGES)
    for column, size in enumerate(sizes, start=1):
        smooth = fit(polyhedron, Config.load(overrides=[f"basis.size={size}"]), registry).output
        _show(plotter, column, smooth, smooth_shading=True)
    plotter.screenshot(target, transparent_background=False)
    plotter.close()


def _show(plotter: pv.Plotter, column: int, polyhedron: Polyhedron, **style: object) -> None:
    plotter.subplot(0, column)
    plotter.enable_anti_aliasing("ssaa")
    plotter.add_mesh(_polygons(polyhedron), **CLAY, **style)
    plotter.camera_position = VIEW
    plotter.camera.zoom(1.25)


def _polygons(polyhedron: Polyhedron) -> pv.PolyData:
    """A polyhedron as a mesh of pyvista, about the centre of its box."""
    low, high = polyhedron.vertices.min(axis=0), polyhedron.vertices.max(axis=0)
    faces = np.split(polyhedron.tail, polyhedron.offsets[1:-1])
    return pv.PolyData(polyhedron.vertices - (low + high) / 2, np.concatenate([[len(face), *face] for face in faces]))


if __name__ == "__main__":
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent
    before_and_after("plate_genus2.off", (200, 1000), folder / "plate_genus2.png")
