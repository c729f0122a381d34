"""Approximation: surfaces for one mesh, with as many functions as are asked for or as an accuracy needs."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from orbiframe.components.options import options_of, place_of
from orbiframe.errors import ConfigError, FitError
from orbiframe.fitting.accuracy import Accuracy, accuracy_of, stray_of
from orbiframe.fitting.config import Config
from orbiframe.fitting.fixed_points import with_fixed
from orbiframe.fitting.made import made, made_coefficients
from orbiframe.fitting.mapping import Mapped, Mapping
from orbiframe.fitting.meaning import FACETS, Meaning, facets_show, meaning_of
from orbiframe.fitting.nearness import nearer
from orbiframe.fitting.size import LEAST_SIZE, default_size, size_needed
from orbiframe.fitting.stages import Stages
from orbiframe.functions.basis import Basis
from orbiframe.functions.fitter import Fitter, StartedFitter
from orbiframe.functions.samples import Samples
from orbiframe.meshes.bisection import Bisection
from orbiframe.orbifolds.atlas import Points
from orbiframe.surfaces.surface import OrbifoldSurface
from orbiframe.triangulations.local_girth import averaged, girth

Floats = NDArray[np.float64]

_FIRST_SIZE, _LARGEST_SIZE = 500, 16_000
_GROWTH = (1.3, 2.0)
_FIRST_FITTER = "least-squares"
# No smooth surface through the corners of a facet leaves it by more than this share of its size: a ball has 0.5.
_MOST_STRAY = 0.75
# How the density of functions follows the error: its root, between these shares of the mean, averaged so often.
_LEAST_ERROR, _MOST_ERROR, _ROUNDS = 0.2, 8.0, 8


# Farther from the mesh, in diagonals, too few functions have made spikes of its thin parts.
_MOST_BEYOND = 0.08


class Approximation(NamedTuple):
    """A surface for a mesh of unit size, its map, what it was fitted to, how well, and what a user should know."""

    surface: OrbifoldSurface
    mapped: Mapped
    samples: Samples
    meaning: Meaning
    accuracy: Accuracy
    energy: float
    notes: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class Approximations:
    """Approximations of the mesh of a mapping."""

    mapping: Mapping
    config: Config
    stages: Stages

    def wanted(self) -> Approximation:
        """The surface of the size that is asked for, or that the shape needs, or that an accuracy needs."""
        output = self.config.output
        if output.tolerance is not None or output.max_error is not None:
            return self._accurate(output.tolerance or np.inf, output.max_error or np.inf)
        return self.of_size(self._given_size or self._default_size())

    def of_size(self, size: int, density: Density | None = None) -> Approximation:
        """The surface of so many functions; of more if they cannot follow the map and no number is asked for."""
        mapped = self.mapping.for_size(size)
        mapped = mapped if density is None else mapped.with_density(density.on(mapped.refinement))
        mapped = self._creased(mapped, size, 0 if self._given_size or density else _LARGEST_SIZE)
        energy = girth(mapped.triangulation).energy
        basis = self._basis(mapped, size)
        needed = size_needed(basis, energy)
        if needed > basis.size and self._given_size is None:
            return self.of_size(max(needed, basis.size + 100), density)
        sharp = None if self.config.data.creases is None else self.mapping.sharp(self.mapping.own_facets)
        meaning = meaning_of(self.mapping.own_facets, self.config.data.means, size, sharp)
        notes = () if needed <= basis.size else (too_few(basis.size, needed),)
        try:
            found = self._meant(mapped, basis, meaning, size)
            while (stray := self._stray(found)) > _MOST_STRAY:
                vertices = len(self.mapping.triangles.vertices)
                found = self._meant(mapped, basis, found.meaning.less_smooth(vertices, size, stray), size)
            if notes and found.accuracy.to_mesh.max > _MOST_BEYOND:
                raise FitError(f"the surface leaves the mesh by {found.accuracy.to_mesh.max:.2g} of the diagonal")
        except FitError as error:
            raise FitError("; ".join((str(error), *notes))) from error
        return found._replace(energy=energy, notes=(*notes, *found.notes))

    def _meant(self, mapped: Mapped, basis: Basis, meaning: Meaning, size: int) -> Approximation:
        """The surface of a mesh with this meaning."""
        if self._lifts(meaning, size):
            mapped = self._lifted(mapped, basis, meaning)
            basis = self._basis(mapped, size)
        samples, surface, notes = self._surface(mapped, basis, meaning, self._fitter(), self.config)
        surface = self._moved(surface)
        arcs = samples if meaning.arcs(mapped.triangulation) else None
        accuracy = self.stages("error", accuracy_of, surface, arcs)
        return Approximation(surface, mapped, samples, meaning, accuracy, 0.0, notes)

    def _stray(self, found: Approximation) -> float:
        """By how many of its sizes the surface leaves a facet, where the mesh may mean something less smooth."""
        data = self.config.data
        if data.means != "auto" or data.creases is not None or data.fixed or self.config.output.moved:
            return 0.0
        return 0.0 if found.meaning.name == FACETS else stray_of(found.surface, found.accuracy)

    def _lifts(self, meaning: Meaning, size: int) -> bool:
        """Whether the mesh is mapped again without its facets: where it is smooth, and so coarse that they show."""
        data = self.config.data
        return meaning.smooth and data.lift and data.creases is None and facets_show(self.mapping.own_facets, size)

    def _accurate(self, rms: float, largest: float) -> Approximation:
        """More functions, and more of them where the error is, until the surface is near enough."""
        size, density = _FIRST_SIZE, None
        while True:
            found = self.of_size(size, density)
            reached = found.accuracy.against(found.meaning.smooth)
            excess = max(reached[0] / rms, reached[1] / largest)
            if excess <= 1:
                return found
            if size >= _LARGEST_SIZE:
                raise FitError(
                    f"{found.surface.basis.size} functions reach an error of {reached[0]:.2e} (rms) and "
                    f"{reached[1]:.2e} (largest), not {rms:.2e} and {largest:.2e}; sharp edges converge slowly: allow "
                    "a larger error, or set basis.size yourself"
                )
            density = Density.of_error(found)
            size = min(round(size * np.clip(excess ** (2 / 3), *_GROWTH)), _LARGEST_SIZE)

    @property
    def _given_size(self) -> int | None:
        return self.config.basis.options.get("size")

    def _default_size(self) -> int:
        """The number of functions for this shape, as far as a first map tells."""
        energy = girth(self.mapping.for_size(LEAST_SIZE).triangulation).energy
        chi = self.mapping.surface_type.euler_characteristic
        return default_size(energy, len(self.mapping.triangles.vertices), chi)

    def _creased(self, mapped: Mapped, size: int, most: int) -> Mapped:
        """The map with creases, if they are to stay."""
        if self.config.data.creases is None:
            return mapped
        unknowns = self.stages.registry.load("basis", self.config.basis.name).crease_unknowns  # type: ignore[attr-defined]
        creased: Mapped = self.stages("creases", self.mapping.creased, mapped, size, unknowns, most)
        return creased

    def _basis(self, mapped: Mapped, size: int) -> Basis:
        make = self._sized(size).component("basis", self.stages.registry)
        found = self.stages("basis", make, mapped.triangulation.orbifold, mapped.triangulation)
        return made(self.stages.registry, "basis", self.config.basis.name, found, Basis)  # type: ignore[type-abstract]

    def _fitter(self) -> Fitter:
        found = self.config.component("fitter", self.stages.registry)()
        return made(self.stages.registry, "fitter", self.config.fitter.name, found, Fitter)  # type: ignore[type-abstract]

    def _sized(self, size: int) -> Config:
        """The configuration with this size, where the basis has an option of that name."""
        options = options_of(self.stages.registry.load("basis", self.config.basis.name))
        known = any(option.name == "size" for option in options)
        return self.config.with_options("basis", size=size) if known else self.config

    def _lifted(self, mapped: Mapped, basis: Basis, meaning: Meaning) -> Mapped:
        """The map of the mesh with all its vertices on a first surface, so that it has no facets to show."""
        first = self.stages.registry.load("fitter", _FIRST_FITTER)()
        free = replace(self.config, data=replace(self.config.data, fixed=()))
        surface = self._surface(mapped, basis, meaning, first, free)[1]
        flat = mapped.triangulation
        there = surface.evaluate(Points(flat.patch, flat.points))
        if flat.inside is not None:
            # What only closes the mesh stays where it is: the surface need not be fair there.
            beyond = np.ones(len(there), dtype=np.bool_)
            beyond[flat.polyhedron.triangles[flat.inside]] = False
            there[beyond] = flat.polyhedron.vertices[beyond]
        return self.mapping.of_lifted(mapped, flat.polyhedron.with_vertices(there))

    def _surface(
        self, mapped: Mapped, basis: Basis, meaning: Meaning, fitter: Fitter, config: Config
    ) -> tuple[Samples, OrbifoldSurface, tuple[str, ...]]:
        """What was fitted, the surface, and what a user should know: the linear fit stays where steps made it worse."""
        triangulation, refinement, noise = mapped.triangulation, mapped.refinement, config.data.noise
        samples = self.stages("samples", meaning.samples, triangulation, refinement, basis.size, noise)
        samples = with_fixed(samples, self.mapping, mapped, config)
        started = fitter.fit_started if isinstance(fitter, StartedFitter) else None
        found = self.stages("fit", started or fitter.fit, basis, samples)
        start, end = (found.start, found.coefficients) if started else (found, found)
        shape = basis.size, samples.values.shape[1]
        coefficients = made_coefficients(self.stages.registry, self.config.fitter.name, end, shape)
        recipe = self.config.basis.name, self._options(basis.size)
        surface = OrbifoldSurface(triangulation, refinement, basis, coefficients, np.zeros(3), 1.0, *recipe)
        if start is end or triangulation.crease is not None:
            return samples, surface, ()
        return samples, *nearer(surface, start, samples, meaning.name == FACETS)

    def _moved(self, surface: OrbifoldSurface) -> OrbifoldSurface:
        """The surface with the coefficients that are moved by hand. Raises ConfigError for one that is not there."""
        moved = self.config.output.moved
        if not moved:
            return surface
        coefficients = surface.coefficients.copy()
        for number, *way in moved:
            if number >= len(coefficients):
                place = place_of("output.moved", self.config.places)
                raise ConfigError(
                    f"{place}function {number} is moved, and there are {len(coefficients)}, from 0 on; output.moved "
                    "belongs to the mesh and the options of the basis that it was made with"
                )
            coefficients[number] += np.array(way) / self.mapping.scale
        return replace(surface, coefficients=coefficients)

    def _options(self, size: int) -> dict[str, Any]:
        """All options of the basis, those given and the defaults of the others."""
        given = self._sized(size).basis.options
        options = options_of(self.stages.registry.load("basis", self.config.basis.name))
        return {option.name: given.get(option.name, option.default) for option in options}


class Density(NamedTuple):
    """How many functions there should be per length, at the vertices of a refinement, (V,), up to a factor."""

    refinement: Bisection
    values: Floats

    @classmethod
    def of_error(cls, found: Approximation) -> Density:
        """More where the error is: its root against the mean, times the density before."""
        triangulation = found.mapped.triangulation
        error = averaged(triangulation, found.accuracy.at_vertices, _ROUNDS)
        relative = error / max(float(np.sqrt(np.mean(error**2))), np.finfo(float).tiny)
        factor = np.sqrt(np.clip(relative, _LEAST_ERROR, _MOST_ERROR))
        before = 1.0 if triangulation.density is None else triangulation.density
        return cls(found.mapped.refinement, factor * before)

    def on(self, refinement: Bisection) -> Floats:
        """The density at the vertices of another refinement of the same mesh, (V,)."""
        if refinement is self.refinement:
            return self.values
        face, barycentric = refinement.origins()
        fine, weights = self.refinement.locate(face, barycentric)
        corners = self.values[self.refinement.polyhedron.triangles[fine]]
        return np.asarray(np.einsum("nc,nc->n", weights, corners))


def too_few(size: int, needed: int) -> str:
    """What a user should know of a size below the one that the shape needs."""
    return f"{size} functions are too few for the thin parts of this mesh: take about {needed} (option size)"
