"""The commands of `orbiframe`."""

from __future__ import annotations

from orbiframe.plugin import Component, hookimpl


@hookimpl
def orbiframe_components() -> list[Component]:
    """A command is a function `configure(parser)` that adds its arguments and sets the default `run`."""
    return [
        Component("command", "fit", "orbiframe.cli.fit:configure", "make one smooth surface from a closed mesh"),
        Component("command", "info", "orbiframe.cli.info:configure", "name the surface of a mesh and its defects"),
        Component("command", "convert", "orbiframe.cli.convert:configure", "write a mesh in another format"),
        Component(
            "command", "plugins", "orbiframe.cli.plugins:configure", "list the installed components or check one"
        ),
    ]
