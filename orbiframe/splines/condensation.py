"""Condensation: equations of continuous polynomials, what lies inside the triangles solved triangle by triangle."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import bsr_array, csc_array, csr_array
from scipy.sparse.linalg import splu

from orbiframe.splines.bernstein import exponents
from orbiframe.splines.element_basis import ElementBasis

Floats = NDArray[np.float64]


def least_energy(basis: ElementBasis, energy: csr_array, start: Floats) -> Floats:
    """Piecewise polynomials of least energy among those that differ from others by functions of a basis.

    basis: continuous polynomials on whole triangles; energy: sparse (F n, F n), in blocks of the triangles, in the
    Bernstein coefficients of every triangle for itself, zero for the constants and for no other function; start:
    (F n, k), in the same coefficients. Returns theirs, (F n, k). For a degree d all but 3 d unknowns of a triangle
    disappear before the equations are factored.
    """
    count, faces, k = len(exponents(basis.degree)), basis.domain.face_count, start.shape[1]
    inner = np.flatnonzero((exponents(basis.degree) > 0).all(axis=1))
    outer = np.setdiff1d(np.arange(count), inner)
    blocks = bsr_array(energy, blocksize=(count, count)).data
    right = -(blocks @ start.reshape(faces, count, k))
    # What the inner coefficients are, of those on the edges and of the right side.
    solved = np.linalg.solve(
        blocks[:, inner[:, None], inner], np.concatenate([blocks[:, inner[:, None], outer], right[:, inner]], axis=2)
    )
    through, own = solved[..., : len(outer)], solved[..., len(outer) :]
    across = blocks[:, outer[:, None], inner]
    local, force = blocks[:, outer[:, None], outer] - across @ through, right[:, outer] - across @ own
    rows = (np.arange(faces)[:, None] * count + outer).ravel()
    shared = csr_array(basis.matrix[rows])
    used = np.unique(shared.indices)
    shared = csr_array(csc_array(shared)[:, used])
    diagonal = bsr_array((local, np.arange(faces), np.arange(faces + 1))).tocsr()
    # Constants have no energy; the first unknown is kept at zero.
    matrix = csc_array(shared.T @ (diagonal @ shared))[1:, 1:]
    factor = splu(csc_array(matrix), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    unknown = factor.solve((shared.T @ force.reshape(len(rows), k))[1:])
    edges = (shared @ np.concatenate([np.zeros((1, k)), unknown])).reshape(faces, len(outer), k)
    found = start.reshape(faces, count, k).copy()
    found[:, outer] += edges
    found[:, inner] += own - through @ edges
    return np.asarray(found.reshape(start.shape))
