"""Threads: the same task for several items at a time, for compiled code that lets other threads run meanwhile."""

from __future__ import annotations

import os
import threading
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from functools import cache
from itertools import islice
from typing import TypeVar

from orbiframe.errors import UsageError

VARIABLE = "ORBIFRAME_THREADS"
_NAME = "orbiframe thread"

Item = TypeVar("Item")
Result = TypeVar("Result")


def processors() -> int:
    """How many processors this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def thread_count() -> int:
    """How many threads work at a time: as many as processors, or as the environment says in ORBIFRAME_THREADS.

    No result depends on it. Raises UsageError where it is no positive number.
    """
    chosen = os.environ.get(VARIABLE)
    if chosen is None:
        return processors()
    if not (chosen.isdecimal() and int(chosen) > 0):
        raise UsageError(f"{VARIABLE} is '{chosen}' in the environment; it must be a positive number of threads")
    return int(chosen)


def in_threads(task: Callable[[Item], Result], items: Iterable[Item]) -> Iterator[Result]:
    """What a task makes of each item, in the order of the items; few are in memory before they are asked for.

    The first error of a task ends the iteration. A task that itself asks for threads has its own alone.
    """
    count = thread_count()
    if count == 1 or threading.current_thread().name.startswith(_NAME):
        yield from map(task, items)
        return
    pool, left = _pool(count, os.getpid()), iter(items)
    running: list[Future[Result]] = [pool.submit(task, item) for item in islice(left, 2 * count)]
    try:
        while running:
            result = running.pop(0).result()
            running += [pool.submit(task, item) for item in islice(left, 1)]
            yield result
    finally:
        for future in running:
            future.cancel()


@cache
def _pool(count: int, process: int) -> ThreadPoolExecutor:  # noqa: ARG001
    """The threads of a process; one that was forked has none of those of the first."""
    return ThreadPoolExecutor(count, thread_name_prefix=_NAME)
