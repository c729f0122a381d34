from __future__ import annotations

import sys
import types
from pathlib import Path
from typing import Literal

import pytest

from orbiframe.components.options import options_of
from orbiframe.components.registry import Registry
from orbiframe.errors import ConfigError, PluginError, UsageError
from orbiframe.fitting.config import Config
from orbiframe.plugin import Component, hookimpl


class Wavelet:
    def __init__(
        self,
        orbifold: object,
        triangulation: object,
        *,
        size: int = 100,
        scale: float = 1.0,
        mode: Literal["soft", "hard"] = "soft",
        window: tuple[int, float] = (1, 2.0),
    ) -> None:
        self.given = (orbifold, triangulation, size, scale, mode, window)


def smooth(*, strength: float) -> float:
    return strength


def packed(mesh: object, geometry: object, group: object, *, weights: str = "cotangent") -> str:
    return weights


@pytest.fixture
def registry(monkeypatch):
    module = types.ModuleType("config_test_components")
    module.Wavelet, module.smooth, module.packed = Wavelet, smooth, packed
    monkeypatch.setitem(sys.modules, module.__name__, module)

    class Plugin:
        @hookimpl
        def orbiframe_components(self):
            return [
                Component("basis", "gaussian", f"{module.__name__}:Wavelet", ""),
                Component("basis", "wavelet", f"{module.__name__}:Wavelet", ""),
                Component("fitter", "sliding", "math:dist", ""),
                Component("fitter", "smooth", f"{module.__name__}:smooth", ""),
                Component("parametrizer", "packed", f"{module.__name__}:packed", ""),
                Component("parametrizer", "absent", "no_such_package_anywhere:f", ""),
            ]

    made = Registry()
    made.register("test", Plugin())
    return made


def written(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "my.toml"
    path.write_text(text)
    return path


def test_defaults():
    config = Config.load()
    assert (config.mesh.name, config.group.name, config.map.name) == ("auto", "mesh", "auto")
    assert (config.basis.name, config.fitter.name) == ("gaussian", "sliding")
    assert config.mesh.open
    assert config.group.open
    assert config.map.open
    assert not config.basis.open
    assert (config.output.refine, config.output.tolerance, config.plugins) == (None, None, ())


def test_options_reach_the_component(tmp_path, registry):
    text = """
    plugins = ["./mine.py"]
    [basis]
    name = "wavelet"
    size = 7
    scale = 2
    window = [3, 4]
    [output]
    refine = 3
    """
    config = Config.parsed(written(tmp_path, text), ["basis.mode=hard", "output.tolerance=1e-3"]).checked(registry)
    basis = config.component("basis", registry)("X/H", "T")
    assert basis.given == ("X/H", "T", 7, 2.0, "hard", (3, 4.0))
    assert isinstance(basis.given[3], float)
    assert (config.output.refine, config.output.tolerance) == (3, 1e-3)
    assert config.plugins == (tmp_path / "mine.py",)


def test_an_override_wins_over_the_file_and_the_last_over_the_first(tmp_path):
    path = written(tmp_path, "[basis]\nsize = 1")
    assert Config.parsed(path).basis.options == {"size": 1}
    assert Config.parsed(path, ["basis.size=2", "basis.size=3"]).basis.options == {"size": 3}


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("3", 3),
        ("0.5", 0.5),
        ("true", True),
        ("[1, 2]", [1, 2]),
        ('"3"', "3"),
        ("soft", "soft"),
        ("a=b", "a=b"),
        ("", ""),
    ],
)
def test_override_values_are_toml_or_else_text(text, value):
    assert Config.parsed(None, [f"basis.key={text}"]).basis.options == {"key": value}


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (
            "[basis]\n\nsiez = 3",
            ["my.toml, line 3", "'siez'", "allowed: name, size, scale, mode, window", "Did you mean 'size'?"],
        ),
        ("[basis]\nsize = '3'", ["my.toml, line 2", "basis.size = '3'", "integer"]),
        ("[basis]\nsize = 3.5", ["basis.size = 3.5", "integer"]),
        ("[basis]\nsize = true", ["basis.size = True", "integer"]),
        ("[basis]\nmode = 'sotf'", ["basis.mode", "'soft' or 'hard'"]),
        ("[basis]\nwindow = [1, 'x']", ["basis.window[1]"]),
        ("[basis]\nname = 'wavlet'", ["my.toml, line 2", "no basis named 'wavlet'", "Did you mean 'wavelet'?"]),
        ("[bassis]\nsize = 3", ["my.toml, line 1", "no table named 'bassis'", "Did you mean 'basis'?"]),
        ("basis = 3", ["my.toml, line 1", "must be a table"]),
        ("[basis]\nname = 3", ["basis.name = 3"]),
        ("[basis", ["my.toml is not TOML"]),
        ("[output]\nrefine = 0", ["output.refine = 0", "greater than or equal to 1"]),
        ("[output]\ntolerance = 0.0", ["output.tolerance = 0.0", "greater than 0"]),
        ("[output]\nrefin = 1", ["allowed: refine, tolerance", "Did you mean 'refine'?"]),
        ("[map]\nwegihts = 'x'", ["my.toml, line 2", "Did you mean 'weights'?"]),
        ("[map]\nmethod = 'packed'\nsize = 3", ["[map]", "allowed: method, weights"]),
        ("[group]\nsides = 3", ["[group] has no option 'sides'", "allowed: method"]),
        ("[fitter]\nname = 'smooth'", ["[fitter] needs the option 'strength' (float)", "fitter.strength"]),
        ("plugins = 'a.py'", ["plugins = 'a.py'"]),
        ("plugins = [3]", ["plugins[0]"]),
    ],
)
def test_what_is_wrong_is_named_with_its_place(tmp_path, registry, text, said):
    with pytest.raises(ConfigError) as caught:
        Config.parsed(written(tmp_path, text)).checked(registry)
    for words in said:
        assert words in str(caught.value)


@pytest.mark.parametrize("text", ["size=3", "basis.size", "basis=3", "=3", ".size=3", "basis.=3"])
def test_an_override_has_a_table_and_a_key(text):
    with pytest.raises(ConfigError, match=r"TABLE\.KEY=VALUE"):
        Config.parsed(None, [text])


def test_an_override_is_the_place_of_its_key(registry):
    with pytest.raises(ConfigError, match=r"^--set basis.size=many: basis.size = 'many'"):
        Config.parsed(None, ["basis.size=many"]).checked(registry)
    with pytest.raises(ConfigError, match=r"^--set bais.size=1: no table named 'bais'.*Did you mean 'basis'"):
        Config.parsed(None, ["bais.size=1"])


def test_an_open_map_takes_the_options_of_any_parametrizer_that_can_be_loaded(registry):
    config = Config.from_tables({"map": {"weights": "uniform"}}).checked(registry)
    assert config.component("map", registry, "packed")(1, 2, 3) == "uniform"
    with pytest.raises(PluginError, match="no_such_package_anywhere"):
        config.component("map", registry, "absent")


def test_other_options_leave_the_old_configuration_alone(registry):
    config = Config.from_tables({"basis": {"size": 5, "scale": 2.0}})
    changed = config.with_options("basis", size=6)
    assert changed.component("basis", registry)(0, 0).given[2:4] == (6, 2.0)
    assert config.basis.options["size"] == 5


def test_files_that_cannot_be_read(tmp_path):
    with pytest.raises(ConfigError, match=r"absent\.toml cannot be read"):
        Config.parsed(tmp_path / "absent.toml")
    bad = tmp_path / "latin.toml"
    bad.write_bytes(b"x = '\xe9'")
    with pytest.raises(ConfigError, match=r"latin\.toml cannot be read"):
        Config.load(bad)


def test_a_byte_order_mark_is_no_harm(tmp_path):
    path = tmp_path / "bom.toml"
    path.write_bytes(b"\xef\xbb\xbf[basis]\nsize = 4\n")
    assert Config.parsed(path).basis.options == {"size": 4}


def test_options_are_read_off_the_signature():
    options = {option.name: option for option in options_of(Wavelet)}
    assert list(options) == ["size", "scale", "mode", "window"]
    assert (options["size"].type_name, options["size"].default, options["size"].required) == ("int", 100, False)
    assert options["window"].annotation == tuple[int, float]
    assert [option.required for option in options_of(smooth)] == [True]


def test_the_defaults_fit_the_installed_components():
    Config.load().checked(Registry.discover())


def test_configuration_errors_are_usage_errors():
    assert issubclass(ConfigError, UsageError)
