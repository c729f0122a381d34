from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

import orbiframe


@pytest.mark.parametrize("name", orbiframe.__all__)
def test_every_public_name_has_a_home_and_a_docstring(name):
    value = getattr(orbiframe, name)
    assert value.__doc__ or name == "hookimpl"
    assert name in dir(orbiframe)


def test_an_unknown_name_is_an_attribute_error():
    with pytest.raises(AttributeError, match="no attribute 'Polyhedra'"):
        orbiframe.Polyhedra  # noqa: B018


def test_the_version_is_that_of_the_distribution():
    from importlib.metadata import version

    assert orbiframe.__version__ == version("orbiframe")


def test_importing_the_facade_loads_nothing_heavy():
    code = "import sys, orbiframe; print(sorted({'numpy', 'scipy', 'pluggy', 'pydantic'} & set(sys.modules)))"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout == "[]\n"


def test_type_checkers_see_the_same_names():
    tree = ast.parse(Path(orbiframe.__file__).with_suffix(".pyi").read_text())
    imports = [node for node in tree.body if isinstance(node, ast.ImportFrom)]
    assert sorted(alias.name for node in imports for alias in node.names) == orbiframe.__all__


def test_a_public_name_is_not_hidden_by_the_module_of_the_same_name():
    """Whichever of the two is imported first."""
    code = "import orbiframe.delaunay.site_triangulation; from orbiframe import delaunay; assert callable(delaunay)"
    subprocess.run([sys.executable, "-c", code], check=True)
