"""Fit page: the report of a fit as one page of HTML that needs nothing else, with pictures."""

from __future__ import annotations

import base64
import time
from collections.abc import Iterator, Sequence
from html import escape
from pathlib import Path
from typing import Any

from orbiframe.cli.fit_pictures import FitPictures
from orbiframe.cli.report import json_text, warnings_of, write_report
from orbiframe.files.folder import make_folder
from orbiframe.files.outputs import write_text
from orbiframe.fitting.given_back import rows_of
from orbiframe.fitting.parts import Parts
from orbiframe.fitting.stages import Progress

PAGE, DATA = "index.html", "report.json"
_STYLE = """
:root { color-scheme: light dark; --ink: #20262c; --soft: #5c6670; --line: #d9dee3; --back: #fff; --box: #f5f7f9 }
@media (prefers-color-scheme: dark) {
  :root { --ink: #e4e8ec; --soft: #a3adb8; --line: #3a424a; --back: #16191c; --box: #1f2429 } }
body { font: 15px/1.5 system-ui, sans-serif; margin: 2rem auto; max-width: 70rem; padding: 0 1rem; color: var(--ink);
  background: var(--back) }
h1 { font-size: 1.6rem } h2 { font-size: 1.15rem; margin-top: 2.2rem }
table { border-collapse: collapse; font-size: 13px; font-variant-numeric: tabular-nums }
th, td { padding: .25rem .8rem .25rem 0; border-bottom: 1px solid var(--line); text-align: left; vertical-align: top }
th { font-weight: 600; color: var(--soft); white-space: nowrap }
.figures { display: flex; flex-wrap: wrap; gap: 1rem } figure { margin: 0; max-width: 100% }
figure img, figure svg { max-width: 100%; height: auto; background: #fff; border-radius: 6px; border: 1px solid
  var(--line) } figcaption { font-size: 12.5px; color: var(--soft); max-width: 32rem }
.good, .look { padding: .6rem 1rem; border-left: 4px solid #2a9d78; background: var(--box); border-radius: 4px }
.look { border-color: #d1440c } .scale { height: .6rem; border-radius: 3px; margin: .3rem 0 .1rem }
.ends { display: flex; justify-content: space-between } pre { white-space: pre-wrap; background: var(--box);
  padding: .6rem 1rem; border-radius: 4px; overflow-wrap: anywhere }
"""


def write_page(folder: Path, found: Parts, command: str, progress: Progress) -> None:
    """Make a folder with the page and the same as data; a stage of the progress, as pictures take some seconds."""
    progress("report", None)
    start = time.perf_counter()
    make_folder(folder)
    write_text(folder / PAGE, page(found, command))
    write_report(folder / DATA, {**found.report, "command": command})
    progress("report", time.perf_counter() - start)


def page(found: Parts, command: str) -> str:
    """The page of one surface, or of several, one after the other."""
    sections, count = [], len(found.results)
    for number, result in enumerate(found.results, start=1):
        if count > 1:
            sections.append(f"<h1>Part {number} of {count}</h1>")
        sections += _sections(result.report, FitPictures(result))
    return "\n".join(
        [
            '<!doctype html><html lang="en"><head><meta charset="utf-8">',
            '<meta name="viewport" content="width=device-width, initial-scale=1">',
            f"<title>Report of a fit</title><style>{_STYLE}</style></head><body>",
            "<h1>Report of a fit</h1>",
            _verdict(warnings_of(found.report)),
            f"<table>{''.join(_row(name, text) for name, text in rows_of(found.report) if name != 'note')}</table>",
            *sections,
            *_ending(found.report, command),
            "</body></html>\n",
        ]
    )


def _verdict(warnings: Sequence[str]) -> str:
    if not warnings:
        return '<p class="good">Nothing asks for a look.</p>'
    return f'<div class="look">Look at this:<ul>{"".join(f"<li>{escape(each)}</li>" for each in warnings)}</ul></div>'


def _sections(report: dict[str, Any], pictures: FitPictures) -> Iterator[str]:
    yield "<h2>Input and surface</h2>"
    yield _figures([_image(pictures.input(), "the input"), _image(pictures.surface(), "the smooth surface")])
    yield "<h2>Tessellation</h2>"
    caption = "one lift of every face to X; together they are X/H"
    tiling = f"<figure>{pictures.tiling()}<figcaption>{caption}</figcaption></figure>"
    yield _figures([_image(pictures.tessellation(), "the images of the edges on the surface"), tiling])
    yield "<h2>Error, distortion, curvature</h2>"
    yield _figures([_image(each.png, name, _scale(each.scale)) for name, each in pictures.coloured()])
    yield "<h2>Where the error is largest</h2>"
    yield _figures([_image(png, _place(place)) for place, png in pictures.worst()])
    yield "<h2>Distances</h2>"
    yield _distances(report["distance"])
    yield "<h2>Shape</h2>"
    yield f"<table>{''.join(_row(name, text) for name, text in _shape(report))}</table>"


def _distances(distance: dict[str, Any]) -> str:
    names = ("rms", "mean", "max")
    head = "<tr><th>relative to the diagonal</th>" + "".join(f"<th>{name}</th>" for name in names) + "</tr>"
    rows = [
        _row(key.replace("_", " "), *(f"{distance[key][name]:.3e}" for name in names))
        for key in ("mesh_to_surface", "surface_to_mesh", "vertices_to_surface")
    ]
    rows.append(_row("Hausdorff, the larger of both ways", "", "", f"{distance['hausdorff']:.3e}"))
    rows.append(_row("normals turned, root mean square", f"{distance['normals']:.2f}°"))
    return f"<table>{head}{''.join(rows)}</table>"


def _shape(report: dict[str, Any]) -> Iterator[tuple[str, str]]:
    shape, mapped, bent = report["shape"], report["map"], report["curvature"]
    crossing = shape["self_intersections"]
    yield "self-intersecting triangles", f"{crossing['mesh']} of the input, {crossing['output']} of the output"
    yield "folded over", f"{shape['folded_share']:.1e} of the area"
    if shape["volume_ratio"] is not None:
        yield "volume", f"{shape['volume_ratio']:.5f} of that of the input"
    if bent is not None:
        for name in ("gaussian", "mean"):
            levels = ", ".join(f"{level} {value:.4g}" for level, value in bent[name].items())
            yield f"{'Gaussian' if name == 'gaussian' else 'mean'} curvature", levels
        yield "smallest radius of curvature", f"{bent['radius']:.4g}"
    angle, crowding = mapped["angle_distortion"], mapped["crowding"]
    yield "distortion of angles", f"median {angle['median']:.3f}, p95 {angle['p95']:.3f}, max {angle['max']:.3f}"
    yield "digits lost", f"{crowding['digits_lost']:.1f} of 16"


def _ending(report: dict[str, Any], command: str) -> Iterator[str]:
    yield "<h2>Times</h2><table>"
    yield "".join(_row(stage, f"{seconds:.2f} s") for stage, seconds in report["seconds"].items()) + "</table>"
    yield "<h2>Versions</h2><table>"
    yield "".join(_row(name, text) for name, text in report["versions"].items()) + "</table>"
    yield f"<h2>Once more</h2><pre>{escape(command)}</pre>"
    data = base64.b64encode((json_text({**report, "command": command}) + "\n").encode()).decode()
    yield f'<p><a download="{DATA}" href="data:application/json;base64,{data}">The same as data</a></p>'


def _place(place: dict[str, Any]) -> str:
    where = ", ".join(f"{x:.4g}" for x in place["place"])
    return f"{place['distance']:.2e} of the diagonal, {place['on']} at ({where})"


def _row(*cells: str) -> str:
    first, *others = cells
    return f"<tr><th>{escape(first)}</th>{''.join(f'<td>{escape(cell)}</td>' for cell in others)}</tr>"


def _figures(figures: Sequence[str]) -> str:
    return f'<div class="figures">{"".join(figures)}</div>'


def _image(png: bytes, caption: str, below: str = "") -> str:
    data, words = base64.b64encode(png).decode(), escape(caption)
    return (
        f'<figure><img alt="{words}" src="data:image/png;base64,{data}">{below}'
        f"<figcaption>{words}</figcaption></figure>"
    )


def _scale(scale: Any) -> str:
    return (
        f'<div class="scale" style="background:linear-gradient(to right, {scale.gradient})"></div>'
        f'<figcaption class="ends"><span>{scale.low:.3g}</span><span>{scale.high:.3g}</span></figcaption>'
    )
