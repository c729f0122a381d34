"""What is public is a page of the reference, and the page is what is public."""

from __future__ import annotations

import importlib.util
from pathlib import Path

from documents import ROOT

MAKER = ROOT / "docs" / "reference" / "make_python.py"
CONFIG_MAKER = MAKER.with_name("make_config.py")


def made(maker: Path = MAKER) -> str:
    spec = importlib.util.spec_from_file_location(maker.stem, maker)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.page()


def test_the_page_is_what_the_facades_say():
    assert MAKER.with_name("python.md").read_text() == made(), f"run python {MAKER.relative_to(ROOT)}"


def test_the_page_of_configurations_is_what_the_components_say():
    assert CONFIG_MAKER.with_name("config.md").read_text() == made(CONFIG_MAKER), "run docs/reference/make_config.py"


def test_every_public_name_says_what_it_is():
    assert "` |  |" not in made()
