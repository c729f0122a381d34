"""Studies: many fits from one file, kept in a folder, on one machine or on a cluster, and what came of them."""

from __future__ import annotations

from orbiframe.plugin import Component, hookimpl


@hookimpl
def orbiframe_components() -> list[Component]:
    """The commands that run studies and tell of them."""
    commands = {
        "run": "run all fits of a study; what is done is kept, so that it goes on where it stopped",
        "report": "one page of a study: table, errors against unknowns, times, surfaces",
        "compare": "the differences between two studies, run by run",
        "config": "a commented configuration, the schema for editors, or a check of a file",
    }
    return [
        Component("command", name, f"orbiframe_studies.{name}_command:configure", summary)
        for name, summary in commands.items()
    ]
