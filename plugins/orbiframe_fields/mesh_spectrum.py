"""Mesh spectrum: the spectra of the surfaces of a mesh, as one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from orbiframe import OrbifoldSurface
from orbiframe.surfaces import (
    ColourScale,
    Spectrum,
    SurfaceForms,
    heat_kernel_signature,
    spectrum,
    wave_kernel_signature,
)
from orbiframe_fields.input_surfaces import Shown

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

# The width of energies, in steps from one to the next of as many as there are eigenvalues (Aubry and others).
_STEPS = 7


@dataclass(frozen=True, eq=False)
class MeshSpectrum:
    """The smallest eigenvalues of all surfaces together, values (k,) and error (k,), rising.

    spectra: of each surface; part and number: (k,), of which surface each is, and which of its eigenvalues.
    """

    spectra: list[Spectrum]
    values: Floats
    error: Floats
    part: Ints
    number: Ints

    @property
    def area(self) -> float:
        """The area of all surfaces."""
        return sum(each.forms.area for each in self.spectra)

    @property
    def size(self) -> int:
        """How many functions the eigenfunctions are made of."""
        return sum(each.forms.basis.size for each in self.spectra)

    def functions(self, there: Shown) -> Floats:
        """The eigenfunctions at the vertices of a mesh, (V, k): 0 on the other surfaces, nan in no face."""
        found = np.full((len(there.mesh.vertices), len(self.values)), np.nan)
        for part, (vertices, points) in enumerate(zip(there.vertices, there.points, strict=True)):
            values = self.spectra[part].evaluate(points)
            found[vertices] = np.where(self.part == part, values[:, np.where(self.part == part, self.number, 0)], 0.0)
        return found

    def signatures(
        self, there: Shown, times: list[float], energies: list[float], width: float | None
    ) -> dict[str, Floats]:
        """Columns of heat and wave kernel signatures by name, (V,) each, of every surface by its own spectrum."""
        columns = {f"heat_{time:g}": np.full(len(there.mesh.vertices), np.nan) for time in times}
        columns |= {f"wave_{energy:g}": np.full(len(there.mesh.vertices), np.nan) for energy in energies}
        for each, vertices, points in zip(self.spectra, there.vertices, there.points, strict=True):
            found = [heat_kernel_signature(each, points, times)] if times else []
            found += [wave_kernel_signature(each, points, energies, width or _width(each))] if energies else []
            for column, values in zip(columns.values(), np.concatenate(found, axis=1).T if found else [], strict=True):
                column[vertices] = values
        return columns

    def scales(self, functions: Floats) -> list[tuple[ColourScale, Floats]]:
        """The colours of the functions, all but the constant ones."""
        some = np.flatnonzero(self.number > 0)
        return [(ColourScale.diverging(functions[:, k]), functions[:, k]) for k in (some if len(some) else [0])]


def mesh_spectrum(surfaces: list[OrbifoldSurface], count: int) -> MeshSpectrum:
    """The `count` smallest eigenvalues of surfaces that lie side by side."""
    spectra = [spectrum(SurfaceForms.of(surface), count) for surface in surfaces]
    values = np.concatenate([each.values for each in spectra])
    order = np.argsort(values, kind="stable")[:count]
    part, number = np.divmod(order, count)
    return MeshSpectrum(spectra, values[order], np.concatenate([each.error for each in spectra])[order], part, number)


def _width(found: Spectrum) -> float:
    energies = np.log(found.values[1:])
    return float(_STEPS * np.ptp(energies) / len(energies)) if len(energies) > 1 else 1.0
