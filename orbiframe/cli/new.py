"""orbiframe new: the beginning of a plugin, as a package that installs and is found."""

from __future__ import annotations

import argparse
import importlib.util
import keyword
import re
import sys
from importlib.resources import files
from pathlib import Path
from string import Template

from orbiframe.components.registry import Registry
from orbiframe.errors import UsageError
from orbiframe.plugin import KINDS, OPEN_NAMES

# The kinds whose target is a class, and what the target of others is called.
_CLASSES = ("geometry", "basis", "fitter")
_FUNCTIONS = {
    "reader": "read",
    "writer": "write",
    "exporter": "export",
    "elements": "write",
    "picture": "draw",
    "command": "configure",
}
_OF_FILES = ("reader", "writer", "exporter", "elements", "picture")
_NAME = re.compile(r"[a-z][a-z0-9]*([-_][a-z0-9]+)*")
# A reader is tried on files that a function of the test writes, a writer on what one reads.
_COUNTERPART = {
    "reader": ("write", "path, polyhedron", "Write a file of the format, for the laws; a few lines will do."),
    "writer": ("read", "path", "Read a file of the format, for the laws; a few lines will do."),
}


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    things = parser.add_subparsers(metavar="plugin", title="what to begin", required=True)
    text = "a package with one component, which installs, is found, and has a test of its laws to be met"
    plugin = things.add_parser("plugin", help=text, description=text)
    plugin.add_argument("name", metavar="NAME", help="name of the package and of its component, such as wavelets")
    plugin.add_argument("--kind", choices=KINDS, required=True, help="kind of the component")
    plugin.add_argument("--suffix", metavar=".X", help="suffix of its files, of kinds that read or make files")
    plugin.add_argument("--folder", type=Path, default=Path(), help="where to make the folder NAME; default here")
    plugin.set_defaults(run=run)
    parser.set_defaults(run=run)


def run(args: argparse.Namespace, registry: Registry) -> int:
    """Write the package and say what to do next."""
    words = _words(args.name, args.kind, args.suffix, registry)
    folder = args.folder / args.name
    if folder.exists():
        raise UsageError(f"{folder} is there already; choose another name, or another --folder")
    for path, text in package(words).items():
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / path).write_text(text, encoding="utf-8")
    module, kind = words["module"], words["kind"]
    print(f"{folder}: write {module}/{kind}.py until its laws hold, then say what it is in {module}/plugin.py")
    print(f'  python -m pip install -e "{folder}"')
    print(f"  orbiframe plugins check {kind}/{args.name}")
    print(f"  python -m pytest {folder}")
    return 0


def package(words: dict[str, str]) -> dict[str, str]:
    """The files of a package, path by path, for the words that `_words` gives."""
    module, kind = words["module"], words["kind"]
    test = _filled("test", words)
    if kind in _COUNTERPART:
        name, arguments, meaning = _COUNTERPART[kind]
        function = f'def {name}({arguments}):\n    """{meaning}"""\n    raise NotImplementedError\n\n\n'
        test = test.replace(f"test_{module} =", f"\n{function}test_{module} =")
    return {
        "pyproject.toml": _skeleton("pyproject.toml", words),
        "README.md": _skeleton("README.md", words),
        f"{module}/__init__.py": "",
        f"{module}/plugin.py": _filled("plugin", words),
        f"{module}/{kind}.py": _filled(kind, words),
        f"tests/test_{module}.py": test,
    }


def _filled(name: str, words: dict[str, str]) -> str:
    return _skeleton(f"{name}.py", words)


def _skeleton(name: str, words: dict[str, str]) -> str:
    return Template((files("orbiframe.cli") / "skeletons" / f"{name}.txt").read_text(encoding="utf-8")).substitute(
        words
    )


def _words(name: str, kind: str, suffix: str | None, registry: Registry) -> dict[str, str]:
    """What is filled into the skeletons. Raises UsageError for a name that cannot be used."""
    module = name.replace("-", "_")
    _require_free(name, module, kind, registry)
    if suffix is not None and kind not in _OF_FILES:
        raise UsageError(f"--suffix {suffix}: a {kind} has no files; leave it out")
    suffix = "." + (suffix or name.replace("_", "-")).lstrip(".").lower()
    return {
        "name": name,
        "module": module,
        "kind": kind,
        "target": _target(kind, module),
        "suffixes": f', suffixes=("{suffix}",)' if kind in _OF_FILES else "",
        "more": _more(kind, suffix),
    }


def _target(kind: str, module: str) -> str:
    """The name of the class or function that does the work."""
    if kind in _CLASSES:
        return "".join(word.capitalize() for word in module.split("_"))
    return _FUNCTIONS.get(kind, f"{module}_{kind}")


def _more(kind: str, suffix: str) -> str:
    """The keywords of `contract_tests` for a kind."""
    if kind == "basis":
        return ', params={"size": 40}'
    if kind not in _OF_FILES:
        return ""
    other = f", counterpart={_COUNTERPART[kind][0]}" if kind in _COUNTERPART else ""
    return f', suffix="{suffix}"{other}'


def _require_free(name: str, module: str, kind: str, registry: Registry) -> None:
    """Raise UsageError for a name that is none, or that a module or a component has already."""
    if not _NAME.fullmatch(name) or keyword.iskeyword(module) or name in OPEN_NAMES:
        raise UsageError(f"'{name}' is no name for a package; take small letters, digits and '-', such as my-{kind}")
    if module in sys.stdlib_module_names or importlib.util.find_spec(module) is not None:
        raise UsageError(f"a Python module named '{module}' is installed already; choose another name")
    if name in {component.name for component in registry.components(kind)}:
        raise UsageError(f"there is a {kind} named '{name}' already; choose another name")
