"""Where readers and writers decide between plain and compiled loops."""

from __future__ import annotations

from orbiframe_polygons import floats, lines, text, weld

from orbiframe.meshes import polyhedron

SWITCHES = [(floats, "LARGE"), (text, "LARGE"), (lines, "LARGE"), (weld, "LARGE"), (polyhedron, "LARGE")]
