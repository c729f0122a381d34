"""Every basis keeps its laws on every surface of the datasets where it exists."""

from __future__ import annotations

from pathlib import Path

import pytest
from dataset_laws import FAMILIES, REGISTRY, SURFACES, exists, mapped, verdicts

from orbiframe.errors import GeometryError
from orbiframe.testing.kit import Verdict

pytestmark = pytest.mark.long

PAIRS = [(f, s) for f in FAMILIES for s in SURFACES if exists(f, s)]


@pytest.mark.parametrize(("family", "surface"), PAIRS)
def test_a_basis_keeps_its_laws(family: str, surface: str, tmp_path: Path) -> None:
    assert broken(verdicts(family, surface, tmp_path)) == []


@pytest.mark.parametrize("surface", ["klein_bottle", "plate_genus2"])
@pytest.mark.parametrize(
    ("family", "degree"), [("bernstein", 1), ("dms", 1), ("dms", 4), ("simplex", 1), ("simplex", 3)]
)
def test_a_basis_of_another_degree_keeps_its_laws(family: str, degree: int, surface: str, tmp_path: Path) -> None:
    assert broken(verdicts(family, surface, tmp_path, degree=degree)) == []


def broken(found: list[Verdict]) -> list[str]:
    return [f"{verdict.law}: {verdict.error}" for verdict in found if verdict.error is not None]


def test_products_of_b_splines_exist_on_a_torus_or_klein_bottle_only() -> None:
    triangulation = mapped("three_crosscaps")
    with pytest.raises(GeometryError, match="torus or Klein bottle"):
        REGISTRY.load("basis", "tensor-bspline")(triangulation.orbifold, triangulation, size=60)


FEWEST = {"sphere": 12, "projective_plane": 6, "torus": 1, "klein_bottle": 1, "plate_genus2": 8, "three_crosscaps": 4}


@pytest.mark.parametrize("surface", FEWEST)
@pytest.mark.parametrize("family", ["ps2", "dms", "simplex", "argyris"])
def test_the_smallest_basis_that_a_surface_can_have(family: str, surface: str) -> None:
    """The icosahedron has 12 vertices, and the projective plane half of them."""
    triangulation = mapped(surface)
    basis = REGISTRY.load("basis", family)(triangulation.orbifold, triangulation, size=1)
    assert basis.domain.vertex_count == FEWEST[surface]
