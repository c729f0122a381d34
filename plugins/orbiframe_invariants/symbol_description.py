"""What `orbiframe group` says of an orbifold given by Conway's symbol."""

from __future__ import annotations

import argparse
import re
from typing import TYPE_CHECKING, Any

from orbiframe import Registry, UsageError

if TYPE_CHECKING:
    from orbiframe.groups import ConwayGroup, SphericalGroup
    from orbiframe.words import ConwaySymbol


def is_symbol(text: str) -> bool:
    """Whether a text has only what Conway's symbols have: digits, *, x, o, and parentheses, commas or blanks."""
    return bool(re.fullmatch(r"[\d*∗xX×o∘(),\s]+", text)) and not re.search("x.*X|X.*x", text)


def symbol_group(args: argparse.Namespace, registry: Registry) -> ConwayGroup | SphericalGroup:
    """The group of the orbifold of a symbol."""
    from orbiframe.groups import orbifold_group
    from orbiframe.words import ConwaySymbol

    signature = ConwaySymbol.parse(args.word)
    _require_supported(args, signature)
    return orbifold_group(registry.geometry(signature.curvature), signature)


def describe_symbol(group: ConwayGroup | SphericalGroup, text: str) -> dict[str, Any]:
    """The orbifold of a symbol, its group and its domain."""
    from orbiframe.words import ConwaySymbol, text_of

    signature = ConwaySymbol.parse(text)
    return {
        "symbol": str(signature),
        "orbifold": {
            "name": signature.name,
            "euler_characteristic": str(signature.euler_characteristic),
            "geometry": group.geometry.name,
            "orientable": signature.orientable,
        },
        "order": signature.order,
        "area": group.area,
        "polygon": str(group.word),
        "generators": [{"letter": text_of(k), "kind": _kind(group, k)} for k in group.relations.generators],
        "relations": list(group.relations.texts),
    }


def symbol_rows(found: dict[str, Any]) -> list[tuple[str, str]]:
    """The same in words."""
    orbifold = found["orbifold"]
    place = f"in {orbifold['geometry']}, Euler characteristic {orbifold['euler_characteristic']}"
    return [
        ("symbol", found["symbol"]),
        ("orbifold", f"{orbifold['name']} {place}"),
        ("order", "infinite" if found["order"] is None else str(found["order"])),
        ("area", f"{found['area']:.12g}"),
        ("polygon", found["polygon"]),
        ("letters", ", ".join(f"{g['letter']} ({g['kind']})" for g in found["generators"])),
        ("relations", ", ".join(f"{relation} = 1" for relation in found["relations"])),
    ]


def _require_supported(args: argparse.Namespace, signature: ConwaySymbol) -> None:
    """Raise UsageError for what only gluing words, or only infinite groups, have."""
    if args.prove:
        raise UsageError(f"--prove is for gluing words, such as abABcdCD, and '{signature}' is a symbol; leave it out")
    for name in ("systole", "function"):
        if signature.order and getattr(args, name):
            raise UsageError(f"--{name} is for infinite groups; '{signature}' has {signature.order} elements")


def _kind(group: ConwayGroup | SphericalGroup, label: int) -> str:
    """What a generator does."""
    return group.geometry.classify(group.generator(label), 1e-7)
