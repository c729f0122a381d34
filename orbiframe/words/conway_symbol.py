"""ConwaySymbol: a closed two-dimensional orbifold in Conway's notation, such as *235, 2222, 4*2, 22x, o or xx."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from fractions import Fraction

from orbiframe.errors import TopologyError

Orders = tuple[int, ...]

_TOKEN = re.compile(r"\s*(?:\((\d+)\)|(\d+)|([oO∘])|([*∗])|([xX×])|(,))")
_FORM = re.compile(r"o*n*(?:\*n*)*x*")

# The names of crystallography by canonical symbol.
PLANE_GROUPS = {
    "o": "p1",
    "2222": "p2",
    "**": "pm",
    "xx": "pg",
    "*x": "cm",
    "*2222": "pmm",
    "22*": "pmg",
    "22x": "pgg",
    "2*22": "cmm",
    "442": "p4",
    "*442": "p4m",
    "4*2": "p4g",
    "333": "p3",
    "*333": "p3m1",
    "3*3": "p31m",
    "632": "p6",
    "*632": "p6m",
}
_POINT_GROUPS = {
    "1": "C1",
    "*": "Cs",
    "x": "Ci",
    "332": "T",
    "*332": "Td",
    "3*2": "Th",
    "432": "O",
    "*432": "Oh",
    "532": "I",
    "*532": "Ih",
}


@dataclass(frozen=True)
class ConwaySymbol:
    """What makes a closed orbifold: handles, cone points, mirror boundaries with corners, and crosscaps.

    handles, crosscaps: how many; cones: the order of each cone point; mirrors: for each boundary the orders m of its
    corners, where two mirrors meet at the angle pi / m, in the order along it. Raises TopologyError for an order below
    2, and for the bad orbifolds, which no plane covers: one cone point, or two that differ, alone on a sphere or a
    disc.

    >>> from orbiframe.words import ConwaySymbol
    >>> symbol = ConwaySymbol.parse("*237")  # the triangle with the angles pi/2, pi/3 and pi/7
    >>> symbol.euler_characteristic, symbol.curvature
    (Fraction(-1, 84), -1)
    """

    handles: int = 0
    cones: Orders = ()
    mirrors: tuple[Orders, ...] = ()
    crosscaps: int = 0

    def __post_init__(self) -> None:
        for order in (*self.cones, *(m for corners in self.mirrors for m in corners)):
            if order < 2:
                raise TopologyError(
                    f"a point of order {order} in '{self}'; cone points and corners have the order 2 or more"
                )
        sphere = not (self.handles or self.crosscaps or self.mirrors)
        disc = len(self.mirrors) == 1 and not (self.handles or self.crosscaps or self.cones)
        orders = self.cones if sphere else self.mirrors[0] if disc else ()
        if len(orders) == 1 or (len(orders) == 2 and orders[0] != orders[1]):
            kind, points = ("sphere", "cone points") if sphere else ("disc", "corners")
            raise TopologyError(
                f"'{self}' is a bad orbifold: a {kind} with the {points} {', '.join(map(str, orders))} alone is "
                f"covered by no plane of constant curvature; give two equal {points}, or three or more"
            )

    @classmethod
    def parse(cls, text: str) -> ConwaySymbol:
        """The orbifold of Conway's symbol: o for handles, cone points, * before the corners of a boundary, x at last.

        Every digit is an order; one of several digits stands in parentheses, `*23(12)`, or all are set apart by blanks
        or commas, `*2 3 12`. Orders 1 may be written and say nothing; "1" is the sphere. Raises TopologyError, naming
        the character, for another text.
        """
        handles = crosscaps = 0
        parts: list[list[int]] = [[]]
        for kind, value in _tokens(text):
            if kind == "n":
                parts[-1] += [value] if value != 1 else []
            elif kind == "*":
                parts.append([])
            handles, crosscaps = handles + (kind == "o"), crosscaps + (kind == "x")
        return cls(handles, tuple(parts[0]), tuple(map(tuple, parts[1:])), crosscaps)

    def __str__(self) -> str:
        boundaries = "".join("*" + _orders_text(corners) for corners in self.mirrors)
        return "o" * self.handles + _orders_text(self.cones) + boundaries + "x" * self.crosscaps or "1"

    @property
    def euler_characteristic(self) -> Fraction:
        """Conway's cost formula: 2 less 2 for o, 1 for * and x, 1 - 1/n for a cone point, half of it for a corner."""
        cost = Fraction(2 * self.handles + len(self.mirrors) + self.crosscaps)
        corners = (m for boundary in self.mirrors for m in boundary)
        halves = [2 * (1 - Fraction(1, n)) for n in self.cones] + [1 - Fraction(1, m) for m in corners]
        return 2 - cost - sum(halves, Fraction()) / 2

    @property
    def curvature(self) -> int:
        """The curvature of the plane that covers the orbifold, the sign of its Euler characteristic: +1, 0 or -1."""
        chi = self.euler_characteristic
        return (chi > 0) - (chi < 0)

    @property
    def orientable(self) -> bool:
        """Whether all elements of the group keep orientation: neither mirrors nor crosscaps."""
        return not (self.mirrors or self.crosscaps)

    @property
    def order(self) -> int | None:
        """The number of elements of a finite group, 2 / Euler characteristic; None for an infinite group."""
        return int(2 / self.euler_characteristic) if self.curvature > 0 else None

    @property
    def canonical(self) -> ConwaySymbol:
        """The same orbifold in one way: largest orders first, crosscaps in place of handles where there are both.

        The corners of a boundary may be read from any of them, and backwards: each boundary by itself if a path on the
        surface reverses orientation, all together if not.
        """
        cones = tuple(sorted(self.cones, reverse=True))
        if self.crosscaps:
            mirrors = sorted((max(_rotated(m), _rotated(m[::-1])) for m in self.mirrors), reverse=True)
            return ConwaySymbol(0, cones, tuple(mirrors), self.crosscaps + 2 * self.handles)
        ways = [sorted((_rotated(m[::step]) for m in self.mirrors), reverse=True) for step in (1, -1)]
        return ConwaySymbol(self.handles, cones, tuple(max(ways)))

    @property
    def name(self) -> str:
        """The name in crystallography, such as p4g or Ih (Schoenflies's); of a hyperbolic one the symbol."""
        text = str(self.canonical)
        if self.curvature <= 0:
            return PLANE_GROUPS.get(text, text)
        return _POINT_GROUPS.get(text) or self._family()

    def _family(self) -> str:
        """The Schoenflies name of a group of one of the seven families."""
        chosen = self.canonical
        corners = chosen.mirrors[0] if chosen.mirrors else ()
        if chosen.crosscaps:
            return f"S{2 * chosen.cones[0]}"
        if chosen.cones and chosen.mirrors:
            return f"D{corners[0]}d" if corners else f"C{chosen.cones[0]}h"
        orders, ending = (corners, "hv") if corners else (chosen.cones, ("", ""))
        return f"D{orders[0]}{ending[0]}" if len(orders) == 3 else f"C{orders[0]}{ending[1]}"


def _tokens(text: str) -> Iterable[tuple[str, int]]:
    """("o", 0), ("n", order), ("*", 0) or ("x", 0) one after the other."""
    whole = bool(re.search(r"\d[\s,]+\d", text))
    found, place = list[tuple[str, int]](), 0
    while place < len(text.rstrip()):
        token = _TOKEN.match(text, place)
        if not token:
            raise TopologyError(
                f"character {place + 1} of '{text}' is '{text[place:].strip()[0]}'; a symbol of Conway has o, digits, "
                "* and x, as in *235, 4*2, 22x or o"
            )
        bracket, digits, handle, star, cross, _ = token.groups()
        orders = [bracket] if bracket else [digits] if digits and whole else list(digits or "")
        found += [("n", int(order)) for order in orders]
        found += [(kind, 0) for kind, seen in (("o", handle), ("*", star), ("x", cross)) if seen]
        place = token.end()
    shape = "".join(kind for kind, _ in found)
    if not shape or not _FORM.fullmatch(shape):
        raise TopologyError(
            f"'{text}' is no symbol of Conway; it has handles o first, then the orders of cone points, then * with the "
            "orders of the corners for each mirror boundary, then crosscaps x; the sphere is 1"
        )
    return found


def _orders_text(orders: Orders) -> str:
    return "".join(str(n) if n < 10 else f"({n})" for n in orders)


def _rotated(orders: Orders) -> Orders:
    """The largest of the cyclic rotations."""
    return max((orders[k:] + orders[:k] for k in range(len(orders))), default=())
