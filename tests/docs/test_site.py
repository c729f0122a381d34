"""The site is made without a warning, holds every page, and needs no network."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path
from urllib.parse import unquote

import pytest
from documents import ROOT

pytestmark = pytest.mark.long
_LOADED = re.compile(r'<(?:script|img|link rel="(?:stylesheet|icon)")[^>]* (?:src|href)="([^"]+)"')
_LINKED = re.compile(r'<a [^>]*href="([^"#]+)')
_NETWORK = re.compile(r"^(?:https?:)?//")


@pytest.fixture(scope="module")
def site(tmp_path_factory) -> Path:
    pytest.importorskip("sphinx", reason="the extra docs is not installed")
    folder = tmp_path_factory.mktemp("site")
    made = [sys.executable, "-m", "sphinx", "--fail-on-warning", "--fresh-env", "--quiet", "-c", "docs"]
    done = subprocess.run(
        [*made, "-d", folder / "trees", ".", folder / "html"], cwd=ROOT, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    return folder / "html"


def pages(site: Path) -> list[Path]:
    return sorted(site.rglob("*.html"))


def test_every_page_is_in_the_site(site):
    shown = {path.relative_to(site).with_suffix("").as_posix() for path in pages(site)}
    written = [ROOT / "README.md", ROOT / "CHANGELOG.md", *(ROOT / "docs").rglob("*.md")]
    assert {path.relative_to(ROOT).with_suffix("").as_posix() for path in written} <= shown


def test_nothing_is_loaded_from_elsewhere_and_all_is_there(site):
    for page in pages(site):
        for target in _LOADED.findall(page.read_text()):
            assert not _NETWORK.match(target), (page, target)
            assert target.startswith("data:") or (page.parent / unquote(target.partition("?")[0])).exists(), (
                page,
                target,
            )


def test_links_lead_to_pages_and_files_of_the_site(site):
    for page in pages(site):
        for target in _LINKED.findall(page.read_text()):
            assert re.match(r"^(?:https?|mailto):", target) or (page.parent / unquote(target)).exists(), (page, target)
