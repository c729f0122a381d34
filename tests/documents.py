"""The pages of the documentation and what stands in them: fenced blocks, commands with their output, links."""

from __future__ import annotations

import importlib.util
import re
from pathlib import Path
from types import ModuleType
from typing import NamedTuple

ROOT = Path(__file__).parents[1]
PAGES = sorted(
    [ROOT / "README.md", ROOT / "CHANGELOG.md", *(ROOT / "docs").rglob("*.md"), *(ROOT / "benchmarks").rglob("*.md")]
)

_FENCE = re.compile(r"^```(\w*)(?: title=\"([^\"]+)\")?\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_LINK = re.compile(r"\[[^\]]*\]\(([^)\s]+)\)")
_CODE = re.compile(r"`([^`\n]+)`")


class Block(NamedTuple):
    """A fenced block: its language, the file that it is, if it has a title, and its text."""

    language: str
    title: str
    text: str


class Command(NamedTuple):
    """A command line and the output that the page shows under it."""

    line: str
    output: str


def page_name(page: Path) -> str:
    return page.relative_to(ROOT).as_posix()


def blocks(page: Path) -> list[Block]:
    return [Block(*found) for found in _FENCE.findall(page.read_text())]


def commands(text: str) -> list[Command]:
    """The commands of a console block: lines after `$ `, each with the lines up to the next one."""
    parts = re.split(r"^\$ ", text, flags=re.MULTILINE)[1:]
    return [Command(line, output) for line, _, output in (part.partition("\n") for part in parts)]


def prose(page: Path) -> str:
    """A page without its fenced blocks."""
    return _FENCE.sub("", page.read_text())


def links(page: Path) -> list[str]:
    return _LINK.findall(prose(page))


def code_words(page: Path) -> list[str]:
    return _CODE.findall(prose(page))


def section(page: Path, heading: str) -> str:
    """The text under a heading, up to the next heading of any level."""
    found = re.search(rf"^#+ {re.escape(heading)}\n(.*?)(?=^#|\Z)", page.read_text(), re.MULTILINE | re.DOTALL)
    assert found, f"{page_name(page)} has no section '{heading}'"
    return found[1]


def table_rows(text: str) -> list[list[str]]:
    """The cells of every row of the tables in a text, without header and rule."""
    lines = [line.strip().strip("|") for line in text.splitlines() if line.strip().startswith("|")]
    rows = [[cell.strip() for cell in line.split("|")] for line in lines]
    rules = [i for i, row in enumerate(rows) if set("".join(row)) <= set("-: ")]
    skipped = {i for rule in rules for i in (rule - 1, rule)}
    return [row for i, row in enumerate(rows) if i not in skipped]


def module_of(script: Path) -> ModuleType:
    """The module that a script of the documentation is."""
    spec = importlib.util.spec_from_file_location(script.stem, script)
    assert spec
    assert spec.loader
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module
