"""The contract kit: the laws that every component of a kind obeys, and things to try them on.

A plugin's whole test file may read

    from orbiframe.testing import contract_tests

    test_wavelet = contract_tests("basis", Wavelet, params={"scale": 0.4})
"""

from orbiframe.testing.kit import Laws, Verdict, contract_tests, laws_of
from orbiframe.testing.lab import Lab, Untried

__all__ = ["Lab", "Laws", "Untried", "Verdict", "contract_tests", "laws_of"]
