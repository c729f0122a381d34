"""The table of what each suffix keeps is what writing and reading show."""

from __future__ import annotations

import subprocess
import sys

import pytest
from documents import ROOT, section
from kept import suffixes

from orbiframe.components.registry import Registry

REGISTRY = Registry.discover()
PAGE = section(ROOT / "docs" / "reference" / "formats.md", "What each suffix keeps")


def rows(text: str) -> dict[str, str]:
    return {line.split()[1]: line for line in text.splitlines() if line.startswith("| `")}


@pytest.fixture(scope="module")
def found() -> dict[str, str]:
    # A process of its own, since the libraries work in it without confinement.
    command = [sys.executable, str(ROOT / "tests" / "kept.py")]
    return rows(subprocess.run(command, capture_output=True, text=True, check=True).stdout)


def test_every_suffix_that_is_read_and_written_has_its_row():
    assert list(rows(PAGE)) == [f"`{suffix}`" for suffix, _ in suffixes(REGISTRY)]


@pytest.mark.parametrize(("suffix", "name"), suffixes(REGISTRY), ids=str)
def test_the_row_of_a_suffix_is_what_it_keeps(suffix, name, found):
    if name == "open3d" and f"`{suffix}`" not in found:
        pytest.skip("open3d is not installed or does not load")
    assert rows(PAGE)[f"`{suffix}`"] == found[f"`{suffix}`"]
