"""Study keys: what every key of a study means, for the reference page, the schema and the commented default."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from orbiframe import Registry
from orbiframe.components import options_of
from orbiframe.fitting import config_schema, config_template, toml_value
from orbiframe_studies.study import Search, Settings, Until

MEANINGS = {
    "study.meshes": "files or patterns such as '**/*.obj', relative to this file, or datasets such as dataset:torus",
    "study.name": "name of the study; if not given, that of the file",
    "study.seeds": "every fit is done once for each; they go to components with an option seed, and to the noise",
    "study.noise": "normal noise on each coordinate of the vertices, of this size relative to the diagonal of the box",
    "study.keep": "what is kept of each fit beside its row: arrays (HDF5), surface (.npz), mesh (.ply)",
    "study.maps": "kept: maps to X/H are kept for other fits of the mesh; none: they are not; auto: if it has several",
    "study.memory": "GB that one process may take; a fit that needs more is recorded as lost",
    "until.below": "what the measure has to fall to",
    "until.key": "the key that grows",
    "until.start": "its first value",
    "until.factor": "by which it grows from fit to fit",
    "until.most": "its largest value",
    "until.measure": "what is watched: fit.rms or fit.max",
    "search.trials": "how many fits in all, for each mesh and case",
    "search.space": "keys, each with a list of values or as {low = 1, high = 3}, with log = true where the logarithm "
    "counts",
    "search.batch": "how many are tried before the next are chosen; these may run at once",
    "search.seed": "of the choice",
    "search.measure": "what is to be small: fit.rms or fit.max",
}
TABLE_MEANINGS = {
    "study": "Many fits: every mesh, with every case, with every combination of the sweep, for every seed.",
    "sweep": "Lists of values for any keys of the configuration; every combination is fitted.",
    "case": "A named set of options.",
    "until": "A key grows until an error is small enough.",
    "search": "optuna looks for the values with the least error.",
}
_TABLES = {"study": Settings, "until": Until, "search": Search}
_EXAMPLE = """
# Lists of values for any keys of the configuration; every combination is fitted.
[sweep]
# basis.name = ["gaussian", "ps2"]
# basis.size = [100, 200, 400]

# A named set of options; any number of them.
# [[case]]
# name = "wide"
# basis.width = 2.5
"""


def keys() -> Iterator[tuple[str, Any, Any, str]]:
    """Every key of the tables [study], [until] and [search]: its name, type, default and meaning."""
    for table, options in _TABLES.items():
        for option in options_of(options):
            name = f"{table}.{option.name}"
            yield name, option.annotation, None if option.required else option.default, MEANINGS[name]


def study_template(registry: Registry) -> str:
    """A study with all keys and their defaults as TOML, each explained in a comment."""
    first, _, rest = config_template(registry).partition("\n\n")
    lines: list[str] = []
    for table in _TABLES:
        mark = "" if table == "study" else "# "
        lines += ["", f"# {TABLE_MEANINGS[table]}", f"{mark}[{table}]", *_key_lines(table)]
        lines += _EXAMPLE.rstrip().splitlines() if table == "study" else []
    return "\n".join([first, *lines, "", rest])


def _key_lines(table: str) -> Iterator[str]:
    for name, _, default, meaning in keys():
        if name.startswith(f"{table}."):
            given = name == "study.meshes"
            free = not given and (table != "study" or default is None)
            value = '["*.obj"]' if given else toml_value(default)
            yield f"# {meaning}"
            yield f"{'# ' if free else ''}{name.partition('.')[2]} = {value}"


def study_schema(registry: Registry) -> dict[str, Any]:
    """The JSON Schema of configurations and studies."""
    found = config_schema(registry)
    tables = found["properties"]
    free = {name: table for name, table in tables.items() if name != "plugins"}
    lists = {name: {**table, "properties": _lists(table["properties"])} for name, table in free.items()}
    own = {table: _table(table) for table in _TABLES}
    case = {"type": "object", "properties": {"name": {"type": "string"}, **free}, "required": ["name"]}
    more = {
        "sweep": {"type": "object", "description": TABLE_MEANINGS["sweep"], "properties": lists},
        "case": {"type": "array", "description": TABLE_MEANINGS["case"], "items": case},
    }
    return {**found, "title": "orbiframe configuration or study", "properties": {**own, **more, **tables}}


def _lists(properties: dict[str, Any]) -> dict[str, Any]:
    return {key: {"type": "array", "minItems": 1, "items": form} for key, form in properties.items()}


def _table(table: str) -> dict[str, Any]:
    from pydantic import TypeAdapter

    options = {option.name: option for option in options_of(_TABLES[table])}
    properties = {}
    for name, option in options.items():
        form = TypeAdapter(option.annotation).json_schema()
        kept = [each for each in form.get("anyOf", []) if each.get("type") != "null"]
        form = kept[0] if len(kept) == 1 else form
        properties[name] = {**form, "description": MEANINGS[f"{table}.{name}"]}
    required = [name for name, option in options.items() if option.required]
    return {
        "type": "object",
        "description": TABLE_MEANINGS[table],
        "properties": properties,
        "required": required,
        "additionalProperties": False,
    }
