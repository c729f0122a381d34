"""Make config.md from what the components say of their options: `python docs/reference/make_config.py`."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path

from orbiframe_studies.study_keys import TABLE_MEANINGS as STUDY_MEANINGS, keys as study_keys

from orbiframe import Registry
from orbiframe.fitting import ConfigKey, config_keys
from orbiframe.fitting.config import STEPS
from orbiframe.fitting.keys import TABLE_MEANINGS
from orbiframe.fitting.mapping import PARAMETRIZER
from orbiframe.plugin import DEFAULT_MARKER, OPEN_NAMES

PAGE = Path(__file__).with_name("config.md")

INTRO = """# Configuration

*Made by [make_config.py](make_config.py) from the explanations that the components carry: `orbiframe config init`
writes them as comments of a file, `orbiframe config schema` as a schema for editors.*

A configuration is a TOML file with ten tables, all of them optional, and a list of plugin files. The options of
a table are those of the component that it names; `orbiframe plugins --options` prints them. On the command
line, `--set TABLE.KEY=VALUE` sets one; VALUE is read as TOML, and as text where it is none. In Python,
`Config.load(path, {"basis.size": 300})` does. An unknown key or name is refused at once, with the nearest one.

```toml title="all.toml"
plugins = []            # Python files with components, relative to this file

[mesh]
format = "auto"         # a reader; auto: by the suffix

[geometry]
name = "auto"           # the plane X; auto: by the Euler characteristic

[group]
method = "mesh"         # found from the mesh

[map]
method = "auto"         # a parametrizer; auto: by the sign of the Euler characteristic
weights = "auto"

[shape]
method = "regular-faces"  # an optimizer; none: the map stays as it is
group = "auto"
area = 0.0

[data]
means = "auto"          # or smooth, semi-smooth, facets
lift = true

[basis]
name = "gaussian"
size = 500
width = 1.7

[fitter]
name = "sliding"
fairing = 1e-4
steps = 3

[output]
refine = 10
```

```console
$ orbiframe config check all.toml
all.toml: a configuration
$ orbiframe fit datasets/cube.off -o smooth.ply --config all.toml --set basis.size=100 --quiet
$ orbiframe config init -o commented.toml
$ orbiframe config schema -o schema.json
```

An editor that knows JSON Schema for TOML (Even Better TOML, Taplo) checks and completes while one types, with the line
`#:schema schema.json` at the top of the file.
"""

LINKS = {
    "mesh": "See [formats](formats.md).",
    "group": "See [choose the group](../how_to/choose_group.md).",
    "shape": "See [square-like faces](../how_to/square_faces.md).",
    "basis": "See [choose a basis](../how_to/choose_basis.md).",
    "fitter": "See [fields](../how_to/fields.md) for smoothing.",
}

STUDY = """## Studies

A file with a table `[study]` is a study: the tables above say what all its fits have in common, and these what is
varied. See [experiments](../how_to/experiments.md).
"""

LIMITS = """## Limits

What would take days or all memory is refused with its number, before any work is done; the status is 2.

| what | limit |
|---|---|
| `basis.size` | 1 to 100 000 functions |
| `output.refine` | 4 000 000 triangles in all, or those of the input |
| `basis.degree` | up to 15, of `dms` up to 10 |
| numbers | finite, of at most 77 digits |
| lists and tables within one another | 20 deep |
| a configuration or study file | 1 MB, a regular file |
| a plugin file | 16 MB |

In Python, `surface.tessellate(density)` makes meshes of any size.
"""


def page() -> str:
    """The whole page."""
    keys = list(config_keys(Registry.discover()))
    parts = [INTRO, *(_section(table, keys) for table in TABLE_MEANINGS), _others(keys), *_studies(), LIMITS]
    return "\n".join(parts)


def _section(table: str, keys: list[ConfigKey]) -> str:
    """The keys of a table, with the options of the components that are taken if nothing is said."""
    shown = [key for key in keys if key.table == table and (not key.component or key.component in _taken(table))]
    names = dict.fromkeys(key.name for key in shown)
    rows = [_row(table, [key for key in shown if key.name == name]) for name in names]
    text = " ".join(filter(None, [TABLE_MEANINGS[table], LINKS.get(table)]))
    extra = _options_of_bases(keys) if table == "basis" else ""
    return f"## {table}\n\n{text}\n\n{_table(('key', 'default', 'meaning'), rows)}{extra}"


def _taken(table: str) -> list[str]:
    default = STEPS.get(table, ("", "", ""))[2]
    choices = {"map": list(PARAMETRIZER.values()), "marking": [DEFAULT_MARKER]}
    return choices.get(table, [] if default in OPEN_NAMES else [default])


def _row(table: str, keys: list[ConfigKey]) -> tuple[str, ...]:
    default = str(keys[0].default)
    default = default.lower() if table in ("data", "output") else default
    meaning = "; ".join(dict.fromkeys(key.meaning for key in keys))
    choices = ", ".join(name for name in keys[0].choices if name not in OPEN_NAMES)
    names = f"; installed: {choices}" if choices else ""
    return f"`{keys[0].name}`", default if default == "none" else f"`{default}`", f"{meaning}{names}"


def _options_of_bases(keys: list[ConfigKey]) -> str:
    rows = [_option(key) for key in keys if key.table == "basis" and key.component and key.name != "size"]
    text = "Every basis has `size`. What else they have:"
    return f"\n### Options of the bases\n\n{text}\n\n{_table(('basis', 'key', 'default', 'meaning'), rows)}"


def _option(key: ConfigKey) -> tuple[str, ...]:
    return f"`{key.component}`", f"`{key.name}`", f"`{key.default}`", key.meaning


def _others(keys: list[ConfigKey]) -> str:
    rows = [
        (f"`{key.table}`", *_option(key))
        for key in keys
        if key.component and key.component not in _taken(key.table) and key.table != "basis"
    ]
    heads = ("table", "component", "key", "default", "meaning")
    return f"## Options of other components\n\n{_table(heads, rows)}"


def _studies() -> Iterator[str]:
    yield STUDY
    for table in ("study", "until", "search"):
        rows = [
            (f"`{name.partition('.')[2]}`", "required" if name in _REQUIRED else f"`{default}`", text)
            for name, _, default, text in study_keys()
            if name.startswith(f"{table}.")
        ]
        yield f"### {table}\n\n{STUDY_MEANINGS[table]}\n\n{_table(('key', 'default', 'meaning'), rows)}"
    for table in ("sweep", "case"):
        yield f"### {table}\n\n{STUDY_MEANINGS[table]}\n"


_REQUIRED = ("study.meshes", "until.below", "search.trials", "search.space")


def _table(heads: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    heads = list(heads)
    lines = [heads, ["---"] * len(heads), *rows]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines).replace("| --- ", "|---").replace("--- |", "---|")


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
