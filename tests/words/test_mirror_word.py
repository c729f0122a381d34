"""Words with mirrors: letters that occur once."""

from __future__ import annotations

import pytest

from orbiframe.words.mirror_word import MirrorWord, Relations


@pytest.mark.parametrize("text", ["ABC", "aBc", "Abc"])
def test_a_mirror_is_its_own_inverse_whichever_way_it_is_written(text: str) -> None:
    """The triangle group 2 3 7: https://en.wikipedia.org/wiki/(2,3,7)_triangle_group."""
    orders = [2, 3, 7]
    plain = Relations.of(MirrorWord.parse("abc"), orders)
    assert Relations.of(MirrorWord.parse(text), orders) == plain
    assert plain.generators == (1, 2, 3)
    assert plain.texts[:3] == ("a^2", "b^2", "c^2")
