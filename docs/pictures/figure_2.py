"""Figure 2 of the paper: `python docs/pictures/figure_2.py FILE.svg`.

The hyperboloid model, and the projective model as a unit disc that touches it: lines through the origin join the points
of one to those of the other, and a plane through the origin cuts both in a line.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from orbiframe_drawing.colours import GREY, INK, line_colour, tint
from orbiframe_drawing.file import save_picture
from orbiframe_drawing.models import Solid
from orbiframe_drawing.picture import Curve, Item, Label, Picture, Shape, circle, polyline

from orbiframe import Registry

Floats = NDArray[np.float64]

BLUE, ORANGE = line_colour(1), line_colour(2)
ELEVATION, TOP, UNIT = 0.27, 2.9, 78.0
CORNERS = ((1.4, -0.95), (0.35, -1.57), (1.35, -2.25))


def on_page(curve: Curve) -> Curve:
    """A curve of the model in points."""
    return curve.placed(UNIT, np.zeros(2))


def net(model: Solid, front: bool) -> list[list[Curve]]:
    """Lines through the lowest point of the hyperboloid and circles round it, on the near side or on the far side."""
    geometry, reach = model.geometry, float(np.arccosh(TOP))
    angles = np.arange(24) * np.pi / 12
    eye = np.array([np.cos(model.azimuth), np.sin(model.azimuth)])
    near = (np.stack([np.cos(angles), np.sin(angles)], axis=1) @ eye > -1e-9) == front
    ends = geometry.from_polar(reach, angles[near])
    rays = model.geodesics(np.tile(geometry.origin, (len(ends), 1)), ends)
    t = np.linspace(-np.pi / 2, np.pi / 2, 41) + model.azimuth + (0 if front else np.pi)
    circles = [polyline(model.place(geometry.from_polar(r, t))) for r in reach * np.arange(1, 6) / 5]
    return [*([on_page(ray)] for ray in rays), *([on_page(c) for c in circle_] for circle_ in circles)]


def disc(model: Solid) -> list[Curve]:
    """The unit disc in the plane x0 = 1."""
    t = np.linspace(0, 2 * np.pi, 121)
    return polyline(UNIT * model.place(np.stack([np.ones_like(t), np.cos(t), np.sin(t)], axis=1)))


def picture() -> Picture:
    """The far side, the disc, the near side, and a triangle in both models with the lines through its corners."""
    model = Solid(Registry.discover().load("geometry", "h2")(), elevation=ELEVATION, height=TOP)
    geometry = model.geometry
    corners = np.stack([geometry.from_polar(radius, angle) for radius, angle in CORNERS])
    origin, below = UNIT * model.place(np.zeros(3)), corners / corners[:, :1]
    rim = [on_page(model.level(TOP))]
    flat = polyline(UNIT * model.place(np.concatenate([below, below[:1]])))
    lines = [polyline(UNIT * model.place(np.stack([np.zeros(3), x]))) for x in corners]
    curved = [[on_page(curve) for curve in path] for path in model.paths(corners[None])]
    items: list[Item] = [
        Shape([rim], True, fill=tint(BLUE, 0.10)),
        Shape(net(model, front=False), stroke=tint(BLUE, 0.45), width=0.4),
        Shape([disc(model)], True, tint(ORANGE, 0.22), ORANGE, 1.0),
        Shape([flat], True, tint(ORANGE, 0.75), ORANGE, 1.0),
        Shape(lines, stroke=INK, width=0.6, dash=(3, 2.5)),
        Shape(net(model, front=True), stroke=BLUE, width=0.5),
        Shape(curved, True, tint(BLUE, 0.6), BLUE, 1.4),
        Shape([rim], True, stroke=BLUE, width=1.1),
        Shape([circle(origin, 2.5), circle(UNIT * model.place(geometry.origin), 2.5)], True, fill=INK),
        Label("0", origin + np.array([-11.0, -2.0]), 13),
        Label("X", UNIT * model.place(geometry.from_polar(1.6, np.pi - 0.5)) + np.array([-20.0, 6.0]), 15, BLUE),
        Label("P²", UNIT * model.place(np.array([1.0, -1.0, 0.0])) + np.array([-16.0, -4.0]), 13, ORANGE),
    ]
    axis = polyline(np.stack([origin, UNIT * model.place(np.array([0.9, 0.0, 0.0]))]))
    items.insert(0, Shape([axis], stroke=GREY, width=0.6))
    width = UNIT * np.sqrt(TOP**2 - 1) + 8
    heights = np.concatenate([curve.at(np.linspace(0, 1, 50))[:, 1] for curve in rim])
    return Picture(tuple(items), (-width, float(origin[1]) - 14, width, float(heights.max()) + 8))


if __name__ == "__main__":
    save_picture(picture(), Path(sys.argv[1]))
