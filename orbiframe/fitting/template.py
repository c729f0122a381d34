"""Config template: all keys with their defaults as TOML, each explained in a comment."""

from __future__ import annotations

import json
import textwrap
from collections.abc import Iterator
from typing import Any

from orbiframe.components.registry import Registry
from orbiframe.fitting.config import STEPS
from orbiframe.fitting.keys import PLUGINS_MEANING, TABLE_MEANINGS, ConfigKey, config_keys
from orbiframe.fitting.mapping import PARAMETRIZER

_WIDTH = 100


def config_template(registry: Registry) -> str:
    """A configuration that says what is so anyway: every table, and every option of the default components.

    Keys without a default, and those of components that are chosen later, are comments; the text can be loaded.
    """
    keys = list(config_keys(registry))
    lines = [*_comment(PLUGINS_MEANING), "plugins = []"]
    for table, meaning in TABLE_MEANINGS.items():
        lines += ["", *_comment(meaning), f"[{table}]"]
        for key in keys:
            if key.table == table and _shown(key):
                lines += _key_lines(key)
    return "\n".join(lines) + "\n"


def _shown(key: ConfigKey) -> bool:
    """Whether a key is of the table itself, or of a component that is taken if nothing is said."""
    taken = {"map": PARAMETRIZER.values(), "marking": ["tree-cotree"]}.get(key.table, [STEPS.get(key.table, [""])[-1]])
    return not key.component or key.component in taken


def _key_lines(key: ConfigKey) -> Iterator[str]:
    yield from _comment(key.meaning)
    if key.choices:
        yield from _comment("one of: " + ", ".join(key.choices))
    free = key.component and STEPS[key.table][2] != key.component
    commented = free or key.default is None or key.name == "size"
    yield f"{'# ' if commented else ''}{key.name} = {toml_value(key.default)}"


def toml_value(value: Any) -> str:
    """A value as TOML writes it; what has none, as `...`."""
    if value is None:
        return "..."
    if isinstance(value, float):
        return repr(value)
    if isinstance(value, tuple | list):
        return f"[{', '.join(map(toml_value, value))}]"
    return json.dumps(value, ensure_ascii=False)


def _comment(text: str) -> list[str]:
    return [f"# {line}" for line in textwrap.wrap(text, _WIDTH)]
