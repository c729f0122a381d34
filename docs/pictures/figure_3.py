"""Figure 3 of the paper: `python docs/pictures/figure_3.py FILE.svg`.

A rotation of H^2 in the conformal model, applied again and again: figures that are all congruent, and angles that are
what they seem; dashed the circles round the fixed point on which their corners run.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from orbiframe_drawing.colours import GREY, INK, line_colour, tint
from orbiframe_drawing.file import save_picture
from orbiframe_drawing.models import Chart
from orbiframe_drawing.page import Page
from orbiframe_drawing.picture import Curve, Item, Label, Picture, Shape, circle

from orbiframe import Registry

Floats = NDArray[np.float64]

TIMES = 9
FLAG = ((0.55, 0.0), (1.75, 0.0), (1.75, 0.32), (1.2, 0.2))


def circle_round(page: Page, centre: Floats, radius: float) -> tuple[Curve, Curve]:
    """A hyperbolic circle: in the conformal model a circle, with another centre."""
    geometry = page.model.geometry
    away = page.place(geometry.act(centre, geometry.from_polar(np.full(3, radius), np.arange(3) * 2.0)))
    rows = 2 * (away[1:] - away[0])
    middle = np.linalg.solve(rows, (away[1:] ** 2 - away[0] ** 2).sum(axis=1))
    return circle(middle, float(np.linalg.norm(away[0] - middle)))


def picture() -> Picture:
    """The images of a figure under the powers of a rotation."""
    page = Page(Chart(Registry.discover().load("geometry", "h2")(), "conformal"), 1.0)
    geometry = page.model.geometry
    centre = geometry.translation(0.75, 2.4)
    flag = geometry.from_polar(*np.array(FLAG).T)
    powers = centre @ geometry.rotation(2 * np.pi * np.arange(TIMES) / TIMES)
    images = np.einsum("kij,mj->kmi", powers, flag)
    items: list[Item] = [
        Shape([circle_round(page, centre, r)], True, stroke=GREY, width=0.6, dash=(3, 2.5)) for r in (0.55, 1.2, 1.75)
    ]
    for k, path in enumerate(page.paths(images)):
        colour = line_colour(2 if k == 0 else 1)
        items.append(Shape([path], True, tint(colour, 0.75 - 0.06 * k), INK, 0.8))
    items.append(Shape([circle(page.place(centre[:, 0]), 3)], True, fill=INK))
    items.append(Label("m", page.place(centre[:, 0]) + np.array([-9.0, 9.0]), 14))
    return page.picture([*items, Shape([page.window], True, stroke=INK, width=1.0)])


if __name__ == "__main__":
    save_picture(picture(), Path(sys.argv[1]))
