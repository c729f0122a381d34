"""Figure 1 of the paper: `python docs/pictures/figure_1.py FILE.svg`.

The projective model of H^2: (a) a point p, a line l and lines through p that do not meet l, dashed the two that meet it
on the ideal circle; (b) a reflection in a line, which joins points to their images by lines at right angles to it.
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
from orbiframe_drawing.picture import Curve, Item, Label, Picture, Shape, beside, circle

from orbiframe import Registry

Floats = NDArray[np.float64]

BLUE, ORANGE = line_colour(1), line_colour(2)
P, CHORD = np.array([-0.12, 0.22]), np.array([(-0.92, -np.sqrt(1 - 0.92**2)), (0.75, -np.sqrt(1 - 0.75**2))])
FLAG = np.array([(-0.62, -0.28), (-0.1, -0.05), (-0.22, 0.5), (-0.36, 0.2)])


def parallels(page: Page) -> Picture:
    """Lines through a point that do not meet a line."""
    ends = sorted(float(np.arctan2(*(end - P)[::-1])) for end in CHORD)
    angles = np.linspace(ends[1] - np.pi, ends[0], 9)
    items: list[Item] = [Shape([[chord(page, P, a)]], stroke=BLUE, width=0.8) for a in angles[1:-1]]
    items += [Shape([[chord(page, P, a)]], stroke=BLUE, width=0.8, dash=(4, 3)) for a in angles[[0, -1]]]
    items.append(Shape([[Curve(CHORD * page.scale)]], stroke=ORANGE, width=1.8))
    items.append(Shape([circle(P * page.scale, 3)], True, fill=INK))
    items += [
        Label("p", P * page.scale + np.array([-2.0, 14.0]), 14),
        Label("l", np.array([0.0, -0.62]) * page.scale, 14, ORANGE),
    ]
    return page.picture([*items, Shape([page.window], True, stroke=INK, width=1.0)])


def chord(page: Page, through: Floats, angle: float) -> Curve:
    """The line through a point of the unit disc in a direction."""
    ahead = np.array([np.cos(angle), np.sin(angle)])
    along, rest = float(through @ ahead), float(1 - through @ through)
    half = np.sqrt(along**2 + rest)
    return Curve(np.stack([through + (s * half - along) * ahead for s in (-1, 1)]) * page.scale)


def reflection(page: Page) -> Picture:
    """A figure, its mirror image, and the lines that join their corners."""
    geometry = page.model.geometry
    middle = geometry.translation(0.25, 0.35)
    mirror = middle @ geometry.reflection(0.35 + np.pi / 2) @ geometry.inverse(middle)
    flag = geometry.from_chart("projective", FLAG)
    image = geometry.act(mirror, flag)
    items: list[Item] = [
        Shape(page.paths(np.stack([flag, image], axis=1), False), stroke=GREY, width=0.6, dash=(3, 2.5))
    ]
    for corners, colour in ((flag, BLUE), (image, ORANGE)):
        items.append(Shape(page.paths(corners[None]), True, tint(colour, 0.35), colour, 1.2))
    foot = page.place(middle[:, 0]) / page.scale
    items.append(Shape([[chord(page, foot, mirror_direction(page, middle))]], stroke=INK, width=1.8))
    for text, corners in (("x", flag), ("κ(x)", image)):
        items.append(Label(text, page.place(corners[2]) + np.array([0.0, 11.0]), 13))
    return page.picture([*items, Shape([page.window], True, stroke=INK, width=1.0)])


def mirror_direction(page: Page, middle: Floats) -> float:
    """The direction in the picture of the mirror, which passes through the image of the origin."""
    ahead = page.place(middle @ page.model.geometry.from_polar(0.1, 0.35 + np.pi / 2)) - page.place(middle[:, 0])
    return float(np.arctan2(ahead[1], ahead[0]))


def picture() -> Picture:
    """Both parts."""
    page = Page(Chart(Registry.discover().load("geometry", "h2")(), "projective"), 1.0, 300.0)
    return beside([parallels(page), reflection(page)])


if __name__ == "__main__":
    save_picture(picture(), Path(sys.argv[1]))
