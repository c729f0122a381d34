"""Config schema: the keys of a configuration as a JSON Schema, by which editors complete and check."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from orbiframe.components.registry import Registry
from orbiframe.fitting.keys import PLUGINS_MEANING, TABLE_MEANINGS, ConfigKey, config_keys

Schema = dict[str, Any]


def config_schema(registry: Registry) -> Schema:
    """The JSON Schema (draft 2020-12) of configuration files for the components of a registry.

    Which options a component takes is checked by `Config.load` alone: here a table has those of all its components.
    """
    keys = list(config_keys(registry))
    tables = {
        table: _table([key for key in keys if key.table == table], text) for table, text in TABLE_MEANINGS.items()
    }
    plugins = {"type": "array", "items": {"type": "string"}, "description": PLUGINS_MEANING}
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "orbiframe configuration",
        "type": "object",
        "properties": {"plugins": plugins, **tables},
        "additionalProperties": False,
    }


def _table(keys: list[ConfigKey], meaning: str) -> Schema:
    names = list(dict.fromkeys(key.name for key in keys))
    properties = {name: _merged([key for key in keys if key.name == name]) for name in names}
    return {"type": "object", "description": meaning, "properties": properties, "additionalProperties": False}


def _merged(keys: list[ConfigKey]) -> Schema:
    """The schema of a key that several components may have: what any of them takes."""
    forms = _distinct(_form(key) for key in keys)
    meanings = "; ".join(_meanings(keys))
    found = forms[0] if len(forms) == 1 else {"anyOf": forms}
    defaults = _distinct(key.default for key in keys)
    default = {"default": defaults[0]} if len(defaults) == 1 and defaults[0] is not None else {}
    return {**found, **({"description": meanings} if meanings else {}), **default}


def _meanings(keys: list[ConfigKey]) -> list[str]:
    """What a key means; where that differs, with the component before it."""
    found = _distinct(key.meaning for key in keys if key.meaning)
    if len(found) < 2:
        return found
    return [m if m.startswith(key.component) else f"{key.component}: {m}" for key in keys if (m := key.meaning)]


def _form(key: ConfigKey) -> Schema:
    from pydantic import TypeAdapter

    if key.choices:
        return {"type": "string", "enum": list(key.choices)}
    found: Schema = TypeAdapter(key.annotation).json_schema()
    return _without_null(found)


def _without_null(form: Schema) -> Schema:
    """TOML has no null: a key that may be None is left out."""
    kept = [each for each in form.get("anyOf", []) if each.get("type") != "null"]
    rest = {name: value for name, value in form.items() if name != "anyOf"}
    if not kept:
        return form
    return {**rest, **kept[0]} if len(kept) == 1 else {**rest, "anyOf": kept}


def _distinct(values: Iterable[Any]) -> list[Any]:
    found: list[Any] = []
    for value in values:
        if value not in found:
            found.append(value)
    return found
