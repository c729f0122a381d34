"""Pictures of one fit: the input, the surface, its colours, the places of the largest errors, and X/H."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from orbiframe.fitting.pipeline import Result
from orbiframe.meshes.submesh import submesh
from orbiframe.orbifolds.atlas import Points
from orbiframe.surfaces.colour_scale import ColourScale
from orbiframe.surfaces.curved_edges import edge_curves
from orbiframe.surfaces.shaded_mesh import VIEW, shaded_picture
from orbiframe.surfaces.surface import Tessellation
from orbiframe.surfaces.values_to_show import ShownValues, shown_values
from orbiframe.triangulations.tessellation import Tessellation as Tiling, geodesic_sides

Floats = NDArray[np.float64]

_FACES, _CLOSE_FACES = 40_000, 160_000
_WIDTH, _CLOSE_WIDTH = 520, 300
_CLOSE = 0.12  # radius of what is seen round a place, in diagonals
_MOST_LINES = 6000  # more edges are no picture
_PAGE = 420


class Coloured(NamedTuple):
    """A picture whose colours are numbers, and their scale."""

    png: bytes
    scale: ColourScale


class FitPictures:
    """The pictures of one result."""

    def __init__(self, result: Result) -> None:
        self._surface, self._polyhedron, self._report = result.surface, result.input, result.report

    @cached_property
    def _shown(self) -> Tessellation:
        return self._fine(_FACES)

    @cached_property
    def _values(self) -> ShownValues:
        return shown_values(self._surface, self._shown)

    def input(self) -> bytes:
        """The input with its edges."""
        lines = self._edges_of_input if self._polyhedron.edge_count <= _MOST_LINES else []
        return shaded_picture(self._polyhedron.with_vertices(self._polyhedron.vertices), width=_WIDTH, lines=lines).png

    def surface(self) -> bytes:
        """The smooth surface."""
        return shaded_picture(self._shown.mesh, width=_WIDTH).png

    def tessellation(self) -> bytes:
        """The smooth surface with the images of the edges of the input."""
        lines = list(edge_curves(self._surface, self._polyhedron))
        return shaded_picture(self._shown.mesh, width=_WIDTH, lines=lines).png

    def coloured(self) -> Iterator[tuple[str, Coloured]]:
        """Error, distortion and curvature, each with its scale."""
        values = self._values
        yield "distance to the input, in diagonals", self._with(values.error, ColourScale.rising(values.error, 0.0))
        distortion = values.distortion
        yield "distortion of angles by the map, 1 is none", self._with(distortion, ColourScale.rising(distortion, 1.0))
        if values.gaussian is not None and values.mean is not None:
            yield "Gaussian curvature", self._with(values.gaussian, ColourScale.diverging(values.gaussian))
            yield "mean curvature", self._with(values.mean, ColourScale.diverging(values.mean))

    def _with(self, values: Floats, scale: ColourScale) -> Coloured:
        return Coloured(shaded_picture(self._shown.mesh, width=_WIDTH, colours=scale.colours(values)).png, scale)

    def worst(self) -> Iterator[tuple[dict[str, Any], bytes]]:
        """The places of the largest errors, with the surface near by and the edges of the input."""
        fine = self._fine(_CLOSE_FACES)
        scale = ColourScale.rising(self._values.error, 0.0)
        for place in self._report["distance"]["worst"]:
            yield place, self._near(fine, np.array(place["place"]), scale)

    def _near(self, fine: Tessellation, place: Floats, scale: ColourScale) -> bytes:
        """What lies near a place, seen along the normal there, coloured by the error."""
        radius = _CLOSE * self._surface.scale
        away = np.linalg.norm(fine.mesh.vertices - place, axis=1)
        part, points = submesh(
            fine.mesh, (away < max(radius, 1.2 * float(away.min())))[fine.mesh.triangles].any(axis=1)
        )
        unit = Tessellation(part, Points(fine.points.patch[points], fine.points.x[points]))
        colours = scale.colours(shown_values(self._surface, unit).error)
        normals = part.normals
        view = VIEW if normals is None else tuple(normals[np.argmin(away[points])] + 0.25 * np.array(VIEW))
        near = [line for line in self._edges_of_input if np.linalg.norm(line - place, axis=1).min() < radius]
        return shaded_picture(part, width=_CLOSE_WIDTH, view=view, colours=colours, lines=near).png

    @cached_property
    def _edges_of_input(self) -> list[Floats]:
        p = self._polyhedron
        ends = np.stack([p.tail[p.representative], p.head[p.representative]], axis=1)
        share = np.linspace(0, 1, 9)[None, :, None]
        return list(p.vertices[ends[:, :1]] * (1 - share) + p.vertices[ends[:, 1:]] * share)

    def _fine(self, faces: int) -> Tessellation:
        own = self._surface.triangulation.polyhedron.face_count
        return self._surface.tessellation(max(1, round(math.sqrt(faces / own))), bisected=True)

    def tiling(self) -> str:
        """One lift of every face of the input to X, as SVG: in the disc, in the plane, or on the near half sphere."""
        tiling = Tiling.of_map(self._polyhedron, self._surface.refinement, self._surface.triangulation)
        geometry, lines = tiling.geometry, []
        for corners in tiling.homes():
            x = geodesic_sides(geometry, corners, 6)
            seen = x[:, :, 0].min(axis=1) > 0 if geometry.curvature > 0 else slice(None)
            lines.append(x[seen][..., 1:] if geometry.curvature > 0 else geometry.to_chart("conformal", x[seen]))
        return _svg(np.concatenate(lines), rim=geometry.curvature != 0)


def _svg(lines: Floats, *, rim: bool) -> str:
    reach = 1.0 if rim else float(np.abs(lines).max())
    at = np.unique(np.round(lines * [1, -1] * (_PAGE / 2 / reach), 1), axis=0)
    path = "".join("M" + "L".join(f"{x:g} {y:g}" for x, y in line) for line in at)
    half = _PAGE / 2 + 4
    circle = f'<circle r="{_PAGE / 2}" fill="none" stroke="#8a8f94"/>' if rim else ""
    return (
        f'<svg role="img" aria-label="the tessellation of X/H" viewBox="{-half:g} {-half:g} {2 * half:g} {2 * half:g}" '
        f'width="{_PAGE}">{circle}<path d="{path}" fill="none" stroke="#0072b2" stroke-width="0.7"/></svg>'
    )
