"""What holds for every declared component, whatever its kind."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import Any

from orbiframe.components.registry import resolve
from orbiframe.plugin import Component

# Positional arguments that the pipeline hands over; keyword-only arguments come from the configuration.
POSITIONAL = {
    "geometry": 0,
    "marker": 1,
    "group": 2,
    "parametrizer": 3,
    "optimizer": 2,
    "solver": 1,
    "basis": 2,
    "fitter": 0,
    "reader": 1,
    "writer": 2,
    "exporter": 2,
    "elements": 2,
    "picture": 2,
    "command": 1,
}


def target_resolves(component: Component) -> None:
    """The target can be imported and called."""
    resolve(component)


def signature_fits(component: Component) -> None:
    """The component takes exactly the positional arguments of its kind; whatever else it takes is keyword-only."""
    parameters = inspect.signature(resolve(component)).parameters.values()
    kinds = [p.kind for p in parameters]
    assert inspect.Parameter.VAR_POSITIONAL not in kinds, "an option must be keyword-only, not *args"
    assert inspect.Parameter.VAR_KEYWORD not in kinds, "name every option: **options cannot be checked or documented"
    positional = kinds.count(inspect.Parameter.POSITIONAL_OR_KEYWORD) + kinds.count(inspect.Parameter.POSITIONAL_ONLY)
    required = POSITIONAL[component.kind]
    assert positional == required, f"{positional} positional arguments; a {component.kind} takes {required}"


def options_documented(component: Component) -> None:
    """Every option is named in the docstring and has a type and a default."""
    target = resolve(component)
    text = f"{target.__doc__ or ''} {getattr(target, '__init__', None).__doc__ or ''}"
    for parameter in inspect.signature(target).parameters.values():
        if parameter.kind is inspect.Parameter.KEYWORD_ONLY:
            assert parameter.name in text, f"the docstring does not mention '{parameter.name}'"
            assert parameter.annotation is not inspect.Parameter.empty, f"'{parameter.name}' has no type"
            assert parameter.default is not inspect.Parameter.empty, f"'{parameter.name}' has no default"


def summary_is_one_line(component: Component) -> None:
    """The summary is one line of at most 100 characters without a full stop."""
    assert component.summary == component.summary.strip() != "", "the summary is empty or padded"
    assert "\n" not in component.summary, "the summary has several lines"
    assert len(component.summary) <= 100, f"the summary has {len(component.summary)} characters"
    assert not component.summary.endswith("."), "the summary ends with a full stop"


def suffixes_are_written_alike(component: Component) -> None:
    """Kinds that read or make files name suffixes with a dot in lower case; other kinds name none."""
    if component.kind in ("reader", "writer", "exporter", "elements", "picture"):
        assert component.suffixes, f"a {component.kind} names its file suffixes"
    else:
        assert not component.suffixes, f"a {component.kind} has no file suffixes"
    for suffix in component.suffixes:
        assert suffix.startswith("."), f"'{suffix}' lacks its dot"
        assert suffix == suffix.lower(), f"'{suffix}' is not in lower case"


LAWS: tuple[Callable[[Component], Any], ...] = (
    target_resolves,
    signature_fits,
    options_documented,
    summary_is_one_line,
    suffixes_are_written_alike,
)
