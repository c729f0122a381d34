"""Configuration text: TOML with the place of every key, and overrides of single options."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from orbiframe.components.options import place_of
from orbiframe.components.shown_text import shown
from orbiframe.components.suggestion import did_you_mean
from orbiframe.errors import ConfigError, FormatError
from orbiframe.files.places import require_readable

_LARGEST_FILE = 2**20

# Options in place of those of a file: texts "TABLE.KEY=VALUE", or a dictionary of "TABLE.KEY" or of tables.
Overrides = Iterable[str] | Mapping[str, Any]


def read_tables(path: Path) -> tuple[dict[str, Any], dict[str, str]]:
    """The tables of a TOML file, and where every "table.key", "table" and top-level key stands: file and line.

    A saved surface that the tables name is relative to the folder of the file. Raises ConfigError for a file that
    cannot be read or is not TOML.
    """
    text = _read(path)
    return _beside(_parsed(text, path), path.parent), _places(text, path)


def _beside(tables: dict[str, Any], folder: Path) -> dict[str, Any]:
    """The tables of a file, with the saved surface that they name relative to its folder."""
    like = tables["map"].get("like") if isinstance(tables.get("map"), Mapping) else None
    return tables if not isinstance(like, str) else tables | {"map": {**tables["map"], "like": str(folder / like)}}


def override_items(overrides: Overrides) -> Iterator[tuple[str, str, Any, str]]:
    """Table, key, value and place of every override, in their order. Raises ConfigError for what is none."""
    if isinstance(overrides, str):
        raise ConfigError(f"overrides = {shown(overrides, 100)!r}: give a list of texts, or a dictionary")
    for item in _flat(overrides) if isinstance(overrides, Mapping) else overrides:
        if isinstance(item, str):
            yield *parsed_override(item), f"--set {shown(item, 100)}"
        else:
            yield item


def _flat(overrides: Mapping[str, Any]) -> Iterator[tuple[str, str, Any, str]]:
    for name, value in overrides.items():
        table, dot, key = str(name).partition(".")
        if dot and table and key:
            yield table, key, value, f"the override {shown(str(name), 100)}"
        elif isinstance(value, Mapping):
            for inner, own in value.items():
                yield table, str(inner), own, f"the override {shown(f'{name}.{inner}', 100)}"
        else:
            raise ConfigError(f"the override '{shown(str(name), 100)}': write TABLE.KEY, such as basis.size")


def _read(path: Path) -> str:
    try:
        require_readable(path, _LARGEST_FILE, empty=True)
        return path.read_text(encoding="utf-8-sig")
    except (FormatError, OSError, UnicodeDecodeError) as error:
        raise ConfigError(f"the configuration {path} cannot be read: {error}") from error


def _parsed(text: str, path: Path) -> dict[str, Any]:
    try:
        return tomllib.loads(text)
    except ValueError as error:  # also for numbers of thousands of digits
        raise ConfigError(f"{path} is not TOML: {error}") from error
    except RecursionError as error:
        raise ConfigError(f"{path}: lists and tables are nested too deep; no option needs that") from error


_HEADER = re.compile(r"\s*\[{1,2}\s*([\w.-]+)\s*\]")
_KEY = re.compile(r"\s*\"?([\w.-]+)\"?\s*=")


def _places(text: str, path: Path) -> dict[str, str]:
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


def table_of(tables: Mapping[str, Any], name: str, places: Mapping[str, str]) -> Mapping[str, Any]:
    """The table of a name, empty if it is not there. Raises ConfigError for another value of that name."""
    table = tables.get(name, {})
    if not isinstance(table, Mapping):
        raise ConfigError(f"{place_of(name, places)}'{name}' must be a table; write [{name}] above its keys")
    return table
