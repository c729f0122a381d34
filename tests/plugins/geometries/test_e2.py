"""The contract of E2; what is special to it stands in tests/planes/test_geometry.py."""

from orbiframe_geometries.e2 import E2

from orbiframe.testing import contract_tests

test_e2 = contract_tests("geometry", E2)
