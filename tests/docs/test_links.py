"""Links lead somewhere, and files that are named exist."""

from __future__ import annotations

import re

import pytest
from documents import PAGES, ROOT, blocks, code_words, links, page_name

_FILE = re.compile(r"^[\w./-]+\.(?:py|off|md|toml|png)$")
_ANCHOR = re.compile(r"[^\w\- ]")


def anchors(text: str) -> set[str]:
    headings = re.findall(r"^#+ (.+)$", text, re.MULTILINE)
    return {_ANCHOR.sub("", heading.lower()).replace(" ", "-") for heading in headings}


@pytest.mark.parametrize("page", PAGES, ids=page_name)
def test_links_within_the_repository_lead_somewhere(page):
    for link in links(page):
        if "://" in link:
            continue
        file, _, anchor = link.partition("#")
        target = (page.parent / file).resolve() if file else page
        assert target.exists(), f"{page_name(page)}: {link}"
        if anchor:
            assert anchor in anchors(target.read_text()), f"{page_name(page)}: {link}"


@pytest.mark.parametrize("page", PAGES, ids=page_name)
def test_files_named_in_the_text_exist(page):
    """A path in backticks is a file of the repository, below the page's folder, or one that the page itself makes."""
    made = {block.title for block in blocks(page)}
    written = {word for block in blocks(page) for word in block.text.split()}
    for word in code_words(page):
        if _FILE.match(word) and word not in made | written:
            assert (ROOT / word).exists() or any(page.parent.rglob(word)), f"{page_name(page)}: {word}"


def test_every_page_is_reached_from_the_readme():
    seen, ahead = set(), [ROOT / "README.md"]
    while ahead:
        page = ahead.pop()
        if page not in seen:
            seen.add(page)
            inner = [(page.parent / link.partition("#")[0]).resolve() for link in links(page) if "://" not in link]
            ahead += [target for target in inner if target.suffix == ".md"]
    assert set(PAGES) <= seen, sorted(map(page_name, set(PAGES) - seen))
