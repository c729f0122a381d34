"""Repair options: what a command may change of a mesh, in a fixed order, each saying what it did."""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from orbiframe.meshes.polyhedron import Polyhedron
    from orbiframe.meshes.repair import Repair

# The order in which repairs are made: each makes sense of what the ones before it leave.
ORDER = ("weld", "drop_degenerate", "split_nonmanifold_vertices", "component", "orient", "triangulate")


def add_repairs(parser: argparse.ArgumentParser) -> None:
    """Add the options of all repairs, in the order in which they are made."""
    add = parser.add_argument_group("repairs, made in this order, each said on the standard error stream").add_argument
    add("--weld", metavar="TOL", type=_tolerance, help="join vertices at a distance of at most TOL; 0: equal ones")
    add("--drop-degenerate", action="store_true", help="drop faces without area or on the same vertices as others")
    add("--split-nonmanifold-vertices", action="store_true", help="a vertex of its own for every fan of faces")
    add("--component", metavar="WHICH", type=_which, help="keep one component: largest, or N, where 1 is the largest")
    add("--orient", action="store_true", help="make all faces run alike, and outward")
    add("--triangulate", action="store_true", help="cut larger faces into triangles")


def repairs_asked(args: argparse.Namespace) -> bool:
    """Whether any repair is asked for."""
    return any(True for _ in _asked(args))


def repaired(
    polyhedron: Polyhedron, args: argparse.Namespace, say: Callable[[str], None] | None, *, title: str = ""
) -> Polyhedron:
    """The polyhedron after all repairs that are asked for; what each did is said, under the title, to who listens."""
    from orbiframe.meshes import repair

    for name, arguments in _asked(args):
        function: Callable[..., Repair] = getattr(repair, name)
        polyhedron, said = function(polyhedron, *arguments)
        if say is not None:
            say(f"{title}{name.replace('_', '-')}: {said}")
    return polyhedron


def _asked(args: argparse.Namespace) -> Iterator[tuple[str, list[object]]]:
    """The functions of the repairs, with their arguments."""
    for name in ORDER:
        value = getattr(args, name)
        if value is not None and value is not False:
            yield name, [] if value is True else [value]


def _tolerance(text: str) -> float:
    value = float(text)
    if not 0 <= value < math.inf:
        raise argparse.ArgumentTypeError(f"{text} is no length; give a number from 0 on")
    return value


def _which(text: str) -> str | int:
    if text == "largest":
        return text
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"'{text}' is no component; give 'largest', or a number from 1 on")
    return int(text)
