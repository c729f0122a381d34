"""Symplectic bases of random unimodular skew forms."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from orbiframe.errors import TopologyError
from orbiframe.triangulations.symplectic_basis import standard_form, symplectic_basis


@settings(deadline=None, max_examples=50)
@given(st.integers(1, 6), st.integers(0, 2**31))
def test_a_form_in_any_basis_becomes_the_standard_one(genus, seed):
    rng = np.random.default_rng(seed)
    change = np.eye(2 * genus, dtype=int)
    for _ in range(6 * genus):
        i, j = rng.choice(2 * genus, 2, replace=False)
        change[i] += rng.integers(-1, 2) * change[j]
    form = change @ standard_form(genus) @ change.T
    basis = symplectic_basis(form)
    assert (basis @ form @ basis.T == standard_form(genus)).all()
    assert abs(round(np.linalg.det(basis))) == 1


OTHERS = np.zeros((2, 2), int), 2 * standard_form(1), np.zeros((3, 3), int), np.eye(2, dtype=int)


@pytest.mark.parametrize("form", OTHERS)
def test_other_forms_are_refused(form):
    with pytest.raises(TopologyError, match="symplectic"):
        symplectic_basis(form)
