"""The report of a fit: as a file of JSON, and as a few lines to read."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

WORTH_A_WARNING = 13.0  # up to there the error of a fit does not depend on crowding


def write_report(path: Path, report: Mapping[str, Any]) -> None:
    """Write a report as JSON; the file appears complete or not at all."""
    from orbiframe.files.outputs import write_text

    write_text(path, json_text(report) + "\n")


def json_text(report: Mapping[str, Any]) -> str:
    """A report as JSON; numbers that are not finite become null, which JSON has."""
    return json.dumps(plain(report), indent=2, allow_nan=False)


def summary(report: Mapping[str, Any], *, written: str | None = None) -> str:
    """A report in a few lines; written: what was written, in words, where that is no mesh of flat faces."""
    lines = _lines_of_parts(report, written) if "parts" in report else _lines(report, written)
    return "\n".join(f"{name:<10}{words}" for name, words in lines)


def warnings_of(report: Mapping[str, Any]) -> list[str]:
    """Sentences for what a user should look at: the notes of all parts, and where digits are lost."""
    parts = report.get("parts", [report])
    return [text for part in parts for text in (*_crowding(part["map"]["crowding"]), *part["notes"])]


def _lines_of_parts(report: Mapping[str, Any], written: str | None) -> Iterator[tuple[str, str]]:
    """The lines of every part, without its output, and those of all together."""
    parts, fit = report["parts"], report["fit"]
    for number, part in enumerate(parts, start=1):
        yield "part", f"{number} of {len(parts)}"
        yield from (line for line in _lines(part, None) if line[0] not in ("output", "seconds"))
    yield "together", f"{len(parts)} parts, {fit['size']} functions, {fit['samples']} samples"
    yield "error", f"rms {fit['rms']:.2e}, max {fit['max']:.2e} of the diagonal of the box of all parts"
    yield from _ending(report, written)


def _lines(report: Mapping[str, Any], written: str | None) -> Iterator[tuple[str, str]]:
    surface, group, mapped, fit = (report[key] for key in ("surface", "group", "map", "fit"))
    yield "surface", f"{surface['name']} (Euler characteristic {surface['euler_characteristic']})"
    cut = report["triangles"]
    if cut["diagonals"]:
        faces = _counted(cut["faces_cut"], "face", "faces")
        points = f", {_counted(cut['points'], 'of them with a point', 'of them with points')}" if cut["points"] else ""
        yield "triangles", f"{_counted(cut['diagonals'], 'diagonal', 'diagonals')} in {faces}{points}: {cut['rule']}"
    yield "geometry", str(report["geometry"])
    patches = _counted(group["patches"], "patch", "patches")
    yield "group", f"{group['source']}, {patches}, relation defect {group['relation_defect']:.1e}"
    angle = mapped["angle_distortion"]
    yield (
        "map",
        f"{mapped['triangles']} triangles, {mapped['not_positive']} not positive; angle distortion "
        f"median {angle['median']:.2f}, p95 {angle['p95']:.2f}, max {angle['max']:.2f}"
        + (f"; taken over from {mapped['like']['file']}" if mapped.get("like") else ""),
    )
    yield from (("warning", words) for words in _crowding(mapped["crowding"]))
    faces = report["faces"]
    if faces["corners"] > 3:
        yield "faces", _shapes(faces) + (f" (before: {_shapes(faces['before'])})" if faces["before"] else "")
    yield "data", f"{report['data']['means']}: {report['data']['reason']}"
    yield "fit", f"{fit['basis']}, {fit['size']} functions, {fit['samples']} samples, {fit['fitter']}"
    yield "error", f"rms {fit['rms']:.2e}, max {fit['max']:.2e} of the bounding-box diagonal"
    yield from _boundary(report.get("boundary"))
    yield from _distances(report["distance"])
    yield from _creases(report.get("creases"))
    yield from _texture(report.get("uv"))
    yield from (("warning", note) for note in report["notes"])
    yield from _ending(report, written)


def _ending(report: Mapping[str, Any], written: str | None) -> Iterator[tuple[str, str]]:
    """What was written, and the time of each stage."""
    out = report["output"]
    mesh = f"{out['vertices']} vertices, {out['faces']} faces"
    yield "output", mesh if written is None else written
    stages = ", ".join(f"{stage} {seconds:.1f}" for stage, seconds in report["seconds"].items())
    yield "seconds", f"{sum(report['seconds'].values()):.1f} ({stages})"


def _boundary(boundary: Mapping[str, Any] | None) -> Iterator[tuple[str, str]]:
    """The boundary, if there is one: how the mesh was closed for the map, and how near the surface's own is."""
    if boundary is not None:
        element = boundary["least_element"]
        least = "" if element is None else f"; least element {element:.2f}"
        yield (
            "boundary",
            f"{_counted(boundary['loops'], 'loop', 'loops')}, mapped as {boundary['closed_to']} by "
            f"{boundary['closed_by']}; rms {boundary['rms']:.2e}, max {boundary['max']:.2e}{least}",
        )


def _distances(distance: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Distances both ways and at the vertices, with the place where the mesh is missed most."""
    parts = {"mesh_to_surface": "to the surface", "surface_to_mesh": "back", "vertices_to_surface": "vertices"}
    words = (f"{name} {distance[key]['rms']:.2e} (max {distance[key]['max']:.2e})" for key, name in parts.items())
    place = ", ".join(f"{x:.4g}" for x in distance["mesh_to_surface"]["place"])
    yield "distance", f"{', '.join(words)}; farthest at ({place})"


def _creases(creases: Mapping[str, Any] | None) -> Iterator[tuple[str, str]]:
    """The creases that were kept, if any, and how well."""
    if creases is not None:
        curves, corners = (
            _counted(creases["curves"], "curve", "curves"),
            _counted(creases["corners"], "corner", "corners"),
        )
        ends, (kink, worst) = _counted(creases["ends"], "end", "ends"), creases["kinks"]
        yield (
            "creases",
            f"{curves} {_kind(creases['angle_from'])}, {corners}, {ends}; within {creases['distance']:.1e}, "
            f"angles off by {creases['angle']:.2g}°, kinks beside them {kink:.2g}° (max {worst:.2g}°)",
        )


def _kind(creases: float | str) -> str:
    """Which edges are creases: from an angle on, or marked ones."""
    return "marked" if isinstance(creases, str) else f"of {creases:g}° or more"


def _texture(uv: Mapping[str, Any] | None) -> Iterator[tuple[str, str]]:
    """How texture coordinates distort the mesh, if it has some."""
    if uv is not None:
        angle, area = uv["angle_distortion"], uv["area_distortion"]
        folds = f", {_counted(uv['folded'], 'fold', 'folds')}" if uv["folded"] else ""
        yield (
            "uv",
            f"cut open along {_counted(uv['cut'], 'edge', 'edges')}; angle distortion median {angle['median']:.2f}, "
            f"p95 {angle['p95']:.2f}, areas {area['p5']:.2g} to {area['p95']:.2g} of the mean (p5, p95){folds}",
        )


def _crowding(crowding: Mapping[str, float]) -> Iterator[str]:
    """A warning where long thin parts of the mesh have cost digits; the digits of a fine mesh are not worth a line."""
    if crowding["digits_lost"] >= WORTH_A_WARNING:
        yield (
            f"crowding: long thin parts get little of X/H (smallest triangle {crowding['area_ratio']:.0e} of the "
            f"largest); {crowding['digits_lost']:.0f} of 16 digits are lost there"
        )


def _shapes(faces: Mapping[str, Any]) -> str:
    """Median and largest deviation of the faces from regular polygons."""
    angle, sides = faces["angle"], faces["adjacent"]
    return (
        f"angles off by {angle['median']:.1f}° (max {angle['max']:.1f}°), "
        f"sides 1 : {sides['median']:.2f} (max {sides['max']:.2f})"
    )


def _counted(count: int, one: str, many: str) -> str:
    return f"{count} {one if count == 1 else many}"


def plain(value: Any) -> Any:
    """Data that JSON can hold: numbers that are not finite become None."""
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
