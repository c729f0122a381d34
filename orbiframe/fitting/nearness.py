"""Nearness: how far a surface is from what was fitted, quickly, to choose between two."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from orbiframe.functions.basis import DifferentiableBasis
from orbiframe.functions.feet import feet_of
from orbiframe.functions.samples import Samples
from orbiframe.meshes.nearest_points import NearestPoints
from orbiframe.surfaces.surface import OrbifoldSurface

Floats = NDArray[np.float64]

# So many samples tell which of two surfaces is nearer.
_MOST = 8192
# A linear fit that is nearer by less than this is no news.
_MUCH = 1.05


def nearer(
    surface: OrbifoldSurface, start: Floats, samples: Samples, both: bool
) -> tuple[OrbifoldSurface, tuple[str, ...]]:
    """A surface, or that of the linear fit that it began with if this is nearer; if it is much, a sentence says so.

    both: whether the distances of the surface from the mesh count as well.
    """
    first = replace(surface, coefficients=start)
    before, after = (nearness(each, samples, both=both) for each in (first, surface))
    if after <= before:
        return surface, ()
    if after <= _MUCH * before:
        return first, ()
    told = (
        f"sliding left the surface at {after:.2g} of the diagonal and the linear fit at {before:.2g}: that one is kept"
    )
    return first, (told,)


def nearness(surface: OrbifoldSurface, samples: Samples, *, both: bool) -> float:
    """The root mean square of the distances of samples that count from a surface.

    both: the larger of that and of the distances of the surface from the mesh, at the parameters of the samples.
    """
    basis = surface.basis
    assert isinstance(basis, DifferentiableBasis)
    counted = np.flatnonzero(samples.weights > 0)
    some = samples.take(counted[:: 1 + len(counted) // _MOST])
    longest = float(np.sqrt(samples.shares.sum() / basis.size))
    feet = feet_of(basis, surface.coefficients, some.points, some.values, longest)
    share = some.weights / some.weights.sum()
    there = float(np.sqrt(share @ feet.distance**2))
    if not both:
        return there
    back = NearestPoints(surface.refinement.polyhedron).distance(surface.evaluate(some.points))
    return max(there, float(np.sqrt(share @ back**2)))
