"""The laws of bases, tried on the hats."""

from orbiframe_example_hats.basis import Hats

from orbiframe.testing import contract_tests

test_hats = contract_tests("basis", Hats, params={"size": 40})
