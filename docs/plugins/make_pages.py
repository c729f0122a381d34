"""Writes the pages of the kinds of components, docs/plugins/KIND.md: `python docs/plugins/make_pages.py`."""

from __future__ import annotations

import ast
import textwrap
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from orbiframe.plugin import KINDS
from orbiframe.testing import component_laws, laws_of
from orbiframe.testing.kit import statement

HERE = Path(__file__).parent
EXAMPLES = HERE.parent / "examples"
KNOWN: dict[str, dict[str, Any]] = tomllib.loads((HERE / "kinds.toml").read_text(encoding="utf-8"))


def page(kind: str) -> str:
    """The page of one kind."""
    return "\n".join(lines(kind, KNOWN[kind])).rstrip() + "\n"


def lines(kind: str, known: dict[str, Any]) -> Iterator[str]:
    """The page of a kind, line by line."""
    yield f"# {kind.capitalize()}\n"
    yield filled(
        f"Called as `{known['called']}`; gives {known['gives']}. Whatever else the target takes is keyword-only, with "
        "a type and a default, and comes from the configuration. Begin with `orbiframe new plugin NAME --kind "
        f"{kind}`, as in [the tutorial](../tutorials/first_plugin.md). This page is made by "
        "`python docs/plugins/make_pages.py`."
    )
    yield "## What it is given\n"
    yield known["passes"].strip() + "\n"
    yield f"## How it is asked for\n\n{known['use']}\n"
    yield "## Names\n\nThe example below imports; [all names](../reference/python.md) have a sentence each:\n"
    yield "| from | names |\n|---|---|"
    yield from (f"| `{module}` | {', '.join(f'`{name}`' for name in names)} |" for module, names in imports(known))
    yield "\n## Laws\n"
    yield f'`orbiframe plugins check {kind}/NAME` and `contract_tests("{kind}", TARGET)` try them:\n'
    yield "| law | what it says |\n|---|---|"
    for law in (*laws_of(kind).laws, *component_laws.LAWS):
        yield f"| `{law.__name__}` | {statement(law).replace('|', chr(92) + '|')} |"
    for file in known["files"]:
        yield "\n## Example\n\n" + filled(f"[{Path(file).name}](../examples/{file}){_home(file)}")
        yield f"```py\n{(EXAMPLES / file).read_text(encoding='utf-8')}```"


def filled(text: str) -> str:
    """A paragraph in lines of 120 letters."""
    return textwrap.fill(text, 120, break_long_words=False, break_on_hyphens=False) + "\n"


def _home(file: str) -> str:
    package = file.split("/")[0]
    if package == "single_files":
        return ", a plugin in one file:"
    return f", of the distribution [{package}](../examples/{package}/README.md):"


def imports(known: dict[str, Any]) -> list[tuple[str, list[str]]]:
    """What the example imports from orbiframe, module by module."""
    found: dict[str, set[str]] = {}
    for file in known["files"]:
        for node in ast.walk(ast.parse((EXAMPLES / file).read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and (node.module or "").partition(".")[0] == "orbiframe":
                found.setdefault(str(node.module), set()).update(alias.name for alias in node.names)
    return [(module, sorted(names)) for module, names in sorted(found.items())]


if __name__ == "__main__":
    for each in KINDS:
        (HERE / f"{each}.md").write_text(page(each), encoding="utf-8")
