"""Numbers as text."""

from __future__ import annotations

from typing import Any

from numpy.typing import NDArray


def rows(table: NDArray[Any]) -> list[str]:
    """Every row of a table as a line, each number with the fewest digits that give it back."""
    return [" ".join(map(repr, row)) for row in table.tolist()]
