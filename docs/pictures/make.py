"""Make the picture of the readme: `python docs/pictures/make.py [FILE]`; needs `pip install .[pictures]`.

Polyhedra above, and below what `orbiframe fit` makes of them: clay, and light strips as they are reflected.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pyvista as pv
from numpy.typing import NDArray
from PIL import Image

from orbiframe import OrbifoldSurface, Polyhedron, fit, read

Floats = NDArray[np.float64]

# Each with the direction from which it is seen, how much larger than its part, and what is said to `fit`.
SHAPES: dict[str, tuple[tuple[float, float, float], float, dict[str, object]]] = {
    "plate_genus3": ((4.0, -8.0, 9.0), 1.2, {}),
    "plate_genus2_coarse": ((4.0, -8.0, 9.0), 1.15, {"data": "smooth"}),
    "three_crosscaps": ((6.0, -7.0, 4.5), 1.5, {"data": "smooth"}),
    "klein_bottle": ((6.0, -8.0, 6.0), 1.6, {}),
}
IN_CLAY = ("plate_genus3", "three_crosscaps")
CLAY = {"specular": 0.35, "specular_power": 25, "diffuse": 0.85, "ambient": 0.14}
EDGES = {"show_edges": True, "line_width": 2, "edge_color": "#34495e", "color": "#c9d6e4"}
TONES, STRIPS, SIZE = ((72, 100, 132), (236, 242, 248)), 7, (460, 340)


def reflected(mesh: pv.PolyData, view: Floats) -> Floats:
    """Where on a wall of strips a ray from the eye comes to after its reflection, (n, 2), from 0 to 1."""
    ray = -view / np.linalg.norm(view)
    normals = mesh.point_data["Normals"]
    away = ray - 2 * (normals @ ray)[:, None] * normals
    across = np.cross(ray, [0.0, 0.0, 1.0])
    along = away @ across / np.linalg.norm(across)
    return np.column_stack([np.arcsin(np.clip(along, -1, 1)) / np.pi + 0.5, np.full(len(away), 0.5)])


def strips() -> pv.Texture:
    """Light and dark strips with soft edges, as many light ones as `STRIPS`."""
    t = (np.arange(4096) + 0.5) / 4096
    light = np.clip(0.5 + 6 * np.sin(2 * np.pi * STRIPS * t), 0, 1)[:, None]
    row = (np.array(TONES[0]) * (1 - light) + np.array(TONES[1]) * light).astype(np.uint8)
    return pv.Texture(np.repeat(row[None], 4, axis=0))


def fine(surface: OrbifoldSurface) -> pv.PolyData:
    """A mesh that is fine enough for strips."""
    density = max(2, round(np.sqrt(300_000 / surface.triangulation.polyhedron.face_count)))
    return surface.tessellate(density, bisected=True).to_pyvista()


def show(
    plotter: pv.Plotter, place: tuple[int, int], mesh: pv.PolyData, view: Floats, zoom: float, **style: object
) -> None:
    """A mesh in its part of the picture."""
    plotter.subplot(*place)
    plotter.enable_anti_aliasing("ssaa")
    plotter.add_mesh(mesh, **CLAY, **style)
    plotter.camera_position = [mesh.center + view, mesh.center, (0, 0, 1)]
    plotter.reset_camera()
    plotter.camera.zoom(zoom)


def polygons(polyhedron: Polyhedron) -> pv.PolyData:
    """A polyhedron as a mesh of pyvista, without normals: facets are to be seen."""
    mesh = polyhedron.to_pyvista()
    mesh.point_data.clear()
    return mesh


def picture() -> NDArray[np.uint8]:
    """The picture as pixels."""
    width, height = SIZE
    window = (width * len(SHAPES), height * 2)
    plotter = pv.Plotter(off_screen=True, shape=(2, len(SHAPES)), window_size=window, border=False)
    plotter.set_background("white", all_renderers=True)
    for column, (name, (direction, zoom, said)) in enumerate(SHAPES.items()):
        view = np.array(direction)
        show(plotter, (0, column), polygons(read(f"dataset:{name}")), view, zoom, **EDGES)
        smooth = fine(fit(f"dataset:{name}", progress=False, **said).surface)
        smooth.active_texture_coordinates = reflected(smooth, view)
        look = {"color": "#c9d6e4"} if name in IN_CLAY else {"texture": strips()}
        show(plotter, (1, column), smooth, view, zoom, smooth_shading=True, **look)
    pixels = plotter.screenshot(None, return_img=True)
    plotter.close()
    return pixels


if __name__ == "__main__":
    target = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).with_name("four_shapes.png")
    Image.fromarray(picture()).quantize(128).save(target, optimize=True)
