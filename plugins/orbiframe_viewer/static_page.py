"""Static page: the viewer as one file of HTML with its data, which needs no server and nothing from outside."""

from __future__ import annotations

import base64
import json
from collections.abc import Sequence
from html import escape
from importlib.resources import files

from orbiframe_viewer.scene import Scene


def part(name: str) -> str:
    """A file of the page."""
    return (files("orbiframe_viewer") / "page" / name).read_text(encoding="utf-8")


def static_page(scenes: Sequence[Scene], png: bytes, title: str) -> str:
    """The whole page; png: the picture that is shown where no JavaScript runs."""
    data = json.dumps(list(scenes)).replace("</", "<\\/")
    image = f'<img alt="{escape(title)}" src="data:image/png;base64,{base64.b64encode(png).decode()}">'
    page = part("index.html").replace("<!--picture-->", image).replace("<title>", f"<title>{escape(title)} – ")
    page = page.replace('<link rel="stylesheet" href="viewer.css">', f"<style>{part('viewer.css')}</style>")
    page = page.replace('<script src="viewer.js">', f'<script>window.SCENES={data}</script><script src="viewer.js">')
    for name in ("three.min.js", "panes.js", "viewer.js"):
        page = page.replace(f'<script src="{name}"></script>', f"<script>{part(name)}</script>")
    return page
