"""Layout rules: empty __init__ files, an entry point for every plugin, contracts that leave none out."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())
PLUGINS = sorted(path for path in (ROOT / "plugins").iterdir() if path.is_dir())


@pytest.mark.parametrize("folder", PLUGINS, ids=lambda path: path.name)
def test_a_plugin_has_an_empty_init_an_entry_point_and_a_place_in_the_wheel(folder):
    assert (folder / "__init__.py").read_text() == ""
    assert (folder / "plugin.py").exists()
    assert f"{folder.name}.plugin" in PROJECT["project"]["entry-points"]["orbiframe"].values()
    assert f"plugins/{folder.name}" in PROJECT["tool"]["hatch"]["build"]["targets"]["wheel"]["packages"]


def test_the_import_contracts_cover_every_plugin():
    packages = {path.name for path in PLUGINS}
    linter = PROJECT["tool"]["importlinter"]
    assert set(linter["root_packages"]) == packages | {"orbiframe"}
    for contract in linter["contracts"]:
        listed = {
            *contract.get("modules", []),
            *contract.get("source_modules", []),
            *contract.get("forbidden_modules", []),
        }
        if listed & packages:
            assert packages <= listed, contract["name"]
