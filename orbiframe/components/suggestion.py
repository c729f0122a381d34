"""Suggestion: the known name nearest to a mistyped one."""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches

_LONGEST = 100


def did_you_mean(word: str, known: Iterable[str]) -> str:
    """The sentence " Did you mean 'gaussian'?" with its leading space, or nothing where no known name is near."""
    # A name of endless length resembles nothing, and to find that out takes long.
    near = get_close_matches(word, list(known), n=1) if len(word) <= _LONGEST else []
    return f" Did you mean '{near[0]}'?" if near else ""
