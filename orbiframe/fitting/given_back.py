"""Given back: what a fit returns, as one line, as a page of a notebook, and as meshes of other libraries."""

from __future__ import annotations

import base64
from html import escape
from pathlib import Path
from typing import Any

from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.surfaces.shaded_mesh import VIEW, ShadedPicture, View, shaded_picture

_WIDTH = 360


class GivenBack:
    """What is common to the results of a fit of one surface and of several: a mesh and a report."""

    output: Polyhedron
    report: dict[str, Any]

    def __repr__(self) -> str:
        return f"<{type(self).__name__}: {'; '.join(_line(self.report))}>"

    def _repr_html_(self) -> str:
        """The picture, and the report beside it, for notebooks."""
        image = base64.b64encode(self.picture(width=_WIDTH).png).decode("ascii")
        rows = "".join(f"<tr><th>{escape(a)}</th><td>{escape(b)}</td></tr>" for a, b in rows_of(self.report))
        return (
            f'<div style="display:flex;gap:1em;align-items:center"><img width="{_WIDTH}" alt="the surface" '
            f'src="data:image/png;base64,{image}"><table>{rows}</table></div>'
        )

    def picture(self, path: str | Path | None = None, *, width: int = 480, view: View = VIEW) -> ShadedPicture:
        """A picture of the mesh, written as a PNG file where a path is given; see `shaded_picture`."""
        made = shaded_picture(self.output, width=width, view=view)
        if path is not None:
            made.save(path)
        return made

    def to_trimesh(self) -> Any:
        """The mesh as a trimesh.Trimesh."""
        return self.output.to_trimesh()

    def to_pyvista(self) -> Any:
        """The mesh as a pyvista.PolyData."""
        return self.output.to_pyvista()

    def to_meshio(self) -> Any:
        """The mesh as a meshio.Mesh."""
        return self.output.to_meshio()

    def to_open3d(self) -> Any:
        """The mesh as an open3d.geometry.TriangleMesh."""
        return self.output.to_open3d()


def _line(report: dict[str, Any]) -> list[str]:
    found, output = report["fit"], report["output"]
    parts = report.get("parts", [report])
    name = parts[0]["surface"]["name"] if len(parts) == 1 else f"{len(parts)} surfaces"
    return [
        name,
        f"{found['size']} functions",
        f"rms {found['rms']:.2e}, max {found['max']:.2e} of the diagonal",
        f"{output['vertices']} vertices, {output['faces']} faces",
    ]


def rows_of(report: dict[str, Any]) -> list[tuple[str, str]]:
    """The report of a fit in rows of two texts, its notes last."""
    parts = report.get("parts", [report])
    rows = [row for part in parts for row in _rows(part)]
    if len(parts) > 1:
        rows += [("all", "; ".join(_line(report)[1:]))]
    return rows


def _rows(part: dict[str, Any]) -> list[tuple[str, str]]:
    surface, found, mapped = part["surface"], part["fit"], part["map"]
    distortion, distance = mapped["angle_distortion"], part["distance"]
    return [
        ("surface", f"{surface['name']}, Euler characteristic {surface['euler_characteristic']}"),
        ("geometry", f"{part['geometry']}, group: {part['group']['source']}"),
        ("map", f"{mapped['triangles']} triangles, angle distortion {distortion['median']:.2f} (median)"),
        ("data", f"{part['data']['means']}: {part['data']['reason']}"),
        ("fit", f"{found['size']} functions of {found['basis']}, by {found['fitter']}"),
        ("error", f"rms {found['rms']:.2e}, max {found['max']:.2e} of the diagonal"),
        *(
            (name.replace("_", " "), f"rms {distance[name]['rms']:.2e}")
            for name in ("mesh_to_surface", "surface_to_mesh")
        ),
        ("output", f"{part['output']['vertices']} vertices, {part['output']['faces']} faces"),
        ("seconds", f"{sum(part['seconds'].values()):.1f}"),
        *(("note", note) for note in part["notes"]),
    ]
