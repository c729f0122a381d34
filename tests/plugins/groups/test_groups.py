import pytest
from orbiframe_groups.finite import FiniteGroup
from orbiframe_groups.lattice import lattice_group
from orbiframe_groups.regular_polygon import regular_polygon_group

from orbiframe.testing import Lab, contract_tests, laws_of

GROUP = laws_of("group")

test_regular_polygon = contract_tests("group", regular_polygon_group)
test_square_lattice = contract_tests("group", lattice_group)
test_oblique_lattice = contract_tests("group", lattice_group, params={"first": (1.3, 0.1), "second": (0.4, 0.9)})
test_finite = contract_tests("group", FiniteGroup)


@pytest.mark.parametrize("group", [regular_polygon_group, lattice_group, FiniteGroup])
@pytest.mark.parametrize("law", GROUP.laws, ids=lambda law: law.__name__)
def test_every_law_rejects_its_mutant(law, group, tmp_path):
    with pytest.raises(AssertionError):
        law(GROUP.mutants[law.__name__](group), Lab(tmp_path))
