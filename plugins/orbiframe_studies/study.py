"""Study: what one file says of many fits."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any, Literal

from annotated_types import Ge, Gt, Le, MinLen

from orbiframe import UsageError
from orbiframe.components import did_you_mean

Keep = Literal["arrays", "surface", "mesh"]
Measure = Literal["fit.rms", "fit.max"]
MEASURES = ("fit.rms", "fit.max")


@dataclass(frozen=True, slots=True, kw_only=True)
class Settings:
    """The table [study].

    meshes: files or patterns, relative to the file; name: of the study, None for that of the file; seeds: every fit is
    done once for each; noise: normal noise on each coordinate of the vertices, of this size relative to the diagonal of
    the box, by the seed; keep: what is kept of each fit beside its row; maps: whether maps to X/H are kept for other
    fits, "auto" where a mesh has several; memory: GB that one process may take.
    """

    meshes: Annotated[tuple[str, ...], MinLen(1)]
    name: Annotated[str, MinLen(1)] | None = None
    seeds: tuple[Annotated[int, Ge(0)], ...] = ()
    noise: Annotated[float, Gt(0), Le(1)] | None = None
    keep: tuple[Keep, ...] = ()
    maps: Literal["auto", "kept", "none"] = "auto"
    memory: Annotated[float, Gt(0)] | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Until:
    """The table [until]: a key grows until a measure is small enough.

    key: of the configuration, a number; start: its first value; factor: by which it grows; most: its largest value;
    measure: what is watched, below: what it has to fall to.
    """

    below: Annotated[float, Gt(0)]
    key: str = "basis.size"
    start: Annotated[float, Gt(0)] = 100
    factor: Annotated[float, Gt(1)] = 2.0
    most: Annotated[float, Gt(0)] = 16_000
    measure: Measure = "fit.rms"


@dataclass(frozen=True, slots=True, kw_only=True)
class Search:
    """The table [search]: optuna looks for the values with the least measure.

    trials: how many fits in all; batch: how many are tried before the next are chosen, which may run at once; seed: of
    the choice; measure: what is to be small; space: keys, each with a list of values or with low and high.
    """

    trials: Annotated[int, Ge(1)]
    space: dict[str, Any]
    batch: Annotated[int, Ge(1)] = 4
    seed: Annotated[int, Ge(0)] = 0
    measure: Measure = "fit.rms"


@dataclass(frozen=True, slots=True)
class Case:
    """A named set of options, "table.key" to value."""

    name: str
    options: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Study:
    """Many fits: every mesh, with every case, with every combination of the sweep, for every seed.

    tables: the configuration that all have in common; sweep: "table.key" to its values; places: where each key was
    written; file: the study file, to whose folder the paths in it are relative.
    """

    file: Path
    settings: Settings
    meshes: tuple[Path, ...]
    tables: Mapping[str, Any]
    sweep: Mapping[str, tuple[Any, ...]]
    cases: tuple[Case, ...]
    until: Until | None
    search: Search | None
    plugins: tuple[Path, ...]
    places: Mapping[str, str]

    @property
    def name(self) -> str:
        """The name of the study."""
        return self.settings.name or self.file.stem


def require_measure(name: str) -> None:
    """Raise UsageError unless this is a measure of a fit."""
    if name not in MEASURES:
        raise UsageError(f"no measure named '{name}'; there are {', '.join(MEASURES)}.{did_you_mean(name, MEASURES)}")
