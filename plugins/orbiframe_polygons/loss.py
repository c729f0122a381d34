"""Loss: what a file format cannot hold is said, never dropped in silence."""

from __future__ import annotations

import warnings
from pathlib import Path


def tell_loss(path: Path, what: str, lost: bool) -> None:
    """Warn that the format of this file holds no such thing, where the polyhedron has it."""
    if lost:
        warnings.warn(f"{path.name}: {path.suffix.lstrip('.').upper()} files hold no {what}; left out", stacklevel=3)
