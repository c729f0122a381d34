"""Solving: the solver of sparse equations that a fit has chosen, for all code that runs within it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any

from numpy.typing import NDArray
from scipy.sparse import csc_array

# From a sparse Hermitian positive definite matrix to the solution of its equations for right sides (n,) or (n, k).
Solver = Callable[["csc_array[Any]"], Callable[[NDArray[Any]], NDArray[Any]]]

_CHOSEN: ContextVar[Solver | None] = ContextVar("solver", default=None)


def chosen_solver() -> Solver | None:
    """The solver that has been chosen, None where a step may use the order of its own mesh and its own factors."""
    return _CHOSEN.get()


@contextmanager
def solving_by(solver: Solver | None) -> Iterator[None]:
    """Within this, equations of maps are solved by a solver."""
    token = _CHOSEN.set(solver)
    try:
        yield
    finally:
        _CHOSEN.reset(token)
