"""Writes docs/reference/components.md, all components that come with orbiframe, from the registry and signatures.

`python docs/reference/make_components.py`.
"""

from __future__ import annotations

from collections.abc import Iterator
from inspect import Parameter
from pathlib import Path

from orbiframe import Component, Registry
from orbiframe.components import options_of
from orbiframe.plugin import KINDS

PAGE = Path(__file__).with_name("components.md")
HEAD = """# Components

All that comes with orbiframe, kind by kind; what is installed here, with plugins of others, `orbiframe plugins` lists.
The commands of the kernel itself are on [their page](cli.md). A name in the first column is what a configuration or an
option of the command line takes. The options are keyword arguments, with their defaults; what they mean stands in
[configuration](config.md) and behind `orbiframe plugins --options`. The pages of the
[kinds](../how_to/write_a_plugin.md) say how to add one.

This page is made by `python docs/reference/make_components.py`; a test fails when it and the code differ.
"""


def options(registry: Registry, component: Component) -> str:
    """The options of a component and their defaults, as they are written in TOML or Python.

    Solvers have none, and that of an extra need not be installed.
    """
    if component.kind in ("command", "picture", "solver"):
        return ""
    found = options_of(registry.load(component.kind, component.name))
    return ", ".join(f"`{o.name}`" if o.default is Parameter.empty else f"`{o.name}={o.default}`" for o in found)


def lines() -> Iterator[str]:
    """The page, line by line."""
    yield HEAD
    registry = Registry.discover()
    for kind in KINDS:
        if components := registry.components(kind):
            yield f"## {kind.capitalize()}\n\n| name | what it is | options |\n| --- | --- | --- |"
            for component in sorted(components, key=lambda c: c.name):
                summary = component.summary.replace("|", "\\|")
                yield f"| `{component.name}` | {summary} | {options(registry, component)} |"
            yield ""


def page() -> str:
    """The whole page."""
    return "\n".join(lines()).rstrip() + "\n"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
