"""Keys of configurations from one source: schema, commented default, and what overrides are refused."""

from __future__ import annotations

import tomllib

import jsonschema
import pytest

from orbiframe import Config, ConfigError, Registry
from orbiframe.fitting import config_keys, config_schema, config_template

REGISTRY = Registry.discover()
SCHEMA = config_schema(REGISTRY)


def test_every_key_is_explained():
    assert [key for key in config_keys(REGISTRY) if not key.meaning] == []


def test_no_component_explains_an_option_that_it_has_not():
    known = {(key.component, key.name) for key in config_keys(REGISTRY) if key.component}
    explained = {(component.name, name) for component, _ in REGISTRY.declarations() for name in component.meanings}
    assert explained == known


def test_the_commented_default_changes_nothing(tmp_path):
    path = tmp_path / "all.toml"
    path.write_text(config_template(REGISTRY))
    assert Config.load(path).resolved(REGISTRY) == Config.load().resolved(REGISTRY)


def test_every_line_of_the_default_that_is_commented_out_can_be_used(tmp_path):
    lines = config_template(REGISTRY).splitlines()
    for number, line in enumerate(lines):
        if line.startswith("# ") and " = " in line and not line.endswith("..."):
            path = tmp_path / "one.toml"
            path.write_text("\n".join([*lines[:number], line[2:], *lines[number + 1 :]]))
            Config.load(path)


def test_the_schema_takes_what_is_right_and_refuses_what_is_wrong():
    jsonschema.Draft202012Validator.check_schema(SCHEMA)
    check = jsonschema.Draft202012Validator(SCHEMA).is_valid
    assert check(tomllib.loads(config_template(REGISTRY)))
    assert check({"basis": {"name": "dms", "degree": 3}, "output": {"tolerance": 1e-3}})
    for wrong in (
        {"bais": {}},
        {"basis": {"siez": 3}},
        {"basis": {"size": "many"}},
        {"basis": {"name": "gausian"}},
        {"output": {"refine": 0}},
        {"data": {"means": "rough"}},
    ):
        assert not check(wrong), wrong


@pytest.mark.parametrize("overrides", [["basis.siez=300"], {"basis.siez": 300}, {"basis": {"siez": 300}}], ids=str)
def test_a_misspelt_override_is_refused_when_it_is_loaded(overrides):
    with pytest.raises(ConfigError, match=r"has no option 'siez'.*Did you mean 'size'"):
        Config.load(overrides=overrides)


@pytest.mark.parametrize(
    "overrides", [["basis.size=300"], {"basis.size": 300}, {"basis": {"size": 300}}, [("basis", "size", 300, "here")]]
)
def test_overrides_are_texts_or_a_dictionary(overrides):
    assert Config.load(overrides=overrides).basis.options == {"size": 300}


@pytest.mark.parametrize(("overrides", "said"), [("basis.size=3", "list of texts"), ({"basis": 3}, "TABLE.KEY")])
def test_what_is_no_override_is_refused(overrides, said):
    with pytest.raises(ConfigError, match=said):
        Config.load(overrides=overrides)


def test_resolved_options_are_all_that_a_fit_uses():
    found = Config.load(overrides={"basis.name": "dms", "basis.degree": 4}).resolved(REGISTRY)
    assert found["basis"] == {"name": "dms", "size": None, "degree": 4, "condensed": True, "radius": 0.2}
    assert found["map"] == {"method": "auto", "like": None}
    assert (found["output"]["refine"], found["data"]["lift"]) == (None, True)
