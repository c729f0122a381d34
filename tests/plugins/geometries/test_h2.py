"""The contract of H2; what is special to it stands in tests/planes/test_geometry.py."""

from orbiframe_geometries.h2 import H2

from orbiframe.testing import contract_tests

test_h2 = contract_tests("geometry", H2)
