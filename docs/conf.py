"""The site: `make docs` makes it from the pages as they are, in `build/site`; decision 39 says why so.

The folder of sources is that of the repository, so that links between the pages, the readme and the changes are the
same here and there. What a reader of a page would not want to see in it is added here: the tree of pages, the names of
files as captions, and the texts of the public names.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import Any

from pygments.lexers.special import TextLexer
from sphinx.application import Sphinx

ROOT = Path(__file__).parents[1]
sys.path[:0] = [str(ROOT / "docs" / "site")]

from names import write_pages  # noqa: E402
from trees import trees  # noqa: E402

project = "orbiframe"
author = "the authors of orbiframe"
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx_copybutton"]
root_doc = "docs/index"
include_patterns = ["README.md", "CHANGELOG.md", "CONTRIBUTING.md", "docs/**", "benchmarks/**"]
exclude_patterns = [".*", "build", "tests", "orbiframe", "plugins", "datasets", "docs/site"]
source_suffix = {".md": "markdown", ".rst": "restructuredtext"}

myst_heading_anchors = 4
default_role = "code"
nitpicky = True
nitpick_ignore_regex = [("py:.*", "PluginManager.*")]
autodoc_typehints = "none"
autodoc_member_order = "bysource"

html_theme = "furo"
html_title = "orbiframe"
html_static_path = ["site/static"]
html_css_files = ["wide.css"]
html_extra_path = ["site/start"]
html_copy_source = False
html_show_sphinx = False
html_show_copyright = False
copybutton_prompt_text = r"\$ |>>> |\.\.\. "
copybutton_prompt_is_regexp = True
copybutton_only_copy_prompt_lines = True
copybutton_remove_prompts = True

_TITLED = re.compile(r'^```(\w+) title="([^"]+)"$', re.MULTILINE)
_MARKED = re.compile(r"([*|\\])|(?<=\w)_(?=\W|$)")


def read(_: Sphinx, name: str, source: list[str]) -> None:
    """Titles of blocks become captions; pages with others below them get the tree of these."""
    captions = {"status 1": "ends with status 1"}
    source[0] = _TITLED.sub(
        lambda found: f"```{{code-block}} {found[1]}\n:caption: {captions.get(found[2], found[2])}\n", source[0]
    )
    source[0] += trees(name)


def plain(*given: Any) -> None:
    """Docstrings are plain text: no character in them but the backtick is a mark; they come last of what is given."""
    lines: list[str] = given[-1]
    lines[:] = [line if line.lstrip().startswith((">>>", "...")) else escaped(line) for line in lines]


def escaped(line: str) -> str:
    """The text outside of backticks, without marks."""
    parts = re.split(r"(`[^`]*`)", line)
    return "".join(part if k % 2 else _MARKED.sub(lambda m: "\\" + m[0], part) for k, part in enumerate(parts))


def setup(app: Sphinx) -> None:
    """Called by Sphinx."""
    app.add_lexer("off", TextLexer)
    app.connect("builder-inited", lambda _: write_pages())
    app.connect("source-read", read)
    app.connect("autodoc-process-docstring", plain)
