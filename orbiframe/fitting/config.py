"""Config: which component does each step of a fit, and with which options."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Annotated, Any, Literal

from annotated_types import Ge, Gt

from orbiframe.components.options import Option, checked_options, checked_value, options_of, place_of, require_known
from orbiframe.components.registry import Registry
from orbiframe.components.shown_text import shown
from orbiframe.components.suggestion import did_you_mean
from orbiframe.errors import ConfigError, FormatError, PluginError, UsageError
from orbiframe.files.places import require_readable
from orbiframe.fitting.limits import require_size
from orbiframe.plugin import OPEN_NAMES


@dataclass(frozen=True, slots=True)
class Step:
    """The component of one step, by name, and its options; `open` while the pipeline is to choose the component."""

    kind: str
    name: str
    options: Mapping[str, Any] = field(default_factory=dict)

    @property
    def open(self) -> bool:
        """Whether no component is named: the pipeline chooses by the geometry, the mesh or the file, or takes none."""
        return self.name in OPEN_NAMES


@dataclass(frozen=True, slots=True, kw_only=True)
class Output:
    """What to make of the surface.

    refine: every triangle of the mesh becomes refine^2 triangles, None for as many as a fine picture needs; tolerance
    and max_error: the largest root mean square and the largest distance allowed, relative to the diagonal of the
    bounding box, None for a fixed size.
    """

    refine: Annotated[int, Ge(1)] | None = None
    tolerance: Annotated[float, Gt(0)] | None = None
    max_error: Annotated[float, Gt(0)] | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Data:
    """What the mesh means.

    means: "facets", the polyhedron is the truth; "smooth", its vertices lie on a smooth surface; "semi-smooth", so they
    do where facets are curved; "auto" decides by its bends. lift: whether a smooth mesh is mapped again after it has
    been lifted onto its first surface. noise: the root mean square error of each coordinate of the vertices of a smooth
    mesh, relative to the diagonal of the bounding box; None: found from the vertices.
    """

    means: Literal["auto", "smooth", "semi-smooth", "facets"] = "auto"
    lift: bool = True
    noise: Annotated[float, Gt(0)] | None = None


# Table of the configuration: the kind of its component, the key that names it, and the name if nothing is said.
STEPS = {
    "mesh": ("reader", "format", "auto"),
    "geometry": ("geometry", "name", "auto"),
    "group": ("group", "method", "mesh"),
    "marking": ("marker", "method", "auto"),
    "map": ("parametrizer", "method", "auto"),
    "shape": ("optimizer", "method", "none"),
    "basis": ("basis", "name", "gaussian"),
    "fitter": ("fitter", "name", "sliding"),
}
TABLES = (*STEPS, "data", "output")
_LARGEST_FILE = 2**20


@dataclass(frozen=True, slots=True)
class Config:
    """A fit in words: a step for each of the tables of `STEPS`, the output, what the mesh means, plugin files.

    mesh: the reader, "auto" by the file suffix; geometry: the plane X, "auto" by the Euler characteristic; group:
    "mesh" takes the group from the mesh; marking: cuts the mesh open for a named group; map: "auto" takes the
    parametrizer that fits the geometry and the group; shape: changes the map so that faces become regular, "none"
    leaves it as it is; basis; fitter.
    places: where each "table.key" was written, for error messages.
    """

    steps: Mapping[str, Step]
    output: Output = field(default_factory=Output)
    data: Data = field(default_factory=Data)
    plugins: tuple[Path, ...] = ()
    places: Mapping[str, str] = field(default_factory=dict)

    @classmethod
    def load(cls, path: Path | None = None, overrides: Iterable[str] = ()) -> Config:
        """The configuration of a TOML file (None: all defaults) with overrides "TABLE.KEY=VALUE".

        A VALUE is read as TOML, and as text where it is none. Plugin files are relative to the folder of the file.
        Raises ConfigError for text that is not TOML, unknown tables, and values of a wrong type.
        """
        text = "" if path is None else _read(path)
        tables = _parsed(text, path)
        places = _places(text, path)
        for override in overrides:
            table, key, value = parsed_override(override)
            place = places[f"{table}.{key}"] = f"--set {shown(override, 100)}"
            require_table(table, TABLES, {table: place})
            tables[table] = {**_table(tables, table, places), key: value}
        return cls.from_tables(tables, places=places, folder=Path() if path is None else path.parent)

    @classmethod
    def from_tables(
        cls, tables: Mapping[str, Any], *, places: Mapping[str, str] | None = None, folder: Path = Path()
    ) -> Config:
        """The configuration that a TOML file with these tables says; see `load`."""
        places = dict(places or {})
        for table in tables:
            require_table(table, (*TABLES, "plugins"), places)
        files = checked_value(tuple[str, ...], tables.get("plugins", []), "plugins", places)
        steps = {table: _step(table, _table(tables, table, places), places) for table in STEPS}
        output = Output(**checked_options(Output, _table(tables, "output", places), "output", places))
        data = Data(**checked_options(Data, _table(tables, "data", places), "data", places))
        return cls(steps, output, data, tuple(folder / file for file in files), places)

    @property
    def mesh(self) -> Step:
        """The reader."""
        return self.steps["mesh"]

    @property
    def geometry(self) -> Step:
        """The geometry."""
        return self.steps["geometry"]

    @property
    def group(self) -> Step:
        """The group."""
        return self.steps["group"]

    @property
    def marking(self) -> Step:
        """The marker."""
        return self.steps["marking"]

    @property
    def map(self) -> Step:
        """The parametrizer."""
        return self.steps["map"]

    @property
    def shape(self) -> Step:
        """The optimizer."""
        return self.steps["shape"]

    @property
    def basis(self) -> Step:
        """The basis."""
        return self.steps["basis"]

    @property
    def fitter(self) -> Step:
        """The fitter."""
        return self.steps["fitter"]

    def with_options(self, table: str, **options: object) -> Config:
        """The same configuration with other options in the table of one step; checked when the component is known."""
        step = self.steps[table]
        changed = replace(step, options={**step.options, **options})
        return replace(self, steps={**self.steps, table: changed})

    def component(self, table: str, registry: Registry, name: str | None = None) -> Callable[..., Any]:
        """The component of a step with its options bound: call it with the positional arguments of its kind.

        name: the component that the pipeline has chosen, where the step is open. Raises ConfigError for an unknown
        name, PluginError where the component cannot be imported, ConfigError where the options do not fit it.
        """
        step = self.steps[table]
        target = self._loaded(table, registry, name or step.name)
        options = checked_options(target, step.options, table, self.places, STEPS[table][1])
        return partial(target, **options) if options else target

    def _loaded(self, table: str, registry: Registry, name: str) -> Callable[..., Any]:
        kind, key, _ = STEPS[table]
        try:
            return registry.load(kind, name)
        except UsageError as error:
            raise ConfigError(f"{place_of(f'{table}.{key}', self.places)}{error}") from error

    def checked(self, registry: Registry) -> Config:
        """This configuration, once every named component is known to exist and to take its options.

        The options of an open step must belong to one of the components of its kind.
        """
        require_size(self.basis.options.get("size"), self.places)
        for table, step in self.steps.items():
            if not step.open:
                self.component(table, registry)
            elif step.options:
                _require_option_of_kind(table, step, registry, self.places)
        return self


def _read(path: Path) -> str:
    try:
        require_readable(path, _LARGEST_FILE, empty=True)
        return path.read_text(encoding="utf-8-sig")
    except (FormatError, OSError, UnicodeDecodeError) as error:
        raise ConfigError(f"the configuration {path} cannot be read: {error}") from error


def _parsed(text: str, path: Path | None) -> dict[str, Any]:
    try:
        return tomllib.loads(text)
    except ValueError as error:  # also for numbers of thousands of digits
        raise ConfigError(f"{path} is not TOML: {error}") from error
    except RecursionError as error:
        raise ConfigError(f"{path}: lists and tables are nested too deep; no option needs that") from error


_HEADER = re.compile(r"\s*\[\s*([\w-]+)\s*\]")
_KEY = re.compile(r"\s*([\w-]+)\s*=")


def _places(text: str, path: Path | None) -> dict[str, str]:
    """Where every "table.key", "table" and top-level key stands: file and line."""
    places: dict[str, str] = {}
    table = ""
    for number, line in enumerate(text.splitlines(), start=1):
        place = f"{path}, line {number}"
        if header := _HEADER.match(line):
            table = header[1]
            places.setdefault(table, place)
        elif key := _KEY.match(line):
            places.setdefault(f"{table}.{key[1]}".lstrip("."), place)
    return places


def parsed_override(text: str) -> tuple[str, str, Any]:
    """Table, key and value of "TABLE.KEY=VALUE"; see `Config.load`. Raises ConfigError for any other text."""
    name, equals, value = text.partition("=")
    table, dot, key = name.strip().partition(".")
    if not (equals and dot and table and key):
        raise ConfigError(f"--set {shown(text, 100)}: write TABLE.KEY=VALUE, such as basis.size=200")
    return table, key, _toml_value(value.strip())


def _toml_value(text: str) -> Any:
    """The value that a text is in TOML, or the text itself where it is none or more than one."""
    try:
        found = tomllib.loads(f"value = {text}")
    except tomllib.TOMLDecodeError:
        return text
    except ValueError as error:  # numbers of thousands of digits
        raise ConfigError(f"--set …={text[:20]}…: {error}") from error
    except RecursionError as error:
        raise ConfigError(f"--set …={text[:20]}…: lists and tables are nested too deep") from error
    return found["value"] if len(found) == 1 else text


def require_table(name: str, known: Sequence[str], places: Mapping[str, str]) -> None:
    """Raise ConfigError unless a table of this name is known."""
    if name not in known:
        place = place_of(name, places)
        raise ConfigError(
            f"{place}no table named '{shown(name, 100)}'; allowed: {', '.join(known)}.{did_you_mean(name, known)}"
        )


def _table(tables: Mapping[str, Any], name: str, places: Mapping[str, str]) -> Mapping[str, Any]:
    table = tables.get(name, {})
    if not isinstance(table, Mapping):
        raise ConfigError(f"{place_of(name, places)}'{name}' must be a table; write [{name}] above its keys")
    return table


def _step(table: str, given: Mapping[str, Any], places: Mapping[str, str]) -> Step:
    kind, key, default = STEPS[table]
    name = checked_value(str, given.get(key, default), f"{table}.{key}", places)
    return Step(kind, name, {option: value for option, value in given.items() if option != key})


def _require_option_of_kind(table: str, step: Step, registry: Registry, places: Mapping[str, str]) -> None:
    known = {STEPS[table][1]: None, **({} if step.name in ("mesh", "none") else _options_of_kind(step.kind, registry))}
    for key in step.options:
        require_known(key, known, table, places)


def _options_of_kind(kind: str, registry: Registry) -> dict[str, Option]:
    """The options of all components of a kind that can be loaded."""
    found: dict[str, Option] = {}
    for component in registry.components(kind):
        with suppress(PluginError):
            found |= {option.name: option for option in options_of(registry.load(kind, component.name))}
    return found
