"""Linear algebra on one thread: small blocks in sparse factors wait for more, and digits depend on their number."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager

VARIABLES = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


def one_thread_by_default() -> None:
    """For this process from now on, unless the environment says otherwise; before numpy is imported."""
    for name in VARIABLES:
        os.environ.setdefault(name, "1")


@contextmanager
def one_thread() -> Iterator[None]:
    """For libraries that are loaded already, while this lasts, unless the environment says otherwise."""
    if any(map(os.environ.get, VARIABLES)):
        yield
        return
    from threadpoolctl import threadpool_limits

    with threadpool_limits(1, user_api="blas"):
        yield
