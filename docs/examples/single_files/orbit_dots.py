"""Orbit dots: the images of the origin under a group, as a picture."""

from __future__ import annotations

from pathlib import Path

from orbiframe import Group
from orbiframe.files import write_text
from orbiframe.plugin import Component, hookimpl


@hookimpl
def orbiframe_components() -> list[Component]:
    """The picture of this file."""
    return [
        Component("picture", "orbit-dots", "orbit_dots:draw", "the images of the origin as dots", suffixes=(".svg",))
    ]


def draw(path: Path, group: Group, *, radius: float = 3.0) -> None:
    """A dot for every tile that meets a disc, in the conformal model.

    radius: of the disc.
    """
    places = group.geometry.to_chart("conformal", group.tiles(radius)[:, :, 0])
    reach = abs(places).max() + 0.1
    dots = "".join(f'<circle cx="{x:.6f}" cy="{-y:.6f}" r="0.01"/>' for x, y in places)
    box = f"{-reach:.6f} {-reach:.6f} {2 * reach:.6f} {2 * reach:.6f}"
    write_text(path, f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="{box}">{dots}</svg>\n')
