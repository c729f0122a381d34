"""The contract of H2; what is special to it stands in tests/kernel/test_geometry.py."""

from orbiframe.testing import contract_tests
from orbiframe_geometries.h2 import H2

test_h2 = contract_tests("geometry", H2)
