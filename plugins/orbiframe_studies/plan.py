"""Plan: the fits of a study in their order, each with the key of its content."""

from __future__ import annotations

import itertools
import json
import math
from collections.abc import Generator, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from orbiframe import Config, ConfigError, PluginError, Registry
from orbiframe.files import called
from orbiframe.fitting import content_key, file_key, source_key
from orbiframe_studies.search import suggestions
from orbiframe_studies.study import Case, Study, Until
from orbiframe_studies.study_file import with_mapping

Row = Mapping[str, Any]
_CHOSEN = ("parametrizer", "marker")


@dataclass(frozen=True, slots=True)
class Fit:
    """One fit: its mesh, its configuration, and what names it in the table.

    name: of the mesh there; key: of all content that the fit depends on.
    """

    key: str
    mesh: Path
    name: str
    tables: Mapping[str, Any]
    case: str
    parameters: Mapping[str, Any]
    seed: int | None

    @property
    def title(self) -> str:
        """What it is, in a few words."""
        values = [f"{name.partition('.')[2]} {value}" for name, value in self.parameters.items()]
        seed = [] if self.seed is None else [f"seed {self.seed}"]
        return ", ".join(filter(None, [Path(self.name).name, self.case, *values, *seed]))


# A chain yields fits that may be done at once, and is sent their rows; what comes next may depend on them.
Chain = Generator[list[Fit], list[Row], None]


class Plan:
    """All chains of fits of a study, checked before the first one begins."""

    def __init__(self, study: Study, registry: Registry) -> None:
        self.study, self.registry = study, registry
        for path in study.plugins:
            registry.add_file(path)
        self._files = [file_key(path) for path in study.plugins]
        self._resolved: dict[str, dict[str, Any]] = {}
        self._meshes: dict[Path, str] = {}
        self._require_configs()

    @property
    def expected(self) -> int:
        """How many fits there are; the most there can be where each depends on the one before it."""
        return self.chain_count * self.chain_length

    @property
    def fits_per_mesh(self) -> int:
        """How many fits a mesh has at most."""
        return self.expected // max(len(self.study.meshes), 1)

    @property
    def chain_count(self) -> int:
        """How many chains there are."""
        study = self.study
        combinations = math.prod(len(values) for values in study.sweep.values())
        return len(study.meshes) * max(len(study.cases), 1) * combinations * max(len(study.settings.seeds), 1)

    @property
    def varies(self) -> bool:
        """Whether a chain may end before its greatest length."""
        return self.study.until is not None

    @property
    def chain_length(self) -> int:
        """How many fits a chain has at most."""
        if self.study.search:
            return self.study.search.trials
        return len(list(_growing(self.study.until))) if self.study.until else 1

    def chains(self) -> Iterator[Chain]:
        """A chain for each mesh, case, combination of the sweep and seed, in this order, the last the fastest."""
        for mesh in self.study.meshes:
            for case, options in self._options():
                for seed in self.study.settings.seeds or (None,):
                    yield self._chain(mesh, case, options, seed)

    def _options(self) -> Iterator[tuple[Case, dict[str, Any]]]:
        names, values = list(self.study.sweep), list(self.study.sweep.values())
        for case in self.study.cases or (Case(""),):
            for chosen in itertools.product(*values):
                yield case, dict(zip(names, chosen, strict=True))

    def _chain(self, mesh: Path, case: Case, swept: dict[str, Any], seed: int | None) -> Chain:
        if self.study.until:
            return self._until(self.study.until, mesh, case, swept, seed)
        if self.study.search:
            return self._search(mesh, case, swept, seed)
        return self._single(mesh, case, swept, seed)

    def _single(self, mesh: Path, case: Case, swept: dict[str, Any], seed: int | None) -> Chain:
        yield [self.fit(mesh, case, swept, seed)]

    def _until(self, until: Until, mesh: Path, case: Case, swept: dict[str, Any], seed: int | None) -> Chain:
        for value in _growing(until):
            (row,) = yield [self.fit(mesh, case, {**swept, until.key: value}, seed)]
            found = measured(row, until.measure)
            if found is not None and found <= until.below:
                return

    def _search(self, mesh: Path, case: Case, swept: dict[str, Any], seed: int | None) -> Chain:
        search = self.study.search
        assert search is not None
        asked = suggestions(search)
        chosen = next(asked)
        while chosen:
            rows = yield [self.fit(mesh, case, {**swept, **each}, seed) for each in chosen]
            chosen = asked.send([measured(row, search.measure) for row in rows])

    def fit(self, mesh: Path, case: Case, swept: Mapping[str, Any], seed: int | None) -> Fit:
        """One fit of the study."""
        tables = with_mapping(self.study.tables, {**case.options, **swept})
        resolved = self._known(tables)
        if seed is not None:
            tables, resolved = _seeded(tables, seed, resolved), {**resolved, "seed": seed}
        settings, like = self.study.settings, resolved["config"]["map"]["like"]
        content = {
            "mesh": self._mesh_key(mesh),
            "suffix": mesh.suffix.lower(),
            "noise": settings.noise,
            "keep": sorted(settings.keep),
            "plugins": self._files,
            "like": None if like is None else self._mesh_key(Path(like)),
            **resolved,
        }
        return Fit(content_key(content), mesh.absolute(), self._name(mesh), tables, case.name, dict(swept), seed)

    def _name(self, mesh: Path) -> str:
        """The mesh as it is named in the table: from the folder of the study file on."""
        folder = self.study.file.parent
        return mesh.relative_to(folder).as_posix() if mesh.is_relative_to(folder) else called(mesh)

    def _mesh_key(self, mesh: Path) -> str:
        if mesh not in self._meshes:
            try:
                self._meshes[mesh] = file_key(mesh)
            except OSError as error:  # the fit will say so in its row, and is done when the mesh can be read
                self._meshes[mesh] = f"unreadable: {error.strerror}"
        return self._meshes[mesh]

    def config(self, tables: Mapping[str, Any]) -> Config:
        """The configuration of tables, checked; errors name the place in the study file."""
        return Config.from_tables(tables, places=self._places()).checked(self.registry)

    def _places(self) -> dict[str, str]:
        """Where the keys of a fit were written: those of sweeps and cases too."""
        places = dict(self.study.places)
        for owner in ("sweep", "case"):
            for name, place in self.study.places.items():
                if name.startswith(f"{owner}."):
                    places.setdefault(name.removeprefix(f"{owner}."), place)
        return places

    def _known(self, tables: Mapping[str, Any]) -> dict[str, Any]:
        """All that the result depends on beside the mesh: resolved options, and the sources of the components."""
        text = json.dumps(tables, sort_keys=True, default=str)
        if text not in self._resolved:
            config = self.config(tables)
            resolved = config.resolved(self.registry)
            sources = {name: self._sources(step.kind, step.name, step.open) for name, step in config.steps.items()}
            self._resolved[text] = {"config": resolved, "sources": sources}
        return self._resolved[text]

    def _sources(self, kind: str, name: str, free: bool) -> list[str]:
        """The sources of the component of a step; of all maps and markers, where the mesh chooses one of them."""
        if not free:
            return [source_key(self.registry.load(kind, name))]
        found = []
        for component in self.registry.components(kind) if kind in _CHOSEN else []:
            with suppress(PluginError):
                found.append(source_key(self.registry.load(kind, component.name)))
        return found

    def _require_configs(self) -> None:
        """Raise what is wrong with any configuration of the study, before any work."""
        sweeps = self.study.search.space if self.study.search else {}
        ends = {name: _example(values) for name, values in sweeps.items()}
        if self.study.until:
            ends[self.study.until.key] = next(iter(_growing(self.study.until)))
        for case, options in self._options():
            known = self._known(with_mapping(self.study.tables, {**case.options, **options, **ends}))
            self._require_use_of_seeds(known)

    def _require_use_of_seeds(self, known: Mapping[str, Any]) -> None:
        settings = self.study.settings
        if settings.seeds and settings.noise is None and not _seeded_tables(known):
            raise ConfigError(
                f"{self.study.places.get('study.seeds', 'study.seeds')}: no component of this study has an option "
                "'seed', so that all seeds would give the same; give study.noise, or leave out the seeds"
            )


def measured(row: Row, measure: str) -> float | None:
    """A number of a report by its name, such as "fit.rms"; None where the fit failed."""
    found: Any = row.get("report")
    for name in measure.split("."):
        found = None if found is None else found.get(name)
    return None if found is None else float(found)


def _growing(until: Until) -> Iterator[float]:
    """The values of an adaptive study: whole ones if the first is."""
    value, whole = until.start, float(until.start).is_integer()
    while value < until.most:
        yield round(value) if whole else value
        value *= until.factor
    yield round(until.most) if whole and float(until.most).is_integer() else until.most


def _example(values: Any) -> Any:
    return values[0] if isinstance(values, list) else values["low"]


def _seeded_tables(known: Mapping[str, Any]) -> list[str]:
    return [table for table, options in known["config"].items() if "seed" in options]


def _seeded(tables: dict[str, dict[str, Any]], seed: int, known: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
    """The tables with the seed for every component that takes one."""
    return with_mapping(tables, {f"{table}.seed": seed for table in _seeded_tables(known)})
