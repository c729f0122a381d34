"""What `orbiframe group` says of an orbifold given by Conway's symbol."""

from __future__ import annotations

import argparse
import re
from typing import TYPE_CHECKING, Any

from orbiframe.errors import UsageError
from orbiframe.registry import Registry

if TYPE_CHECKING:
    from orbiframe.spherical_group import SphericalGroup
    from orbiframe.symmetry_group import SymmetryGroup

_GEOMETRY = {1: "s2", 0: "e2", -1: "h2"}
_CLOSED_SURFACES = ("systole", "spectrum", "function")


def is_symbol(text: str) -> bool:
    """Whether a text has only what Conway's symbols have: digits, *, x, o, and parentheses, commas or blanks."""
    return bool(re.fullmatch(r"[\d*∗xX×o∘(),\s]+", text)) and not re.search("x.*X|X.*x", text)


def describe_symbol(args: argparse.Namespace, registry: Registry) -> dict[str, Any]:
    """The orbifold, its group and its cell, and a picture if asked for."""
    from orbiframe.signature import Signature
    from orbiframe.symmetry_group import orbifold_group
    from orbiframe.word import text_of

    signature = Signature.parse(args.word)
    _require_supported(args)
    if args.draw and signature.order:
        raise UsageError(
            f"--draw has no picture of the finite group '{signature}'; draw one of the plane, such as *632"
        )
    group = orbifold_group(registry.load("geometry", _GEOMETRY[signature.curvature])(), signature)
    found = {
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
    if args.draw:
        from orbiframe.drawing.group_picture import draw_group

        draw_group(group, args.draw, model=args.model, radius=args.radius, tiles=args.tiles, function=None)
        found["picture"] = str(args.draw)
    return found


def symbol_lines(found: dict[str, Any]) -> list[str]:
    """The same in words."""
    orbifold = found["orbifold"]
    rows = [
        ("symbol", found["symbol"]),
        (
            "orbifold",
            f"{orbifold['name']} in {orbifold['geometry']}, Euler characteristic {orbifold['euler_characteristic']}",
        ),
        ("order", "infinite" if found["order"] is None else str(found["order"])),
        ("area", f"{found['area']:.12g}"),
        ("polygon", found["polygon"]),
        ("generators", ", ".join(f"{g['letter']} ({g['kind']})" for g in found["generators"])),
        ("relations", ", ".join(f"{relation} = 1" for relation in found["relations"])),
    ]
    rows += [("picture", found["picture"])] if "picture" in found else []
    return [f"{name:<10} {text}" for name, text in rows]


def _require_supported(args: argparse.Namespace) -> None:
    for name in _CLOSED_SURFACES:
        if getattr(args, name, None):
            raise UsageError(
                f"--{name} is for closed surfaces; write the surface as a gluing word, such as abABcdCD, instead of "
                f"the symbol '{args.word}'"
            )


def _kind(group: SymmetryGroup | SphericalGroup, label: int) -> str:
    """What a generator does."""
    return group.geometry.classify(group.generator(label), 1e-7)
