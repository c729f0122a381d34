"""Make the picture of open meshes: `python docs/pictures/open_meshes.py [FOLDER]`; needs `pip install .[pictures]`."""

from __future__ import annotations

import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parents[1] / "benchmarks"))
from open_shapes import mask, moebius_band, square_sheet  # noqa: E402

from orbiframe import fit  # noqa: E402

SHOWN = (
    ("mask, four loops", mask, (0.5, -0.6, 1.0)),
    ("sheet, four corners", square_sheet, (0.6, -1.0, 1.2)),
    ("Möbius band", moebius_band, (0.3, -0.8, 0.8)),
)


def main(folder: Path) -> None:
    """Write open_meshes.png: meshes above, surfaces below."""
    figure, axes = plt.subplots(2, 3, figsize=(10, 6), dpi=90)
    for (title, make, view), (above, below) in zip(SHOWN, axes.T, strict=True):
        mesh = make()
        _draw_mesh(above, mesh, np.array(view))
        made = fit(mesh, size=800, boundary="auto", progress=False).surface.picture(width=500, view=view)
        path = folder / "part.png"
        made.save(path)
        below.imshow(plt.imread(path))
        path.unlink()
        above.set_title(title)
        for axis in (above, below):
            axis.axis("off")
    figure.tight_layout()
    figure.savefig(folder / "open_meshes.png")


def _draw_mesh(axis, mesh, view) -> None:
    """The edges of a mesh, seen from the same side."""
    ahead = view / np.linalg.norm(view)
    right = np.cross([0.0, 0.0, 1.0], ahead)
    right /= np.linalg.norm(right)
    flat = mesh.vertices @ np.stack([right, np.cross(ahead, right)], axis=1)
    ends = np.stack([flat[mesh.tail], flat[mesh.head]], axis=1)
    for part, colour, width in ((mesh.twin >= 0, "0.6", 0.4), (mesh.twin < 0, "tab:red", 1.2)):
        lines = matplotlib.collections.LineCollection(ends[part], colors=colour, linewidths=width)
        axis.add_collection(lines)
    axis.set_aspect("equal")
    axis.autoscale()


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else HERE)
