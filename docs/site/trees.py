"""The tree of pages in the margin of the site: every page is in it by the folder in which it lies."""

from __future__ import annotations

# For the pages that have others below them: captions, and pages in their order; a pattern stands for all others.
TREES = {
    "docs/index": {
        "Learn": ["tutorials/first_surface", "tutorials/*"],
        "Look": ["gallery"],
        "Do": ["how_to/*"],
        "Plugins": ["plugins/*", "examples/*/README"],
        "Look up": ["reference/cli", "reference/config", "reference/formats", "reference/python", "reference/*"],
        "Understand": ["explanation/one_mesh", "explanation/*"],
        "The project": ["../README", "../CHANGELOG", "../CONTRIBUTING"],
        "Decisions": ["decisions/*"],
    },
    "docs/reference/python": {"": ["names/orbiframe", "names/*"]},
}


def trees(page: str) -> str:
    """The trees below a page in the language of MyST, as its end; nothing for most pages."""
    return "".join(tree(caption, pages) for caption, pages in TREES.get(page, {}).items())


def tree(caption: str, pages: list[str]) -> str:
    """One tree, which shows in the margin alone."""
    options = ":hidden:\n:glob:\n" + (f":caption: {caption}\n" if caption else "")
    return f"\n```{{toctree}}\n{options}\n" + "\n".join(pages) + "\n```\n"
