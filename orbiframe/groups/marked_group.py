"""MarkedGroup: a named group whose letters are loops of a polyhedron, and so an isometry for every halfedge."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from orbiframe.errors import GeometryError
from orbiframe.groups.corner_elements import corner_elements, products_of_pairings
from orbiframe.groups.group import Group
from orbiframe.groups.marking import Marking
from orbiframe.groups.polygon_group import PolygonGroup
from orbiframe.planes.precise_isometry import PreciseIsometry


@dataclass(frozen=True, eq=False)
class MarkedGroup:
    """A group H and a polyhedron cut open to the polygon of H: the target of a map that the polyhedron does not choose.

    group, marking: with the same word; name: of the group, for the report. Raises GeometryError if the words differ.
    """

    group: Group
    marking: Marking
    name: str = "given"

    def __post_init__(self) -> None:
        if self.group.word != self.marking.word:
            raise GeometryError(
                f"the group has the word '{self.group.word}' and the marking of the mesh '{self.marking.word}'; "
                "build the group from the word of the marking"
            )

    @property
    def source(self) -> str:
        """The group in words for the report."""
        return f"{self.name}, word {self.group.word}"

    @cached_property
    def elements(self) -> PreciseIsometry:
        """For every corner c of the polygon the element g_c that takes corner 0 to it, (n,).

        A halfedge that runs in the polygon from corner p to corner q is the deck transformation g_p^-1 g_q of corner 0.
        """
        if isinstance(self.group, PolygonGroup):
            return corner_elements(self.group.polygon)
        return products_of_pairings(self.group)
