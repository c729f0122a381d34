"""Keywords of `fit` say what a configuration says."""

from __future__ import annotations

import pytest

from orbiframe import Config, ConfigError, UsageError
from orbiframe.fitting.settings import configured


def same(found: Config, *overrides: str) -> bool:
    wanted = Config.load(overrides=overrides)
    return all(getattr(found, part) == getattr(wanted, part) for part in ("steps", "output", "data", "plugins"))


@pytest.mark.parametrize(
    ("settings", "overrides"),
    [
        ({}, []),
        ({"size": 300}, ["basis.size=300"]),
        ({"basis": "ps2", "size": 300}, ["basis.name=ps2", "basis.size=300"]),
        ({"basis": {"name": "ps2", "size": 300}}, ["basis.name=ps2", "basis.size=300"]),
        ({"data": "smooth"}, ["data.means=smooth"]),
        ({"data": {"noise": 0.01}, "tolerance": 0.1}, ["data.noise=0.01", "output.tolerance=0.1"]),
        ({"group": "lattice", "map": "equivariant"}, ["group.method=lattice", "map.method=equivariant"]),
        ({"fast": True}, ["fitter.name=least-squares", "data.lift=false"]),
        ({"fast": False, "size": None}, []),
        ({"refine": 3, "max_error": 0.5}, ["output.refine=3", "output.max_error=0.5"]),
        ({"geometry": "h2"}, ["geometry.name=h2"]),
    ],
)
def test_a_keyword_is_a_key(settings, overrides):
    assert same(configured(None, settings), *overrides)


def test_keywords_change_a_configuration_and_keep_the_rest(tmp_path):
    file = tmp_path / "some.toml"
    file.write_text('plugins = ["mine.py"]\n[basis]\nname = "ps2"\nsize = 100\n[output]\nrefine = 2\n')
    config = configured(Config.parsed(file), {"size": 50})
    assert config.plugins == (tmp_path / "mine.py",)
    assert config.basis.name == "ps2"
    assert config.basis.options == {"size": 50}
    assert config.output.refine == 2


@pytest.mark.parametrize(
    ("settings", "error", "said"),
    [
        ({"sise": 3}, UsageError, "fit has no keyword 'sise'; it has size, .* Did you mean 'size'"),
        ({"output": 3}, UsageError, r"fit\(output=3\): give a dictionary of keys"),
        ({"tolerance": "much"}, ConfigError, r"fit\(tolerance='much'\): output.tolerance = 'much'"),
        ({"basis": 7}, ConfigError, r"fit\(basis=7\): basis.name = 7"),
        ({"output": {"refin": 3}}, ConfigError, "'refin'.* Did you mean 'refine'"),
    ],
)
def test_what_is_wrong_is_told_as_it_was_written(settings, error, said):
    with pytest.raises(error, match=said):
        configured(None, settings)
