"""Written configuration: the tables and the TOML text of a configuration, which load as the same one."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

from orbiframe.fitting.config import STEPS, TABLES, Config
from orbiframe.fitting.template import toml_value

Tables = dict[str, dict[str, Any]]


def tables_of(config: Config) -> Tables:
    """The tables that a file of this configuration has, `plugins` apart; keys without a value are left out."""
    steps: Tables = {table: {STEPS[table][1]: step.name, **step.options} for table, step in config.steps.items()}
    steps["mesh"]["boundary"] = config.boundary
    steps["map"]["like"] = None if config.like is None else str(config.like)
    found = steps | {"output": asdict(config.output), "data": asdict(config.data)}
    return {table: {key: value for key, value in keys.items() if value is not None} for table, keys in found.items()}


def config_toml(config: Config) -> str:
    """The TOML text of a configuration: what differs from that of an empty file; plugin files by their whole paths."""
    plain, tables = tables_of(Config.from_tables({})), tables_of(config)
    plugins = [str(Path(file).resolve()) for file in config.plugins]
    parts = [f"plugins = {toml_value(plugins)}\n"] if plugins else []
    for table in TABLES:
        lines = [f"{key} = {toml_value(value)}\n" for key, value in _changed(tables[table], plain[table])]
        parts += [f"[{table}]\n{''.join(lines)}"] if lines else []
    return "\n".join(parts)


def _changed(keys: Mapping[str, Any], plain: Mapping[str, Any]) -> list[tuple[str, Any]]:
    return [(key, value) for key, value in keys.items() if key not in plain or plain[key] != value]
