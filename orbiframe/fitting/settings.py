"""Settings: the keywords of `fit` in Python, as a configuration."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from orbiframe.components.suggestion import did_you_mean
from orbiframe.errors import UsageError
from orbiframe.fitting.config import STEPS, TABLES, Config
from orbiframe.fitting.written_config import tables_of

# The keywords that are no tables: table and key of each. They are called as on the command line.
SHORT = {
    "size": ("basis", "size"),
    "tolerance": ("output", "tolerance"),
    "max_error": ("output", "max_error"),
    "refine": ("output", "refine"),
    "boundary": ("mesh", "boundary"),
    "like": ("map", "like"),
}
_SELECTORS = {table: selector for table, (_, selector, _) in STEPS.items()} | {"data": "means"}
_FAST: dict[str, dict[str, Any]] = {"fitter": {"name": "least-squares"}, "data": {"lift": False}}


def configured(config: Config | None, settings: Mapping[str, Any]) -> Config:
    """A configuration, by default that of an empty file, with other settings.

    settings: `size`, `tolerance`, `max_error`, `refine`, `boundary`, `like`; a table by its name, `basis="ps2"` for
    the component that it names or `basis={"name": "ps2", "size": 300}` for several keys; `fast=True` for the linear fit
    on one map. None leaves a setting as it is. Raises UsageError for an unknown keyword, ConfigError for a value of a
    wrong type.
    """
    given = {key: value for key, value in settings.items() if value is not None}
    if not given:
        return Config.from_tables({}) if config is None else config
    base = Config.from_tables({}) if config is None else config
    tables, places = tables_of(base), dict(base.places)
    for keyword, value in given.items():
        for table, keys in _changes(keyword, value).items():
            tables[table] |= keys
            places |= {f"{table}.{key}": f"fit({keyword}={value!r})" for key in keys}
    return replace(Config.from_tables(tables, places=places), plugins=base.plugins)


def _changes(keyword: str, value: Any) -> dict[str, dict[str, Any]]:
    """The keys that a keyword of `fit` sets, table by table."""
    if keyword == "fast":
        return dict(_FAST) if value else {}
    if keyword in SHORT:
        table, key = SHORT[keyword]
        return {table: {key: value}}
    if keyword not in TABLES:
        known = (*SHORT, "fast", *TABLES)
        raise UsageError(f"fit has no keyword '{keyword}'; it has {', '.join(known)}.{did_you_mean(keyword, known)}")
    if isinstance(value, Mapping):
        return {keyword: dict(value)}
    if keyword not in _SELECTORS:
        raise UsageError(f"fit({keyword}={value!r}): give a dictionary of keys, such as {keyword}={{'refine': 4}}")
    return {keyword: {_SELECTORS[keyword]: value}}
