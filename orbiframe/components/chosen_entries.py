"""Chosen entries: the installed plugins that are to be loaded."""

from __future__ import annotations

import os
from collections.abc import Iterable
from importlib.metadata import EntryPoint, entry_points

from orbiframe.components.suggestion import did_you_mean
from orbiframe.errors import UsageError

GROUP = "orbiframe"
RESTRICTION = "ORBIFRAME_PLUGINS"


def chosen_entries(only: Iterable[str] | None) -> list[EntryPoint]:
    """The entry points of all installed plugins, or of those in `only`, sorted by name.

    Where `only` is None, the environment variable ORBIFRAME_PLUGINS=a,b says it. Raises UsageError for a name that is
    not installed.
    """
    entries = sorted(entry_points(group=GROUP))
    wanted = _restriction() if only is None else list(only)
    if wanted is None:
        return entries
    names = sorted({entry.name for entry in entries})
    for name in wanted:
        if name not in names:
            raise UsageError(
                f"no plugin named '{name}' (asked for by {RESTRICTION} or `only`); "
                f"installed: {', '.join(names) or 'none'}.{did_you_mean(name, names)}"
            )
    return [entry for entry in entries if entry.name in wanted]


def _restriction() -> list[str] | None:
    text = os.environ.get(RESTRICTION)
    return None if text is None else [name.strip() for name in text.split(",") if name.strip()]
