"""Check: an installed component tried on all its laws, without pytest."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from orbiframe.components.options import options_of
from orbiframe.components.registry import Registry, resolve
from orbiframe.plugin import Component
from orbiframe.testing import component_laws
from orbiframe.testing.kit import Verdict, bound, has_laws, laws_of, tried
from orbiframe.testing.lab import Lab

SMALL = 40


def check(component: Component, registry: Registry) -> list[Verdict]:
    """What every law says of a component: the laws of all components, and those of its kind for each file suffix."""
    imported = tried(component_laws.target_resolves, component)
    if imported.error is not None:
        return [imported]
    found = [tried(law, component) for law in component_laws.LAWS]
    if has_laws(component.kind):
        found += [verdict for equipment in equipments(component, registry) for verdict in _on(component, equipment)]
    return found


def equipments(component: Component, registry: Registry) -> Iterator[dict[str, Any]]:
    """What a lab for a component needs, once for every suffix of those that read or make files.

    A basis that can be of any size is tried small, as the reference triangulations are.
    """
    if not component.suffixes:
        sized = component.kind == "basis" and any(option.name == "size" for option in options_of(resolve(component)))
        yield {"params": {"size": SMALL}} if sized else {}
    for suffix in component.suffixes:
        other = counterpart(component, suffix, registry) if component.kind in ("reader", "writer") else None
        yield {"suffix": suffix, "counterpart": other}


def counterpart(component: Component, suffix: str, registry: Registry) -> Callable[..., Any] | None:
    """The writer for a reader and the reader for a writer; the one of the same name before others for the suffix."""
    kind = "writer" if component.kind == "reader" else "reader"
    others = [other for other in registry.components(kind) if suffix in other.suffixes]
    others.sort(key=lambda other: other.name != component.name)
    return resolve(others[0]) if others else None


def _on(component: Component, equipment: dict[str, Any]) -> Iterator[Verdict]:
    target = bound(resolve(component), equipment.get("params", {}))
    for law in laws_of(component.kind).laws:
        with TemporaryDirectory() as folder:
            verdict = tried(law, target, Lab(Path(folder), **equipment))
        yield replace(verdict, law=" ".join([verdict.law, *filter(None, [equipment.get("suffix")])]))
