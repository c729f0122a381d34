"""The contract of S2; what is special to it stands in tests/planes/test_geometry.py."""

from orbiframe_geometries.s2 import S2

from orbiframe.testing import contract_tests

test_s2 = contract_tests("geometry", S2)
