"""Make the picture of texture coordinates: `python docs/pictures/textures.py [FOLDER]`; needs `.[pictures]`.

Above, surfaces with a chequered texture; below, how they lie in the unit square.
"""

from __future__ import annotations

import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
import numpy as np
import pyvista as pv
from matplotlib.collections import PolyCollection
from PIL import Image

from orbiframe import Polyhedron, fit

SHAPES = ("sphere", "torus", "plate_genus2")
BLUE = "#1d4e89"
VIEW = [(5, -9, 11), (0, 0, 0), (0, 0, 1)]


def texture(size: int = 768, squares: int = 24) -> pv.Texture:
    """Chequers whose colours tell where in the square they are."""
    row, column = np.indices((size, size)) * squares // size
    light = ((row + column) % 2)[..., None] == 1
    where = np.stack([60 + 7 * column, 200 - 5 * row, np.full_like(row, 150)], axis=-1)
    return pv.numpy_to_texture(np.where(light, 238, where).astype(np.uint8))


def shown(mesh: Polyhedron) -> np.ndarray:
    """A picture of the mesh with its texture."""
    separate = pv.make_tri_mesh(mesh.vertices[mesh.tail], np.arange(len(mesh.tail)).reshape(-1, 3))
    separate.active_texture_coordinates = mesh.corner_uv
    separate.point_data["Normals"] = mesh.normals[mesh.tail]
    separate.point_data.active_normals_name = "Normals"
    plotter = pv.Plotter(off_screen=True, window_size=(640, 560))
    plotter.set_background("white")
    plotter.enable_anti_aliasing("ssaa")
    plotter.add_mesh(separate, texture=texture(), smooth_shading=True, ambient=0.2)
    plotter.camera_position = VIEW
    plotter.reset_camera()
    plotter.camera.zoom(1.15)
    picture = plotter.screenshot(return_img=True)
    plotter.close()
    return picture


def main(folder: Path) -> None:
    """Write textures.png."""
    figure, axes = plt.subplots(2, len(SHAPES), figsize=(12, 7.6), dpi=90, height_ratios=(1, 1.05))
    for column, name in enumerate(SHAPES):
        mesh = fit(f"dataset:{name}", size=400, output={"uv": True}, progress=False).output
        axes[0, column].imshow(shown(mesh))
        coarse = mesh.corner_uv.reshape(-1, 3, 2)
        lines = PolyCollection(list(coarse), facecolors="#eef2f6", edgecolors=BLUE, linewidths=0.12)
        axes[1, column].add_collection(lines)
        axes[1, column].set(xlim=(-0.06, 1.06), ylim=(-0.06, 1.06), aspect="equal")
        for each in axes[:, column]:
            each.set_axis_off()
    figure.subplots_adjust(0, 0, 1, 1, 0.02, 0.02)
    figure.canvas.draw()
    drawn = Image.fromarray(np.asarray(figure.canvas.buffer_rgba())[..., :3])
    drawn.quantize(128).save(folder / "textures.png", optimize=True)


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent)
