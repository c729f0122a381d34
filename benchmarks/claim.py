"""A claim of speed: what is measured, beside what, and where it is said."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

Action = Callable[[], object]


class Claim(NamedTuple):
    """What is measured, beside what, how many times as fast ours is said to be at least, and where that is said."""

    what: str
    peer: str
    least: float
    where: str
    make: Callable[[], tuple[Action, Action]]
