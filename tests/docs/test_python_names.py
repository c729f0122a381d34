"""What is public is a page of the reference, and the page is what is public."""

from __future__ import annotations

from pathlib import Path

from documents import ROOT, module_of

MAKER = ROOT / "docs" / "reference" / "make_python.py"
CONFIG_MAKER = MAKER.with_name("make_config.py")
COMPONENT_MAKER = MAKER.with_name("make_components.py")


def made(maker: Path = MAKER) -> str:
    return module_of(maker).page()


def test_the_page_is_what_the_facades_say():
    assert MAKER.with_name("python.md").read_text() == made(), f"run python {MAKER.relative_to(ROOT)}"


def test_the_page_of_configurations_is_what_the_components_say():
    assert CONFIG_MAKER.with_name("config.md").read_text() == made(CONFIG_MAKER), "run docs/reference/make_config.py"


def test_the_page_of_components_is_what_the_registry_says():
    shown = COMPONENT_MAKER.with_name("components.md").read_text()
    assert shown == made(COMPONENT_MAKER), "run docs/reference/make_components.py"


def test_every_public_name_says_what_it_is():
    assert "` |  |" not in made()
