"""Losses: what a format cannot hold is a warning, or an error where the user is strict."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from contextlib import contextmanager

from orbiframe.errors import FormatError, Notice


@contextmanager
def losses(*, strict: bool) -> Iterator[None]:
    """Within, a warning of a reader or writer is a FormatError where the user is strict."""
    with warnings.catch_warnings():
        if strict:
            warnings.simplefilter("error", UserWarning)
            warnings.simplefilter("always", Notice)
        try:
            yield
        except FormatError as error:
            if isinstance(error.__cause__, UserWarning):
                raise FormatError(f"{error.__cause__}; nothing is written, as --strict allows no loss") from error
            raise
