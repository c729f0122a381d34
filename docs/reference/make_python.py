"""Writes docs/reference/python.md, the public names of orbiframe: `python docs/reference/make_python.py`."""

from __future__ import annotations

import ast
import inspect
import re
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path

import orbiframe

PAGE = Path(__file__).with_name("python.md")
CHAIN = (
    "planes meshes words orbifolds groups triangulations delaunay functions splines surfaces components files fitting"
)
KERNEL = Path(orbiframe.__file__).parent
HEAD = """# Names in Python

What may be imported, and stays: the top facade for those who fit meshes, and one facade for each folder for those who
write plugins or study groups. All else may change without notice. Each name is imported on first use, so that
`import orbiframe` is quick. `help(name)` shows the whole text of what is summed up here.

This page is made by `python docs/reference/make_python.py`; a test fails when it and the code differ.
"""


def facades() -> list[str]:
    """The modules that are public, the top one first, then in the order of the chain."""
    known = [f"orbiframe.{folder}" for folder in CHAIN.split()]
    found = [f"orbiframe.{path.parent.name}" for path in KERNEL.glob("*/__init__.pyi")]
    return ["orbiframe", *known, *sorted(set(found) - set(known))]


def names_of(facade: str) -> list[str]:
    """The names in the list of a facade, sorted."""
    path = KERNEL.joinpath(*facade.split(".")[1:], "__init__.pyi")
    imports = [node for node in ast.parse(path.read_text()).body if isinstance(node, ast.ImportFrom)]
    return sorted((alias.name for node in imports for alias in node.names), key=lambda name: (name.islower(), name))


def text_of(facade: str, name: str) -> str:
    """What a name says of itself: the docstring of a class or function, the comment above anything else."""
    thing = inspect.unwrap(getattr(import_module(facade), name))
    if inspect.isclass(thing) or inspect.isroutine(thing) or inspect.ismodule(thing):
        return inspect.getdoc(thing) or ""
    lines = source_of(facade, name).read_text(encoding="utf-8").splitlines()
    at = next(k for k, line in enumerate(lines) if re.match(rf"{name}\b.*=", line))
    first = at
    while lines[first - 1].startswith("# "):
        first -= 1
    return " ".join(line.removeprefix("# ") for line in lines[first:at])


def source_of(facade: str, name: str) -> Path:
    """The file from which a facade takes a name."""
    folder = KERNEL.joinpath(*facade.split(".")[1:])
    nodes = ast.parse((folder / "__init__.pyi").read_text()).body
    found = (node for node in nodes if isinstance(node, ast.ImportFrom) and name in {a.name for a in node.names})
    return folder.joinpath(*(next(found).module or "").split(".")).with_suffix(".py")


def summary(facade: str, name: str) -> str:
    """The first sentence of what a name says of itself."""
    first = " ".join(text_of(facade, name).split("\n\n")[0].split())
    return first.replace("|", "\\|")


def lines() -> Iterator[str]:
    """The page, line by line."""
    yield HEAD
    for facade in facades():
        yield f"## {facade}\n"
        yield (import_module(facade).__doc__ or "").splitlines()[0] + "\n"
        yield "| name | what it is |\n| --- | --- |"
        yield from (f"| `{name}` | {summary(facade, name)} |" for name in names_of(facade))
        yield ""


def page() -> str:
    """The whole page."""
    return "\n".join(lines()).rstrip() + "\n"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
