"""Pages with the whole texts of all public names, a page a facade: written when the site is made, in no commit."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from importlib import import_module
from inspect import isclass, isroutine, unwrap
from pathlib import Path

DOCS = Path(__file__).parents[1]
FOLDER = DOCS / "reference" / "names"
sys.path[:0] = [str(DOCS / "reference")]

from make_python import facades, names_of, text_of  # noqa: E402


def directive(facade: str, name: str) -> str:
    """What autodoc is asked for a name."""
    thing = unwrap(getattr(import_module(facade), name))
    if isclass(thing):
        bases = "   :show-inheritance:\n" if issubclass(thing, Exception) else ""
        return f".. autoclass:: {facade}.{name}\n   :members:\n{bases}{hidden_bases(thing)}"
    if isroutine(thing):
        return f".. autofunction:: {facade}.{name}\n"
    return f".. py:data:: {facade}.{name}\n\n   {text_of(facade, name)}\n"


def hidden_bases(thing: type) -> str:
    """What is inherited from classes of the project that have no page is told here."""
    public = {name for facade in facades() for name in names_of(facade)}
    own = [base for base in thing.__mro__[1:] if base.__module__.startswith("orbiframe")]
    return "   :inherited-members:\n" if any(base.__name__ not in public for base in own) else ""


def lines(facade: str) -> Iterator[str]:
    """The page of a facade, line by line; what the top facade has too is there."""
    top = set(names_of("orbiframe")) if facade != "orbiframe" else set()
    yield f"{facade}\n{'=' * len(facade)}\n"
    yield (import_module(facade).__doc__ or "").splitlines()[0] + "\n"
    for name in names_of(facade):
        known = name in top and getattr(import_module("orbiframe"), name) is getattr(import_module(facade), name)
        yield f"{name}\n{'-' * len(name)}\n"
        yield f"See :py:obj:`orbiframe.{name}`.\n" if known else directive(facade, name)


def write_pages() -> None:
    """One file for each facade, in the order of the chain; files that say the same are left alone."""
    FOLDER.mkdir(exist_ok=True)
    for facade in facades():
        page, text = FOLDER / f"{facade}.rst", "\n".join(lines(facade))
        if not page.exists() or page.read_text(encoding="utf-8") != text:
            page.write_text(text, encoding="utf-8")
