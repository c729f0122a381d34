"""Plugins are found through real package metadata, made up in a temporary folder on the path."""

from __future__ import annotations

import math
import pickle
import sys
from pathlib import Path
from textwrap import dedent

import pytest

from orbiframe.components.registry import Registry
from orbiframe.errors import PluginError, UsageError
from orbiframe.plugin import Component, hookimpl

PLUGIN = """
from orbiframe.plugin import Component, hookimpl
@hookimpl
def orbiframe_components():
    return [Component("basis", "{name}", "{target}", "a basis for a test")]
"""


@pytest.fixture
def install(tmp_path, monkeypatch):
    """Install a made-up distribution: a module with its text, and its entry point."""
    monkeypatch.syspath_prepend(tmp_path)
    before = set(sys.modules)

    def installed(module: str, text: str, entry: str | None = None) -> None:
        (tmp_path / f"{module}.py").write_text(dedent(text))
        info = tmp_path / f"{module}-1.0.dist-info"
        info.mkdir()
        (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {module}\nVersion: 1.0\n")
        (info / "entry_points.txt").write_text(f"[orbiframe]\n{entry or module} = {module}\n")

    yield installed
    for name in set(sys.modules) - before:
        del sys.modules[name]


class Declares:
    """A plugin that declares what it is given."""

    def __init__(self, *components: object) -> None:
        self.components = components

    @hookimpl
    def orbiframe_components(self):
        return self.components


def registry_of(*components: object) -> Registry:
    registry = Registry()
    registry.register("test", Declares(*components))
    return registry


def test_declarations_stand_in_the_order_of_a_fit_then_by_name_then_by_plugin():
    registry = Registry()
    fitter, basis, other = (
        Component(kind, name, "math:sin", "for a test")
        for kind, name in (("fitter", "a"), ("basis", "b"), ("geometry", "c"))
    )
    registry.register("second", Declares(fitter, basis))
    registry.register("first", Declares(Component("basis", "a", "math:sin", "for a test"), basis, other))
    found = [(c.kind, c.name, owner) for c, owner in registry.declarations()]
    assert found == [
        ("geometry", "c", "first"),
        ("basis", "a", "first"),
        ("basis", "b", "first"),
        ("basis", "b", "second"),
        ("fitter", "a", "second"),
    ]


def test_our_own_plugins_are_found_and_none_is_broken():
    registry = Registry.discover()
    assert registry.broken == []
    assert [c.name for c in registry.components("geometry")] == ["e2", "h2", "s2"]
    assert registry.load("geometry", "h2")().curvature == -1


def test_a_stranger_is_found_by_its_entry_point(install):
    install("stranger", PLUGIN.format(name="wavelet", target="math:sqrt"))
    registry = Registry.discover(only=["stranger"])
    assert [c.name for c in registry.components("basis")] == ["wavelet"]
    assert registry.load("basis", "wavelet")(9) == 3
    assert [owner for _, owner in registry.declarations()] == ["stranger"]


def test_discovery_imports_no_target(install):
    install("lazy", PLUGIN.format(name="late", target="colorsys:rgb_to_hsv"))
    sys.modules.pop("colorsys", None)
    registry = Registry.discover(only=["lazy"])
    assert "colorsys" not in sys.modules
    registry.load("basis", "late")
    assert "colorsys" in sys.modules


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("1 / 0", "ZeroDivisionError"),
        ("import no_such_package_anywhere", "no_such_package_anywhere"),
        ("import sys; sys.exit(3)", "SystemExit"),
        ("x = (", "SyntaxError"),
        ("x = 1", "declares no hook"),
        (PLUGIN.format(name="a", target="no-colon"), "package.module:object"),
        (PLUGIN.format(name="a", target="a:b").replace('"basis"', '"bases"'), "unknown kind"),
        (PLUGIN.format(name="a", target="a:b").replace("[Component", "['text', Component"), "must return Components"),
        ("from orbiframe.plugin import hookimpl\n@hookimpl\ndef orbiframe_components(wrong): return []", "wrong"),
    ],
)
def test_a_broken_plugin_is_reported_and_the_others_live(install, text, said):
    install("broken_one", text)
    install("sound_one", PLUGIN.format(name="sound", target="math:sqrt"))
    registry = Registry.discover(only=["broken_one", "sound_one"])
    assert [c.name for c in registry.components("basis")] == ["sound"]
    ((name, error),) = registry.broken
    assert name == "broken_one"
    assert said in error


def test_two_plugins_of_one_name_are_both_loaded(install):
    install("first", PLUGIN.format(name="one", target="math:sqrt"), entry="same")
    install("second", PLUGIN.format(name="two", target="math:sqrt"), entry="same")
    registry = Registry.discover(only=["same"])
    assert registry.broken == []
    assert [(c.name, owner) for c, owner in registry.declarations()] == [("one", "same"), ("two", "second:same")]


def test_the_environment_restricts(install, monkeypatch):
    install("wanted", PLUGIN.format(name="one", target="math:sqrt"))
    monkeypatch.setenv("ORBIFRAME_PLUGINS", " wanted, geometries ")
    assert {owner for _, owner in Registry.discover().declarations()} == {"wanted", "geometries"}
    monkeypatch.setenv("ORBIFRAME_PLUGINS", "")
    assert Registry.discover().declarations() == []
    monkeypatch.setenv("ORBIFRAME_PLUGINS", "wantde")
    with pytest.raises(UsageError, match=r"no plugin named 'wantde'.*Did you mean 'wanted'"):
        Registry.discover()


def test_an_unknown_name_gets_the_nearest_one():
    registry = registry_of(*(Component("basis", name, "math:sqrt", "") for name in ("gaussian", "bernstein")))
    with pytest.raises(UsageError) as caught:
        registry.component("basis", "gausian")
    assert str(caught.value) == "no basis named 'gausian'; installed: bernstein, gaussian. Did you mean 'gaussian'?"
    with pytest.raises(UsageError, match="no fitter named 'x'; installed: none"):
        registry.component("fitter", "x")


def test_a_name_declared_twice_names_both_plugins():
    registry = registry_of(Component("basis", "gaussian", "math:sqrt", ""))
    registry.register("other", Declares(Component("basis", "gaussian", "math:cos", "")))
    with pytest.raises(PluginError, match=r"'gaussian'.*'test' and 'other'"):
        registry.load("basis", "gaussian")


@pytest.mark.parametrize(
    ("target", "extra", "said"),
    [
        ("no_such_package_anywhere.part:f", None, 'pip install "no_such_package_anywhere"'),
        ("no_such_package_anywhere.part:f", "orbiframe[open3d]", 'pip install "orbiframe[open3d]"'),
        ("orbiframe.no_such_module:f", "orbiframe[open3d]", "cannot be imported from 'orbiframe.no_such_module:f'"),
        ("math:no_such_function", None, "no_such_function"),
        ("math:pi", None, "cannot be called"),
    ],
)
def test_a_target_that_cannot_be_imported_says_what_to_do(target, extra, said):
    registry = registry_of(Component("basis", "b", target, "", extra))
    with pytest.raises(PluginError) as caught:
        registry.load("basis", "b")
    assert said in str(caught.value)
    assert "basis 'b'" in str(caught.value)


def test_a_plugin_file_needs_no_packaging(tmp_path):
    path = tmp_path / "my_own_basis.py"
    path.write_text(PLUGIN.format(name="mine", target="my_own_basis:make") + "\ndef make(): return 'made'\n")
    try:
        assert Registry.discover(only=[], files=[path]).load("basis", "mine")() == "made"
        assert Registry.discover(only=[], files=[path]).load("basis", "mine")() == "made"
    finally:
        sys.modules.pop("my_own_basis", None)


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        ("absent.py", None, "no such file"),
        ("numpy.py", PLUGIN, "rename the file"),
        ("colorsys.py", PLUGIN, "rename the file"),
        ("not-a-name.py", PLUGIN, "rename the file"),
        ("no_suffix", PLUGIN, "must end in .py"),
        ("crashing.py", "1 / 0", "ZeroDivisionError"),
        ("leaving.py", "raise SystemExit(3)", "SystemExit"),
        ("hookless.py", "x = 1", "declares no hook"),
    ],
)
def test_a_plugin_file_that_cannot_be_loaded_stops_the_run(tmp_path: Path, name, text, said):
    if text is not None:
        (tmp_path / name).write_text(text)
    with pytest.raises(PluginError) as caught:
        Registry.discover(only=[], files=[tmp_path / name])
    assert said in str(caught.value)
    assert name in str(caught.value)


def test_whoever_listens_hears_of_every_stage():
    heard = []

    class Listener:
        @hookimpl
        def orbiframe_stage_done(self, stage, result, seconds):
            heard.append((stage, result, seconds))

    registry = Registry()
    registry.register("listener", Listener())
    registry.stage_done("map", {"faces": 3}, 0.5)
    assert heard == [("map", {"faces": 3}, 0.5)]
    assert registry.declarations() == []


def test_a_refused_plugin_leaves_no_trace():
    registry = Registry()
    with pytest.raises(PluginError, match="unknown kind"):
        registry.register("bad", Declares(Component("basis", "a", "a:b", ""), Component("no-kind", "b", "a:b", "")))
    assert registry.declarations() == []
    registry.register("bad", Declares(Component("basis", "a", "a:b", "")))
    assert len(registry.declarations()) == 1


def test_a_registry_can_be_pickled_with_its_plugins_and_files(tmp_path, install):
    install("pickled_plugin", PLUGIN.format(name="wavelet", target="math:hypot"))
    file = tmp_path / "own_basis.py"
    file.write_text(PLUGIN.format(name="own", target="own_basis:orbiframe_components"))
    registry = Registry.discover(files=[file])
    registry.broken.append(("bad", "it is broken"))
    found = pickle.loads(pickle.dumps(registry))
    assert found.declarations() == registry.declarations()
    assert found.broken == registry.broken
    assert found.load("basis", "wavelet") is math.hypot
    assert found.load("basis", "own")()[0].name == "own"
    assert pickle.loads(pickle.dumps(found)).declarations() == registry.declarations()


def test_a_file_is_added_once(tmp_path):
    file = tmp_path / "twice_basis.py"
    file.write_text(PLUGIN.format(name="own", target="math:hypot"))
    registry = Registry()
    registry.add_file(file)
    registry.add_file(file)
    assert len(registry.components("basis")) == 1
