"""Limits: sizes that are estimated and refused with their number, before any work is done for them."""

from __future__ import annotations

import math
from collections.abc import Mapping

from orbiframe.components.options import place_of
from orbiframe.errors import ConfigError

# Functions of a fit, and bytes that one takes: its share of the refined mesh, of the samples and of their matrices.
MOST_FUNCTIONS = 100_000
_BYTES_A_FUNCTION = 20_000
# Triangles of the output, and bytes that one takes: half a vertex with jets, three halfedges with twins.
MOST_TRIANGLES = 4_000_000
_BYTES_A_TRIANGLE = 400


def require_size(size: object, places: Mapping[str, str]) -> None:
    """Raise ConfigError for a number of functions that no fit can have."""
    if not isinstance(size, int) or 1 <= size <= MOST_FUNCTIONS:
        return
    needed = f": that takes {_memory(size * _BYTES_A_FUNCTION)} of memory" if size > 0 else ""
    raise ConfigError(
        f"{place_of('basis.size', places)}basis.size = {_number(size)}{needed}; give 1 to {MOST_FUNCTIONS}"
    )


def require_density(density: int | None, triangles: int, places: Mapping[str, str]) -> None:
    """Raise ConfigError if a mesh of so many triangles, each in density^2 parts, is too large."""
    if density is None or triangles * density**2 <= MOST_TRIANGLES:
        return
    count = triangles * density**2
    most = max(math.isqrt(MOST_TRIANGLES // triangles), 1)
    if density <= most:  # the input itself is as large, and its own triangles are always allowed
        return
    raise ConfigError(
        f"{place_of('output.refine', places)}output.refine = {_number(density)} makes {_number(count)} triangles of "
        f"{triangles}: that takes {_memory(count * _BYTES_A_TRIANGLE)} of memory; give 1 to {most}"
    )


def _number(value: int) -> str:
    """The number, in powers of ten where it is endless."""
    return str(value) if abs(value) < 10**18 else f"about 10^{math.floor(math.log10(abs(value)))}"


def _memory(size: int) -> str:
    return f"about {_number(-(-size // 10**9)).removeprefix('about ')} GB"
