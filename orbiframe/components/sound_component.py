"""Sound component: what a plugin declares, tried before anything relies on it."""

from __future__ import annotations

import re

from orbiframe.components.shown_text import shown
from orbiframe.errors import PluginError
from orbiframe.plugin import KINDS, OPEN_NAMES, Component

_NAME = re.compile(r"[a-z0-9][a-z0-9._-]*")
_TARGET = re.compile(r"[^\W\d]\w*(\.[^\W\d]\w*)*:[^\W\d]\w*")


def sound(component: object, owner: str) -> Component:
    """A declaration of a plugin, if it is one that can be named, listed and imported. Raises PluginError otherwise."""
    if not isinstance(component, Component):
        raise PluginError(f"plugin '{owner}' declares {component!r}; orbiframe_components must return Components")
    title = f"plugin '{owner}': {component.kind} '{shown(str(component.name), 100)}'"
    if component.kind not in KINDS:
        raise PluginError(f"{title} is of an unknown kind; the kinds are {', '.join(KINDS)}")
    if not isinstance(component.name, str) or not _NAME.fullmatch(component.name):
        raise PluginError(f"{title} has a name that cannot be used; take small letters, digits, '-', '_' and '.'")
    if component.name in OPEN_NAMES:
        raise PluginError(f"{title} has a name that means no component in a configuration; take another one")
    if not isinstance(component.target, str) or not _TARGET.fullmatch(component.target):
        raise PluginError(f"{title} has the target '{component.target}'; write 'package.module:object'")
    if not isinstance(component.summary, str) or shown(component.summary) != component.summary:
        raise PluginError(f"{title} has the summary {component.summary!r}; write one line of text")
    if not isinstance(component.suffixes, tuple) or not all(isinstance(s, str) for s in component.suffixes):
        raise PluginError(f"{title} has the suffixes {component.suffixes!r}; write a tuple such as ('.npz',)")
    return component
