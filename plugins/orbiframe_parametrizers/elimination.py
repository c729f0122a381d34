"""Elimination: orders in which sparse matrices on a mesh are factored with little fill, and solutions by factors."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csc_array, csr_array, diags_array
from scipy.sparse.linalg import LinearOperator, SuperLU, cg, splu

from orbiframe import MapError, Polyhedron
from orbiframe.workers import chosen_solver

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

_DIGITS = 1e-5
_PATIENCE = 25
_KEPT = 4  # orders of the meshes before


@dataclass(frozen=True, eq=False)
class Elimination:
    """An order of the vertices of a mesh in which matrices on its edges are factored with little fill.

    order: (V,), the vertices one after the other; place: (V,), where each vertex stands in the order.
    """

    order: Ints
    place: Ints

    @classmethod
    def of(cls, mesh: Polyhedron) -> Elimination:
        """A good order for the edges of a mesh; found once for all meshes with the same faces."""
        if mesh not in _FOUND:
            _FOUND[mesh] = _of_faces(_Faces(mesh))
        return _FOUND[mesh]

    def matrix(self, tail: Ints, head: Ints, entries: NDArray[Any], diagonal: NDArray[Any]) -> csc_array[Any]:
        """The Hermitian matrix in this order with entries (E,) at (tail, head), conjugates at (head, tail)."""
        i, j = self.place[tail], self.place[head]
        rows, columns = np.concatenate([i, j, self.place]), np.concatenate([j, i, self.place])
        data = np.concatenate([entries, np.conj(entries), diagonal])
        return coo_array((data, (rows, columns)), shape=(len(self.order),) * 2).tocsc()

    def solver(
        self, tail: Ints, head: Ints, entries: NDArray[Any], diagonal: NDArray[Any]
    ) -> Callable[[NDArray[Any]], NDArray[Any]]:
        """The solution of systems with that matrix for right sides (V,) or (V, k); numbered like the mesh.

        Raises MapError for a singular matrix.
        """
        factors = factorised(self.matrix(tail, head, entries, diagonal))
        return lambda right: np.asarray(factors.solve(right[self.order])[self.place])


_FOUND: WeakKeyDictionary[Polyhedron, Elimination] = WeakKeyDictionary()


class _Faces:
    """The faces of a mesh, which are equal where their corners are, wherever those lie in space."""

    def __init__(self, mesh: Polyhedron) -> None:
        self.mesh = mesh
        numbers = (np.ascontiguousarray(array) for array in (mesh.offsets, mesh.tail))
        self._sum = len(mesh.vertices), *(hashlib.sha256(array.data).digest() for array in numbers)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Faces) and self._sum == other._sum

    def __hash__(self) -> int:
        return hash(self._sum)


@lru_cache(_KEPT)
def _of_faces(faces: _Faces) -> Elimination:
    mesh = faces.mesh
    once = mesh.representative
    order = elimination_order(len(mesh.vertices), mesh.tail[once], mesh.head[once])
    return Elimination(order, np.argsort(order))


def elimination_order(count: int, tail: Ints, head: Ints) -> Ints:
    """The vertices in an order that keeps the factors of matrices on the edges (tail, head) sparse, (count,).

    Nested dissection by METIS (Karypis and Kumar 1998); minimum degree on systems for which METIS is not packaged.
    """
    graph = _graph(count, tail, head)
    try:
        return dissection_order(graph)
    except ImportError:
        return minimum_degree_order(graph)


def _graph(count: int, tail: Ints, head: Ints) -> csr_array[Any]:
    """Ones where two vertices have a common edge, however many, and nothing on the diagonal."""
    apart = tail != head
    tail, head = tail[apart], head[apart]
    place = np.concatenate([tail, head]), np.concatenate([head, tail])
    graph = coo_array((np.ones(2 * len(tail)), place), shape=(count, count)).tocsr()
    graph.data[:] = 1.0
    return graph


def dissection_order(graph: csr_array[Any]) -> Ints:
    """Halves first, the separator between them last, recursively: about V log V entries in a factor.

    Raises ImportError where pymetis is not installed.
    """
    from pymetis import CSRAdjacency, nested_dissection

    if graph.nnz == 0:
        return np.arange(graph.shape[0])
    return np.array(nested_dissection(CSRAdjacency(graph.indptr, graph.indices))[0], dtype=np.intp)


def minimum_degree_order(graph: csr_array[Any]) -> Ints:
    """A vertex with the fewest neighbours first, its neighbours joined, and so on."""
    count = graph.shape[0]
    # SuperLU's minimum degree takes quadratic time on some regular numberings: shuffled vertices have none.
    shuffled = np.random.default_rng(0).permutation(count)
    matrix = (diags_array(1.0 + np.diff(graph.indptr)) - graph).tocsc()[shuffled][:, shuffled]
    factors = splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    order = np.empty(count, dtype=np.intp)
    order[factors.perm_c] = shuffled
    return order


def solver_on(
    mesh: Polyhedron, edges: tuple[Ints, Ints], entries: NDArray[Any], diagonal: NDArray[Any]
) -> Callable[[NDArray[Any]], NDArray[Any]]:
    """The solution of systems with a Hermitian matrix, see `Elimination.matrix`, by the solver that is chosen.

    edges: tails and heads among those of the mesh. Raises MapError for a singular matrix.
    """
    chosen = chosen_solver()
    if chosen is None:
        return Elimination.of(mesh).solver(*edges, entries, diagonal)
    return chosen(csc_array(_hermitian(*edges, entries, diagonal)))


class Successive:
    """Solutions of symmetric positive definite systems on one set of vertices, each matrix near the one before.

    The factors of the first matrix precondition conjugate gradients with the later ones, whatever edges those have; a
    matrix is factored only where that takes too many steps. A step costs a fifteenth of the factors or less.
    """

    def __init__(self) -> None:
        self._near: Callable[[Floats], Floats] | None = None

    def solution(
        self, mesh: Polyhedron, edges: tuple[Ints, Ints], entries: Floats, diagonal: Floats, right: Floats
    ) -> Floats:
        """The solution (V,) to five digits, as a step of Newton's method needs it.

        edges: tails and heads (E,) among the edges of the mesh; entries (E,), diagonal (V,): of the matrix. Raises
        MapError for a singular matrix.
        """
        if self._near is not None:
            matrix = _hermitian(*edges, entries, diagonal)
            answer, found = by_conjugate_gradients(matrix, right, self._near, tolerance=_DIGITS, steps=_PATIENCE)
            if found:
                return answer
        self._near = solver_on(mesh, edges, entries, diagonal)
        return self._near(right)


def by_conjugate_gradients(
    matrix: Any, right: Floats, near: Callable[[Floats], Floats], *, tolerance: float, steps: int
) -> tuple[Floats, bool]:
    """The solution of a positive definite system, and whether so many steps bring it to a relative tolerance.

    near: solves a system whose matrix is near to this one.
    """
    inverse = LinearOperator(matrix.shape, matvec=lambda r: near(r.ravel()), dtype=np.float64)
    answer, failure = cg(matrix, right, rtol=tolerance, maxiter=steps, M=inverse)
    return np.asarray(answer), failure == 0


def _hermitian(tail: Ints, head: Ints, entries: NDArray[Any], diagonal: NDArray[Any]) -> csr_array[Any]:
    every = np.arange(len(diagonal))
    place = np.concatenate([tail, head, every]), np.concatenate([head, tail, every])
    return coo_array((np.concatenate([entries, np.conj(entries), diagonal]), place), shape=(len(every),) * 2).tocsr()


def factorised(matrix: csc_array[Any]) -> SuperLU:
    """The factors of a symmetric (Hermitian) matrix whose rows are in elimination order already, without pivoting.

    Raises MapError for a singular matrix.
    """
    try:
        return splu(matrix, permc_spec="NATURAL", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    except RuntimeError as error:
        raise MapError(
            "the equations of the map are singular; look for degenerate triangles with `orbiframe info`"
        ) from error
