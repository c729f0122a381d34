"""What `orbiframe new plugin` writes is found at once, and keeps no law of its kind before it is written."""

from __future__ import annotations

import sys
import tomllib
from importlib import import_module

import pytest

from orbiframe.components.registry import Registry
from orbiframe.plugin import KINDS
from orbiframe.testing import component_laws, laws_of
from orbiframe.testing.check import check


@pytest.fixture
def forgotten():
    """Modules that a test imports are forgotten afterwards."""
    before = set(sys.modules)
    yield
    for name in set(sys.modules) - before:
        if name.startswith("brand_new"):
            del sys.modules[name]


@pytest.mark.usefixtures("forgotten")
@pytest.mark.parametrize("kind", KINDS)
def test_a_beginning_is_found_and_keeps_no_law_yet(kind, orbiframe, tmp_path, monkeypatch):
    ran = orbiframe("new", "plugin", "brand-new", "--kind", kind, "--folder", tmp_path)
    assert ran.status == 0
    folder = tmp_path / "brand-new"
    assert f"plugins check {kind}/brand-new" in ran.out
    entry = tomllib.loads((folder / "pyproject.toml").read_text())["project"]["entry-points"]["orbiframe"]
    assert entry == {"brand_new": "brand_new.plugin"}
    monkeypatch.syspath_prepend(folder)
    registry = Registry()
    registry.register("brand_new", import_module(entry["brand_new"]))
    (component,) = registry.components(kind)
    assert component.name == "brand-new"
    verdicts = {verdict.law.split()[0]: verdict for verdict in check(component, registry)}
    for law in component_laws.LAWS:
        assert verdicts[law.__name__].error is None, verdicts[law.__name__]
    kept = [law.__name__ for law in laws_of(kind).laws if _holds(verdicts[law.__name__])]
    assert kept == []
    test = (folder / "tests" / "test_brand_new.py").read_text()
    compile(test, "test_brand_new.py", "exec")
    assert f'test_brand_new = contract_tests("{kind}", ' in test


def _holds(verdict) -> bool:
    return verdict.error is None and verdict.untried is None


@pytest.mark.parametrize(
    ("name", "kind", "said"),
    [
        ("Bad Name!", "basis", "is no name for a package; take small letters"),
        ("auto", "basis", "is no name for a package"),
        ("class", "basis", "is no name for a package"),
        ("numpy", "basis", "a Python module named 'numpy' is installed already"),
        ("ps2", "basis", "there is a basis named 'ps2' already"),
    ],
)
def test_a_name_that_cannot_be_used_is_refused(name, kind, said, orbiframe, tmp_path):
    ran = orbiframe("new", "plugin", name, "--kind", kind, "--folder", tmp_path)
    assert ran.status == 2
    assert said in ran.err
    assert list(tmp_path.iterdir()) == []


def test_nothing_is_written_over(orbiframe, tmp_path):
    (tmp_path / "brand-new").mkdir()
    ran = orbiframe("new", "plugin", "brand-new", "--kind", "basis", "--folder", tmp_path)
    assert ran.status == 2
    assert "is there already" in ran.err
    assert list((tmp_path / "brand-new").iterdir()) == []


def test_a_suffix_is_for_files(orbiframe, tmp_path):
    ran = orbiframe("new", "plugin", "brand-new", "--kind", "basis", "--suffix", ".x", "--folder", tmp_path)
    assert ran.status == 2
    assert "a basis has no files" in ran.err
