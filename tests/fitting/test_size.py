"""How many functions a shape is given."""

from __future__ import annotations

from types import SimpleNamespace

from orbiframe.fitting.size import default_size, size_needed


def test_a_plain_shape_gets_a_thousand() -> None:
    assert default_size(8, 288, 0) == 1000


def test_thin_parts_handles_and_fine_meshes_get_more() -> None:
    assert default_size(800, 288, 2) == 2000
    assert default_size(8, 288, 2 - 2 * 500) == 6000
    assert default_size(8, 3000, 0) == 1500
    assert default_size(8, 10**6, 0) == 2000


def test_splines_need_sites() -> None:
    splines = SimpleNamespace(size=1000, domain=SimpleNamespace(vertex_count=77))
    assert size_needed(splines, 562) == round(1000 * 562 * 2 / 3 / 77)
    assert size_needed(SimpleNamespace(size=1000), 562) < 1000
