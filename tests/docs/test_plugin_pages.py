"""The page of each kind of component is what the code says, and its example keeps the laws."""

from __future__ import annotations

import importlib.util

import pytest
from documents import ROOT

from orbiframe.components.registry import Registry
from orbiframe.plugin import KINDS
from orbiframe.testing.check import check

FOLDER = ROOT / "docs" / "plugins"
SINGLE = ROOT / "docs" / "examples" / "single_files"


def maker():
    spec = importlib.util.spec_from_file_location("make_pages", FOLDER / "make_pages.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_every_kind_has_its_page():
    made = maker()
    assert list(made.KNOWN) == list(KINDS)
    for kind in KINDS:
        assert (FOLDER / f"{kind}.md").read_text() == made.page(kind), "run python docs/plugins/make_pages.py"


def test_what_a_page_names_is_public():
    made = maker()
    for kind in KINDS:
        for module, names in made.imports(made.KNOWN[kind]):
            public = importlib.import_module(module)
            assert module in ("orbiframe", "orbiframe.plugin") or module.count(".") == 1, module
            assert all(hasattr(public, name) for name in names)


@pytest.mark.long
@pytest.mark.parametrize("file", sorted(SINGLE.glob("*.py")), ids=lambda file: file.stem)
def test_an_example_of_one_file_keeps_the_laws_of_its_kind(file):
    registry = Registry.discover()
    registry.add_file(file)
    (component,) = [found for found, owner in registry.declarations() if owner == str(file)]
    assert [verdict for verdict in check(component, registry) if verdict.error or verdict.untried] == []
