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
        Component("command", "warm-up", "orbiframe.cli.warm_up:configure", "compile what the other commands need"),
        Component(
            "command",
            "completion",
            "orbiframe.cli.completion:configure",
            "print what a shell needs to complete commands",
            extra="orbiframe[completion]",
        ),
        Component("command", "new", "orbiframe.cli.new:configure", "write the beginning of a plugin"),
        Component(
            "command", "plugins", "orbiframe.cli.plugins:configure", "list the installed components or check one"
        ),
    ]


@hookimpl
def orbiframe_warm_up() -> list[str]:
    """A fit in each geometry, orientable and not."""
    meshes = ("double_torus", "torus", "prism", "klein_bottle", "projective_plane")
    return [f"fit {mesh}.off -o out.ply --quiet" for mesh in meshes]
