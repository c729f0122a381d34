"""Every public name says what it is, and the examples in docstrings are true."""

from __future__ import annotations

import doctest
import inspect
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path

import pytest
from documents import ROOT, module_of

import orbiframe

MADE = module_of(ROOT / "docs" / "reference" / "make_python.py")
PUBLIC = [(facade, name) for facade in MADE.facades() for name in MADE.names_of(facade)]
# These are used most; all others may have an example too.
EXEMPLARY = [
    *("Basis", "Component", "Config", "FundamentalPolygon", "Geometry", "Group", "Orbifold", "OrbifoldSurface"),
    *("Polyhedron", "Registry", "Result", "SurfaceType", "Triangulation", "Word"),
    *("fit", "read", "save_surface", "surface_type", "write"),
]
KINDS = (property, classmethod, staticmethod)


def thing(facade: str, name: str) -> object:
    return getattr(import_module(facade), name)


def own_members(owner: type) -> Iterator[str]:
    """The methods and properties that a class of the project defines under a name without underscore."""
    for name, member in vars(owner).items():
        if not name.startswith("_") and (inspect.isroutine(member) or isinstance(member, KINDS)):
            yield name


def undocumented(facade: str, name: str) -> list[str]:
    found = thing(facade, name)
    missing = [] if MADE.text_of(facade, name) else [name]
    if inspect.isclass(found) and found.__module__.startswith("orbiframe"):
        missing += [f"{name}.{m}" for m in own_members(found) if not inspect.getdoc(getattr(found, m))]
    return missing


def test_every_public_name_and_its_methods_say_what_they_are():
    assert [missing for facade, name in PUBLIC for missing in undocumented(facade, name)] == []


def test_what_says_nothing_is_noticed(monkeypatch):
    class Silent:
        def method(self): ...

        @property
        def value(self): ...

    Silent.__module__ = "orbiframe.silent"
    monkeypatch.setattr(orbiframe, "Silent", Silent, raising=False)
    assert undocumented("orbiframe", "Silent") == ["Silent", "Silent.method", "Silent.value"]


def test_what_is_used_most_has_an_example():
    assert [
        name
        for name in EXEMPLARY
        if ">>>" not in (inspect.getdoc(thing("orbiframe.fitting" if name == "Result" else "orbiframe", name)) or "")
    ] == []


EXAMPLES = list({id(thing(*where)): where for where in PUBLIC if ">>>" in (thing(*where).__doc__ or "")}.values())


@pytest.mark.long
@pytest.mark.parametrize(("facade", "name"), EXAMPLES, ids=lambda text: text)
def test_examples_are_true(facade, name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    found = thing(facade, name)
    tests = [t for t in doctest.DocTestFinder(recurse=False).find(found, name, globs={}) if t.examples]
    assert tests, Path(inspect.getfile(found))
    for test in tests:
        report: list[str] = []
        assert doctest.DocTestRunner().run(test, out=report.append).failed == 0, "".join(report)
