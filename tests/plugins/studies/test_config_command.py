"""orbiframe config."""

from __future__ import annotations

import json
import tomllib

import jsonschema
from orbiframe_studies.study_keys import MEANINGS, keys
from studies import written


def test_the_default_of_a_study_can_be_run_and_fits_the_schema(orbiframe, tmp_path):
    path = written(tmp_path, "", "other.toml").with_name("all.toml")
    assert orbiframe("config", "init", "--study", "-o", path).status == 0
    text = path.read_text().replace('["*.obj"]', '["cube.off"]')
    path.write_text(text)
    ran = orbiframe("config", "check", path, tmp_path / "other.toml")
    assert ran.out.splitlines() == [f"{path}: a study of 1 fits", f"{tmp_path / 'other.toml'}: a study of 1 fits"]
    schema = json.loads(orbiframe("config", "schema").out)
    jsonschema.Draft202012Validator.check_schema(schema)
    check = jsonschema.Draft202012Validator(schema).is_valid
    assert check(tomllib.loads(text))
    assert check({"study": {"meshes": ["a"]}, "sweep": {"basis": {"size": [1]}}, "case": [{"name": "a", "map": {}}]})
    assert not check({"study": {"mehses": ["a"]}})
    assert not check({"study": {"meshes": ["a"]}, "sweep": {"basis": {"size": 1}}})
    assert not check({"study": {}})


def test_every_key_of_a_study_is_explained():
    assert {name for name, *_ in keys()} == set(MEANINGS)


def test_a_configuration_is_written_and_checked(orbiframe, tmp_path):
    path = tmp_path / "one.toml"
    path.write_text(orbiframe("config", "init").out)
    assert orbiframe("config", "check", path).out == f"{path}: a configuration\n"
    path.write_text("[basis]\nsiez = 3\n")
    ran = orbiframe("config", "check", path)
    assert (ran.status, "Did you mean 'size'?" in ran.err) == (2, True)
    assert orbiframe("config", "check").status == 2
    assert orbiframe("config", "init", path).status == 2
