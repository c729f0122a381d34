"""The laws of exporters, tried on the JSON of Bezier patches, and that the surface is in the file."""

import json

import numpy as np
from orbiframe_example_bezier.exporter import export

from orbiframe.testing import Lab, contract_tests

test_bezier = contract_tests("exporter", export, suffix=".bezier")


def test_corners_of_the_patches_lie_on_the_surface(tmp_path):
    """The control points at the corners of a Bezier triangle are points of the surface."""
    surface = Lab(tmp_path).surfaces["tetrahedron"]
    export(tmp_path / "surface.bezier", surface)
    points = np.array(json.loads((tmp_path / "surface.bezier").read_text())["points"])
    assert (surface.distance(points[:50, 0]) < 1e-9).all()
