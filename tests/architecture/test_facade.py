from __future__ import annotations

import ast
import subprocess
import sys
from importlib import import_module
from pathlib import Path
from types import ModuleType

import pytest

import orbiframe

KERNEL = Path(orbiframe.__file__).parent
FACADES = [path.parent for path in sorted(KERNEL.rglob("__init__.pyi"))]


def listed(folder: Path) -> list[str]:
    """The names in the list of a facade."""
    tree = ast.parse((folder / "__init__.pyi").read_text())
    return sorted(alias.name for node in tree.body if isinstance(node, ast.ImportFrom) for alias in node.names)


def facade(folder: Path) -> ModuleType:
    return import_module(".".join(["orbiframe", *folder.relative_to(KERNEL).parts]))


@pytest.mark.parametrize("folder", FACADES, ids=lambda folder: folder.name)
def test_every_public_name_has_a_home_and_a_docstring(folder):
    module = facade(folder)
    assert sorted(module.__all__) == listed(folder)
    for name in listed(folder):
        assert getattr(module, name).__doc__ or name == "hookimpl", name
        assert name in dir(module)


def test_the_top_facade_is_small():
    assert len(listed(KERNEL)) <= 36


def test_an_unknown_name_is_an_attribute_error():
    with pytest.raises(AttributeError, match="Polyhedra"):
        orbiframe.Polyhedra  # noqa: B018


def test_the_version_is_that_of_the_distribution():
    from importlib.metadata import version

    assert orbiframe.__version__ == version("orbiframe")


def test_importing_the_facade_loads_nothing_heavy():
    code = "import sys, orbiframe; print(sorted({'numpy', 'scipy', 'pluggy', 'pydantic'} & set(sys.modules)))"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout == "[]\n"


def test_a_public_name_is_not_hidden_by_a_module_of_the_same_name():
    """Importing a module sets an attribute of its package: a public name of the same spelling would change meaning."""
    for folder in FACADES:
        names = {path.stem for path in folder.iterdir() if path.suffix == ".py" or path.is_dir()}
        assert not names & set(listed(folder)), folder
