"""Notebook: a surface in Jupyter, marimo and VS Code, with a picture where no JavaScript runs."""

from __future__ import annotations

import base64
from html import escape
from typing import Any

from orbiframe import OrbifoldSurface, Polyhedron
from orbiframe.surfaces import ShadedPicture
from orbiframe_viewer.scene import surface_scene
from orbiframe_viewer.static_page import static_page

_FACES, _HEIGHT = 12_000, 520


class Shown:
    """What a notebook shows of a surface: the page of the viewer, or a picture."""

    def __init__(self, surface: OrbifoldSurface, polyhedron: Polyhedron | None = None) -> None:
        self._picture: ShadedPicture = surface.picture()
        self._page = static_page(
            [surface_scene(surface, polyhedron, f"{len(surface.coefficients)} functions", faces=_FACES)],
            self._picture.png,
            "surface",
        )

    def __repr__(self) -> str:
        return "<a surface: shown in Jupyter, marimo and VS Code; `.save('page.html')` writes the page>"

    def _repr_html_(self) -> str:
        """The page in a frame over the picture, which stays where frames are taken out (a notebook not trusted)."""
        image = base64.b64encode(self._picture.png).decode()
        return (
            f'<div style="position:relative;height:{_HEIGHT}px"><img alt="surface" style="max-height:100%" '
            f'src="data:image/png;base64,{image}"><iframe srcdoc="{escape(self._page)}" '
            f'sandbox="allow-scripts allow-downloads" title="surface" '
            f'style="position:absolute;left:0;top:0;width:100%;height:100%;border:0"></iframe></div>'
        )

    def _repr_mimebundle_(self, **_: Any) -> dict[str, Any]:
        """The page, and the picture for who cannot show it."""
        return {"text/html": self._repr_html_(), "image/png": self._picture.png, "text/plain": repr(self)}

    def save(self, path: str) -> None:
        """Write the page as one file of HTML."""
        from pathlib import Path

        from orbiframe.files import write_text

        write_text(Path(path), self._page)
