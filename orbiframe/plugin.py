"""How a plugin declares itself: components as strings, and the two hooks."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

import pluggy

KINDS = (
    "geometry",
    "marker",
    "group",
    "parametrizer",
    "optimizer",
    "solver",
    "basis",
    "fitter",
    "reader",
    "writer",
    "exporter",
    "elements",
    "picture",
    "command",
)

# What a configuration says where the pipeline is to choose the component, or to take none: names of no component.
OPEN_NAMES = ("auto", "mesh", "none")

# The marker of a mesh where none is named.
DEFAULT_MARKER = "tree-cotree"

hookspec = pluggy.HookspecMarker("orbiframe")
# Marks the hooks of a plugin: write `@hookimpl` above each function whose name is that of a hook of this module.
hookimpl = pluggy.HookimplMarker("orbiframe")


@dataclass(frozen=True, slots=True)
class Component:
    """A named way to do one step; imported when first used.

    kind: one of `KINDS`; name: as written in a configuration ("least-squares"); target: "package.module:object";
    summary: one line, shown by `orbiframe plugins`; extra: the pip requirement that supplies an optional dependency;
    suffixes: file suffixes with their dot, lower case (kinds that read or make files only); welds: whether every face
    has corners of its own in the file, of which the reader joins the equal ones; textures: whether a writer keeps the
    texture coordinates of corners, marks: whether it keeps edges that are marked as sharp; meanings: what each option
    means, by its name, for the reference, the schema and the commented default of configurations.

    >>> from orbiframe import Component, hookimpl
    >>> @hookimpl
    ... def orbiframe_components():
    ...     return [Component("basis", "bells", "bells.basis:Bells", "bumps (1 - t)^3")]
    """

    kind: str
    name: str
    target: str
    summary: str
    extra: str | None = None
    suffixes: tuple[str, ...] = ()
    welds: bool = False
    textures: bool = False
    marks: bool = False
    meanings: Mapping[str, str] = field(default_factory=dict, hash=False)


@hookspec
def orbiframe_components() -> Iterable[Component]:  # type: ignore[empty-body]
    """The components that a plugin supplies."""


@hookspec
def orbiframe_stage_done(stage: str, result: object, seconds: float) -> None:
    """Called after each stage of a fit with its result and the seconds that it took."""


@hookspec
def orbiframe_show() -> str:  # type: ignore[empty-body]
    """The target "package.module:object" that makes of a surface an object which notebooks show as a page.

    Called as `shown(surface)` by `surface.show()`; of several plugins the one registered last is asked.
    """


@hookspec
def orbiframe_warm_up() -> Iterable[str]:  # type: ignore[empty-body]
    """Commands that together use all compiled code of a plugin, each as it follows `orbiframe`; for `warm-up`.

    They run in a folder where these closed meshes lie: `prism.off`, `torus.off`, `double_torus.off`,
    `projective_plane.off` and `klein_bottle.off`, small ones, and `large.off`, a torus of 351,122 triangles. What they
    write there is thrown away. An example: "fit torus.off -o torus.ply --basis my-basis --quiet".
    """
