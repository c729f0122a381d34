import pytest
from orbiframe_geometries.e2 import E2
from orbiframe_geometries.h2 import H2
from orbiframe_geometries.s2 import S2

from orbiframe.testing import Lab, laws_of

GEOMETRY = laws_of("geometry")


@pytest.mark.parametrize("geometry", [S2, E2, H2])
@pytest.mark.parametrize("law", GEOMETRY.laws, ids=lambda law: law.__name__)
def test_every_law_rejects_its_mutant(law, geometry, tmp_path):
    with pytest.raises(AssertionError):
        law(GEOMETRY.mutants[law.__name__](geometry), Lab(tmp_path))
