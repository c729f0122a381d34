"""Config: which component does each step of a fit, and with which options."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import asdict, dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

from annotated_types import Ge, Gt, Le

from orbiframe.components.options import Option, checked_options, checked_value, options_of, place_of, require_known
from orbiframe.components.registry import Registry
from orbiframe.errors import ConfigError, PluginError, UsageError
from orbiframe.fitting.config_text import Overrides, override_items, read_tables, require_table, table_of
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


# A point that the surface passes through, alone or with its normal; a coefficient that is moved by hand.
Fixed = tuple[float, float, float] | tuple[float, float, float, float, float, float]
Moved = tuple[Annotated[int, Ge(0)], float, float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class Output:
    """What to make of the surface.

    refine: every triangle of the mesh becomes refine^2 triangles, None for as many as a fine picture needs; tolerance
    and max_error: the largest root mean square and the largest distance allowed, relative to the diagonal of the
    bounding box, None for a fixed size; uv: whether the mesh gets texture coordinates; moved: coefficients moved by
    hand after the fit, each as the number of its function and x, y, z in lengths of the mesh.
    """

    refine: Annotated[int, Ge(1)] | None = None
    tolerance: Annotated[float, Gt(0)] | None = None
    max_error: Annotated[float, Gt(0)] | None = None
    uv: bool = False
    moved: tuple[Moved, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Data:
    """What the mesh means.

    means: "facets", the polyhedron is the truth; "smooth", its vertices lie on a smooth surface; "semi-smooth", so they
    do where facets are curved; "auto" decides by its bends. lift: whether a smooth mesh whose facets show is mapped
    again after it has been lifted onto its first surface. noise: the root mean square error of each coordinate of the
    vertices of a smooth mesh, relative to the diagonal of the bounding box; None: found from the vertices. creases:
    edges that bend by so many degrees or more stay sharp, or "marked", those that the file marks; None: none does.
    fixed: points in space (x, y, z) that the surface passes through, or (x, y, z, nx, ny, nz) with a normal that it has
    there, up to the sign; each at the nearest point of the mesh.
    """

    means: Literal["auto", "smooth", "semi-smooth", "facets"] = "auto"
    lift: bool = True
    noise: Annotated[float, Gt(0)] | None = None
    creases: Annotated[float, Gt(0), Le(180)] | Literal["marked"] | None = None
    fixed: tuple[Fixed, ...] = ()


# What to do with the boundary of a mesh, in the table of the mesh.
Boundary = Literal["error", "cap", "collar", "double", "auto"]

# The basis if nothing is said and creases are kept.
CREASED_BASIS = "clough-tocher"

# Table of the configuration: the kind of its component, the key that names it, and the name if nothing is said.
STEPS = {
    "mesh": ("reader", "format", "auto"),
    "geometry": ("geometry", "name", "auto"),
    "group": ("group", "method", "mesh"),
    "marking": ("marker", "method", "auto"),
    "map": ("parametrizer", "method", "auto"),
    "shape": ("optimizer", "method", "none"),
    "solver": ("solver", "name", "auto"),
    "basis": ("basis", "name", "gaussian"),
    "fitter": ("fitter", "name", "sliding"),
}
TABLES = (*STEPS, "data", "output")
# The tables that say how a map is made.
_OF_MAPS = ("geometry", "group", "marking", "map", "shape")


@dataclass(frozen=True, slots=True)
class Config:
    """A fit in words: a step for each of the tables of `STEPS`, the output, what the mesh means, plugin files.

    mesh: the reader, "auto" by the file suffix; geometry: the plane X, "auto" by the Euler characteristic; group:
    "mesh" takes the group from the mesh; marking: cuts the mesh open for a named group; map: "auto" takes the
    parametrizer that fits the geometry and the group; shape: changes the map so that faces become regular, "none"
    leaves it as it is; solver: what solves the equations of
    maps, "auto" what the parametrizer does; basis; fitter. boundary: how a mesh with a boundary is closed for the map,
    "error" if it is not.
    like: a saved surface whose map is taken over. places: where each "table.key" was written, for error messages.
    NAMES: of all tables.

    >>> from orbiframe import Config
    >>> config = Config.load(overrides={"basis": {"name": "ps2", "size": 200}})
    >>> config.basis.name, config.basis.options["size"], config.map.name
    ('ps2', 200, 'auto')
    """

    NAMES: ClassVar[tuple[str, ...]] = TABLES

    steps: Mapping[str, Step]
    output: Output = field(default_factory=Output)
    data: Data = field(default_factory=Data)
    plugins: tuple[Path, ...] = ()
    places: Mapping[str, str] = field(default_factory=dict)
    boundary: Boundary = "error"
    like: Path | None = None

    @classmethod
    def load(cls, path: Path | None = None, overrides: Overrides = (), registry: Registry | None = None) -> Config:
        """The configuration of a TOML file (None: all defaults) with overrides, checked.

        overrides: texts "TABLE.KEY=VALUE", where a VALUE is read as TOML, and as text where it is none; or a
        dictionary, {"basis.size": 300} or {"basis": {"size": 300}}. registry: what the configuration is checked
        against, by default all that is installed; the plugin files of the configuration, relative to the folder of the
        file, are added to it. Raises ConfigError for text that is not TOML, unknown tables, unknown names and options
        with the nearest one that is known, and values of a wrong type; PluginError for a plugin that cannot be loaded.
        """
        config = cls.parsed(path, overrides)
        registry = Registry.discover() if registry is None else registry
        for file in config.plugins:
            registry.add_file(file)
        return config.checked(registry)

    @classmethod
    def parsed(cls, path: Path | None = None, overrides: Overrides = ()) -> Config:
        """The configuration as `load` reads it; names and options are checked when `checked` or `fit` get it."""
        tables, places = ({}, {}) if path is None else read_tables(path)
        for table, key, value, place in override_items(overrides):
            places[f"{table}.{key}"] = place
            require_table(table, TABLES, {table: place})
            tables[table] = {**table_of(tables, table, places), key: value}
        return cls.from_tables(tables, places=places, folder=Path() if path is None else path.parent)

    @classmethod
    def from_tables(
        cls, tables: Mapping[str, Any], *, places: Mapping[str, str] | None = None, folder: Path = Path()
    ) -> Config:
        """The configuration that a TOML file with these tables says; see `load`."""
        places = dict(places or {})
        for table in tables:
            require_table(table, (*TABLES, "plugins"), places)
        files = checked_value(tuple[str, ...], tables["plugins"], "plugins", places) if "plugins" in tables else ()
        output = Output(**checked_options(Output, table_of(tables, "output", places), "output", places))
        data = Data(**checked_options(Data, table_of(tables, "data", places), "data", places))
        if data.creases is not None:
            tables = {**tables, "basis": {"name": CREASED_BASIS, **table_of(tables, "basis", places)}}
        mesh = dict(table_of(tables, "mesh", places))
        boundary = checked_value(Boundary, mesh.pop("boundary", "error"), "mesh.boundary", places)
        map_ = dict(table_of(tables, "map", places))
        like = checked_value(str | None, map_.pop("like", None), "map.like", places)
        tables = {**tables, "mesh": mesh, "map": map_}
        steps = {table: _step(table, table_of(tables, table, places), places) for table in STEPS}
        return cls(steps, output, data, tuple(folder / file for file in files), places, boundary, like and Path(like))

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
    def solver(self) -> Step:
        """What solves the equations of maps."""
        return self.steps["solver"]

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

    def resolved(self, registry: Registry) -> dict[str, dict[str, Any]]:
        """Every option that a fit will use, as plain data: those given, and the defaults of the others.

        Of an open step there is what is given; the number of functions is None where the shape decides.
        """
        found = {table: self._resolved(table, registry) for table in STEPS}
        if "size" in found["basis"]:
            found["basis"]["size"] = self.basis.options.get("size")
        found["mesh"]["boundary"] = self.boundary
        found["map"]["like"] = None if self.like is None else str(self.like)
        return {**found, "data": asdict(self.data), "output": asdict(self.output)}

    def _resolved(self, table: str, registry: Registry) -> dict[str, Any]:
        step = self.steps[table]
        if step.open:
            return {STEPS[table][1]: step.name, **step.options}
        target = self._loaded(table, registry, step.name)
        defaults = {option.name: option.default for option in options_of(target) if not option.required}
        given = checked_options(target, step.options, table, self.places, STEPS[table][1])
        return {STEPS[table][1]: step.name, **defaults, **given}

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
        if self.data.creases is not None:
            _require_creased(self.basis.name, registry, self.places)
        if self.like is not None:
            _require_no_other_map(self)
        return self


def _require_creased(name: str, registry: Registry, places: Mapping[str, str]) -> None:
    """Raise ConfigError for functions that are smooth everywhere."""
    if getattr(registry.load("basis", name), "crease_unknowns", None) is not None:
        return
    known = []
    for component in registry.components("basis"):
        with suppress(PluginError):
            if getattr(registry.load("basis", component.name), "crease_unknowns", None) is not None:
                known.append(component.name)
    raise ConfigError(
        f"{place_of('basis.name', places)}the functions '{name}' keep no creases (data.creases); those that do: "
        f"{', '.join(known)}"
    )


def _require_no_other_map(config: Config) -> None:
    """Raise ConfigError where a map is taken over, and how one is made is said too."""
    for table in _OF_MAPS:
        step = config.steps[table]
        if not step.open or step.options:
            key = next(iter(step.options), STEPS[table][1])
            place = place_of(f"{table}.{key}" if step.open else f"{table}.{STEPS[table][1]}", config.places)
            raise ConfigError(
                f"{place}the map of {config.like} is taken over (map.like), so that [{table}] has no say; leave out "
                "one of them"
            )


def _step(table: str, given: Mapping[str, Any], places: Mapping[str, str]) -> Step:
    kind, key, default = STEPS[table]
    name = checked_value(str, given.get(key, default), f"{table}.{key}", places)
    return Step(kind, name, {option: value for option, value in given.items() if option != key})


def _require_option_of_kind(table: str, step: Step, registry: Registry, places: Mapping[str, str]) -> None:
    own = {"mesh": {"boundary": None}, "map": {"like": None}}.get(table, {})
    known = {
        STEPS[table][1]: None,
        **own,
        **({} if step.name in ("mesh", "none") else _options_of_kind(step.kind, registry)),
    }
    for key in step.options:
        require_known(key, known, table, places)


def _options_of_kind(kind: str, registry: Registry) -> dict[str, Option]:
    """The options of all components of a kind that can be loaded."""
    found: dict[str, Option] = {}
    for component in registry.components(kind):
        with suppress(PluginError):
            found |= {option.name: option for option in options_of(registry.load(kind, component.name))}
    return found
