"""Study file: a TOML file becomes a study; what is wrong in it is refused before any work."""

from __future__ import annotations

import glob
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from orbiframe import Config, ConfigError, FormatError
from orbiframe.components import checked_options, did_you_mean, place_of, shown
from orbiframe.files import located
from orbiframe.fitting import Overrides, override_items, read_tables, require_table, table_of
from orbiframe_studies.study import Case, Search, Settings, Study, Until

TABLES = ("study", "sweep", "case", "until", "search")
MOST_MESHES = 10_000_000


def read_study(path: Path, overrides: Overrides = ()) -> Study:
    """The study of a TOML file, with overrides of the options that all its fits have in common.

    Raises ConfigError for a file that cannot be read, unknown tables and keys with the nearest one, values of a wrong
    type, patterns without a file, and keys that are set twice.
    """
    tables, places = read_tables(path)
    if "study" not in tables:
        raise ConfigError(f"{path}: this is no study, there is no table [study]; write [study] with meshes = [...]")
    given = set()
    for table, key, value, place in override_items(overrides):
        places[f"{table}.{key}"] = place
        tables[table] = {**table_of(tables, table, places), key: value}
        given.add(f"{table}.{key}")
    for name in tables:
        require_table(name, (*TABLES, *Config.NAMES, "plugins"), places)
    settings = Settings(**checked_options(Settings, table_of(tables, "study", places), "study", places))
    common = {name: value for name, value in tables.items() if name not in TABLES}
    config = Config.from_tables(common, places=places, folder=path.parent)
    study = Study(
        path,
        settings,
        tuple(_meshes(settings.meshes, path.parent, places)),
        {name: value for name, value in common.items() if name != "plugins"},
        _sweep(table_of(tables, "sweep", places), places),
        tuple(_cases(tables.get("case", []), places)),
        _until(tables, places),
        _search(tables, places),
        config.plugins,
        places,
    )
    _require_single(study, given)
    _require_seeds(study)
    return study


def with_mapping(tables: Mapping[str, Any], options: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
    """Tables of a configuration with other options, "table.key" to value."""
    found = {name: dict(table) for name, table in tables.items()}
    for name, value in options.items():
        table, _, key = name.partition(".")
        found.setdefault(table, {})[key] = value
    return found


def _meshes(patterns: tuple[str, ...], folder: Path, places: Mapping[str, str]) -> Iterator[Path]:
    """The files of the patterns: in their order, those of one sorted by name, each once."""
    seen: set[Path] = set()
    for pattern in patterns:
        found = sorted(glob.glob(str(folder / _located(pattern, places)), recursive=True))
        if not found and not glob.has_magic(pattern):
            siblings = [p.name for p in (folder / pattern).parent.glob("*")]
            near = did_you_mean(Path(pattern).name, siblings)
            raise ConfigError(f"{place_of('study.meshes', places)}there is no mesh {folder / pattern}.{near}")
        if not found:
            raise ConfigError(f"{place_of('study.meshes', places)}no file is like '{pattern}' in {folder}")
        files = [path for path in map(Path, found) if path.is_file()]
        if not files:
            raise ConfigError(f"{place_of('study.meshes', places)}{found[0]} is no regular file; name meshes")
        yield from (path for path in files if path not in seen)
        seen.update(files)


def _located(pattern: str, places: Mapping[str, str]) -> Path:
    """The file of a dataset, dataset:torus and the like; any other pattern as it is."""
    try:
        return located(pattern)
    except FormatError as error:
        raise ConfigError(f"{place_of('study.meshes', places)}{error}") from error


def _flat(table: Mapping[str, Any], title: str, places: Mapping[str, str]) -> Iterator[tuple[str, Any]]:
    """Every "table.key" of nested tables with its value."""
    for name, value in table.items():
        if isinstance(value, Mapping):
            yield from ((f"{name}.{key}", own) for key, own in value.items())
        elif "." in name:
            yield name, value
        else:
            raise ConfigError(
                f"{place_of(f'{title}.{name}', places)}[{title}] has '{shown(name, 100)}'; write TABLE.KEY, such as "
                "basis.size"
            )


def _sweep(table: Mapping[str, Any], places: Mapping[str, str]) -> dict[str, tuple[Any, ...]]:
    found = {}
    for name, values in _flat(table, "sweep", places):
        _require_config_key(name, "sweep", places)
        if not isinstance(values, list) or not values:
            raise ConfigError(
                f"{place_of(f'sweep.{name}', places)}sweep.{name} = {shown(repr(values), 100)}: a list of values is "
                "required, such as [100, 200]"
            )
        if any(values.count(value) > 1 for value in values[:1000]):
            raise ConfigError(f"{place_of(f'sweep.{name}', places)}sweep.{name} has a value twice; leave out one")
        found[name] = tuple(values)
    return found


def _require_config_key(name: str, title: str, places: Mapping[str, str]) -> None:
    table, _, key = name.partition(".")
    if table not in Config.NAMES or not key or "." in key:
        near = did_you_mean(table, Config.NAMES)
        raise ConfigError(
            f"{place_of(f'{title}.{name}', places)}[{title}] has '{shown(name, 100)}', but the tables of a "
            f"configuration are {', '.join(Config.NAMES)}.{near}"
        )


def _cases(given: Any, places: Mapping[str, str]) -> Iterator[Case]:
    if not isinstance(given, list) or not all(isinstance(each, Mapping) for each in given):
        raise ConfigError(f"{place_of('case', places)}cases are written as [[case]], each with a name")
    names: set[str] = set()
    for number, table in enumerate(given, start=1):
        name = table.get("name")
        if not isinstance(name, str) or not name:
            raise ConfigError(f"case {number} has no name; write name = '...' under [[case]]")
        if name in names:
            raise ConfigError(f"two cases are named '{shown(name, 100)}'; give each a name of its own")
        names.add(name)
        options = dict(_flat({key: value for key, value in table.items() if key != "name"}, "case", places))
        for key in options:
            _require_config_key(key, "case", places)
        yield Case(name, options)


def _until(tables: Mapping[str, Any], places: Mapping[str, str]) -> Until | None:
    if "until" not in tables:
        return None
    found = Until(**checked_options(Until, table_of(tables, "until", places), "until", places))
    _require_config_key(found.key, "until", places)
    if found.most < found.start:
        raise ConfigError(f"{place_of('until.most', places)}until.most = {found.most} is below the start {found.start}")
    return found


def _search(tables: Mapping[str, Any], places: Mapping[str, str]) -> Search | None:
    if "search" not in tables:
        return None
    found = Search(**checked_options(Search, table_of(tables, "search", places), "search", places))
    space = dict(_space(found.space, places))
    if not space:
        raise ConfigError(f"{place_of('search', places)}[search] needs a space: basis.width = {{low = 1, high = 3}}")
    return replace(found, space=space)


def _space(space: Mapping[str, Any], places: Mapping[str, str]) -> Iterator[tuple[str, Any]]:
    nested = (
        (f"{table}.{key}", value)
        for table, keys in space.items()
        for key, value in (keys.items() if isinstance(keys, Mapping) else [("", keys)])
    )
    for name, value in nested:
        _require_config_key(name.rstrip("."), "search.space", places)
        yield name, value if isinstance(value, list) and value else _span(name, value, places)


def _span(name: str, value: Any, places: Mapping[str, str]) -> dict[str, Any]:
    """Low and high, both whole or both not, and whether the logarithm counts."""
    fits = isinstance(value, Mapping) and {"low", "high"} <= set(value) <= {"low", "high", "log"}
    numbers = [value["low"], value["high"]] if fits else []
    if not fits or any(isinstance(each, bool) or not isinstance(each, int | float) for each in numbers):
        raise ConfigError(
            f"{place_of(f'search.space.{name}', places)}search.space.{name} = {shown(repr(value), 100)}: a list of "
            "values is required, or {low = 1, high = 3}, with log = true where the logarithm counts"
        )
    if not numbers[0] < numbers[1] or (value.get("log") and numbers[0] <= 0):
        raise ConfigError(f"search.space.{name}: low must be below high, and above 0 for log = true")
    return dict(value)


def _require_single(study: Study, given: set[str]) -> None:
    """Raise ConfigError where one key is set in two ways, of which only one could win; given: by overrides."""
    owners = {key: study.places[key] for key in given if key.partition(".")[0] in Config.NAMES}
    parts = [("[sweep]", study.sweep), ("[search]", study.search.space if study.search else {})]
    parts += [("[until]", {study.until.key: None} if study.until else {})]
    parts += [("[[case]]", {key: None for case in study.cases for key in case.options})]
    for owner, keys in parts:
        for key in keys:
            if key in owners:
                raise ConfigError(f"{key} is set by {owners[key]} and by {owner}; leave it to one of them")
            owners[key] = owner
    if study.until and study.search:
        raise ConfigError("a study has [until] or [search], not both; make two studies")


def _require_seeds(study: Study) -> None:
    seeds, noise = study.settings.seeds, study.settings.noise
    if len(set(seeds)) < len(seeds):
        raise ConfigError(f"{place_of('study.seeds', study.places)}study.seeds has a number twice; leave out one")
    if noise is not None and not seeds:
        raise ConfigError(f"{place_of('study.noise', study.places)}study.noise needs seeds, such as seeds = [0, 1, 2]")
