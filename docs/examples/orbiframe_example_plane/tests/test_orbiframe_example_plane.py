"""The laws of geometries and groups, tried on the complex plane and the rhombus."""

from orbiframe_example_plane.geometry import ComplexPlane
from orbiframe_example_plane.group import rhombus

from orbiframe.testing import contract_tests

test_complex_plane = contract_tests("geometry", ComplexPlane)
test_rhombus = contract_tests("group", rhombus)
test_square = contract_tests("group", rhombus, params={"angle": 90.0})
