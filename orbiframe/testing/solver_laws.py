"""The laws of a solver: it solves sparse Hermitian positive definite equations to rounding."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csc_array

from orbiframe.errors import OrbiframeError
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.testing.lab import Lab

Numbers = NDArray[Any]
Matrix: TypeAlias = "csc_array[Any]"
Component = Callable[[Matrix], Callable[[Numbers], Numbers]]

_RESIDUAL = 1e-11


def equations_are_solved(component: Component, lab: Lab) -> None:
    """A x = b for real A on the edges of meshes: the residual is rounding, for one right side and for several."""
    for name, matrix in _matrices(lab, complex_=False):
        _require_solved(name, matrix, component(matrix))


def hermitian_equations_are_solved(component: Component, lab: Lab) -> None:
    """A x = b for complex Hermitian A."""
    for name, matrix in _matrices(lab, complex_=True):
        _require_solved(name, matrix, component(matrix))


def solutions_stay(component: Component, lab: Lab) -> None:
    """What solves one system goes on to solve it after another has been factored."""
    for name, matrix in _matrices(lab, complex_=False):
        solve = component(matrix)
        component(csc_array(3.0 * matrix))
        _require_solved(name, matrix, solve)


def matrix_is_kept(component: Component, lab: Lab) -> None:
    """Neither the matrix nor a right side is changed."""
    for name, matrix in _matrices(lab, complex_=True):
        before, right = matrix.copy(), _right(matrix)
        given = right.copy()
        component(matrix)(given)
        assert np.array_equal(matrix.toarray(), before.toarray()), f"{name}: the matrix is another one afterwards"
        assert np.array_equal(given, right), f"{name}: the right side is another one afterwards"


def result_is_repeatable(component: Component, lab: Lab) -> None:
    """The same equations give the same bytes."""
    for name, matrix in _matrices(lab, complex_=False):
        first, again = (component(matrix)(_right(matrix)) for _ in range(2))
        assert first.tobytes() == again.tobytes(), f"{name}: two solutions of the same equations differ"


def singular_equations_are_refused(component: Component, lab: Lab) -> None:
    """A matrix with an empty row is refused with an OrbiframeError, when it is factored or when it is solved."""
    for name, matrix in _matrices(lab, complex_=False):
        keep = np.ones(matrix.shape[0])
        keep[0] = 0
        singular = csc_array(matrix.multiply(keep[:, None]).multiply(keep))
        singular.eliminate_zeros()
        try:
            component(singular)(_right(matrix))
        except OrbiframeError:
            continue
        raise AssertionError(f"{name}: a singular matrix is accepted")


LAWS: tuple[Callable[[Component, Lab], None], ...] = (
    equations_are_solved,
    hermitian_equations_are_solved,
    solutions_stay,
    matrix_is_kept,
    result_is_repeatable,
    singular_equations_are_refused,
)


# ---- mutants --------------------------------------------------------------------------------------------------------


def _of_real_parts(component: Component) -> Component:
    """Solves a complex system as if its imaginary parts were none."""

    def broken(matrix: Matrix) -> Callable[[Numbers], Numbers]:
        solve = component(csc_array(matrix.real))
        return lambda right: solve(np.ascontiguousarray(right.real)) + 0j

    return broken


def _inexact(component: Component) -> Component:
    def broken(matrix: Matrix) -> Callable[[Numbers], Numbers]:
        solve = component(matrix)
        return lambda right: solve(right) * (1 + 1e-8)

    return broken


def _with_one_memory(component: Component) -> Component:
    """Solves with the factors made last, whoever asks."""
    last: list[Callable[[Numbers], Numbers]] = []

    def broken(matrix: Matrix) -> Callable[[Numbers], Numbers]:
        last[:] = [component(matrix)]
        return lambda right: last[0](right)

    return broken


def _overwriting(component: Component) -> Component:
    def broken(matrix: Matrix) -> Callable[[Numbers], Numbers]:
        solve = component(matrix)

        def solution(right: Numbers) -> Numbers:
            found = solve(right)
            right[...] = found
            return found

        return solution

    return broken


def _by_chance(component: Component) -> Component:
    rng = np.random.default_rng()

    def broken(matrix: Matrix) -> Callable[[Numbers], Numbers]:
        solve = component(matrix)
        return lambda right: solve(right) * (1 + 1e-15 * rng.standard_normal(right.shape))

    return broken


def _shifting(component: Component) -> Component:
    """Makes every matrix regular by a tiny shift."""

    def broken(matrix: Matrix) -> Callable[[Numbers], Numbers]:
        every = np.arange(matrix.shape[0])
        return component(csc_array(matrix + coo_array((np.full(len(every), 1e-14), (every, every)))))

    return broken


MUTANTS: Mapping[str, Callable[[Component], Component]] = {
    "equations_are_solved": _inexact,
    "hermitian_equations_are_solved": _of_real_parts,
    "solutions_stay": _with_one_memory,
    "matrix_is_kept": _overwriting,
    "result_is_repeatable": _by_chance,
    "singular_equations_are_refused": _shifting,
}


# ---- things to try --------------------------------------------------------------------------------------------------


def _matrices(lab: Lab, *, complex_: bool) -> Iterator[tuple[str, Matrix]]:
    for name, mesh in lab.polyhedra.items():
        yield name, _on_edges(mesh, complex_)


def _on_edges(mesh: Polyhedron, complex_: bool) -> Matrix:
    """Minus one on the edges, turned by some angle where it is complex, and more than their number on the diagonal."""
    once = np.flatnonzero(mesh.representative)
    tail, head, count = mesh.tail[once], mesh.head[once], len(mesh.vertices)
    apart = tail != head
    tail, head = tail[apart], head[apart]
    entries = -np.exp(1j * np.arange(len(tail))) if complex_ else -np.ones(len(tail))
    degree = np.bincount(tail, minlength=count) + np.bincount(head, minlength=count)
    every = np.arange(count)
    place = np.concatenate([tail, head, every]), np.concatenate([head, tail, every])
    return csc_array(coo_array((np.concatenate([entries, entries.conj(), degree + 0.01]), place), shape=(count, count)))


def _right(matrix: Matrix) -> Numbers:
    found = np.random.default_rng(0).standard_normal((matrix.shape[0], 3))
    return found + 1j * found[:, ::-1] if matrix.dtype.kind == "c" else found


def _require_solved(name: str, matrix: Matrix, solve: Callable[[Numbers], Numbers]) -> None:
    right = _right(matrix)
    for wanted in (right, np.ascontiguousarray(right[:, 0])):
        found = solve(wanted.copy())
        assert np.shape(found) == wanted.shape, f"{name}: a solution of shape {np.shape(found)} for {wanted.shape}"
        worst = float(np.abs(matrix @ found - wanted).max() / np.abs(matrix.data).max() / np.abs(found).max())
        assert worst < _RESIDUAL, f"{name}: the residual of a solution is {worst:.2g}, relative to the matrix times it"
