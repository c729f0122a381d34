"""The laws of bases and fitters hold for ours, and each rejects its mutant."""

from __future__ import annotations

from functools import cached_property, partial
from pathlib import Path

import pytest
import reference_surfaces as surfaces
from orbiframe_bases.gaussian import Gaussian
from orbiframe_fitters.least_squares import LeastSquares

from orbiframe.testing import Lab, basis_laws, fitter_laws
from orbiframe.triangulations.triangulation import Triangulation


class SurfaceLab(Lab):
    """A lab with two surfaces in closed form, the second in two frames."""

    @cached_property
    def triangulations(self) -> dict[str, Triangulation]:
        octagon = surfaces.in_two_frames(surfaces.triangulated("octagon", 2))
        return {"klein bottle": surfaces.triangulated("klein_bottle"), "octagon": octagon}


COMPONENTS = {
    basis_laws: partial(Gaussian, size=40),
    fitter_laws: LeastSquares,
}
CASES = [pytest.param(laws, law, id=law.__name__) for laws in COMPONENTS for law in laws.LAWS]


@pytest.mark.parametrize(("laws", "law"), CASES)
def test_law_holds(laws, law, tmp_path: Path) -> None:
    law(COMPONENTS[laws], SurfaceLab(tmp_path))


@pytest.mark.parametrize(("laws", "law"), CASES)
def test_law_rejects_its_mutant(laws, law, tmp_path: Path) -> None:
    mutant = laws.MUTANTS[law.__name__](COMPONENTS[laws])
    with pytest.raises(AssertionError):
        law(mutant, SurfaceLab(tmp_path))


@pytest.mark.parametrize("laws", COMPONENTS)
def test_every_law_has_a_mutant_and_a_statement(laws) -> None:
    assert set(laws.MUTANTS) == {law.__name__ for law in laws.LAWS}
    assert all(law.__doc__ for law in laws.LAWS)
