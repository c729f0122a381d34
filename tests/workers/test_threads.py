"""Threads: items in their order, few in memory, errors of tasks, and no result that depends on their number."""

from __future__ import annotations

import os
import subprocess
import sys
import threading
from itertools import count, islice

import numpy as np
import pytest
from fitted import REGISTRY, config, mesh_of

from orbiframe import Points, UsageError
from orbiframe.fitting import pipeline
from orbiframe.workers import in_threads, thread_count
from orbiframe.workers.threads import VARIABLE


@pytest.fixture(params=["1", "2", "5"])
def threads(request, monkeypatch) -> int:
    monkeypatch.setenv(VARIABLE, request.param)
    return int(request.param)


def test_results_come_in_the_order_of_the_items(threads) -> None:
    assert thread_count() == threads
    assert list(in_threads(lambda n: n * n, range(100))) == [n * n for n in range(100)]


def test_few_items_are_taken_before_their_results_are_asked_for(threads) -> None:
    taken = count()
    results = in_threads(lambda n: n, taken)
    assert list(islice(results, 10)) == list(range(10))
    assert next(taken) <= 10 + 2 * threads
    results.close()


def test_so_many_tasks_run_at_a_time(threads) -> None:
    """Each waits until all others are there too."""
    barrier = threading.Barrier(threads, timeout=20)

    def task(_: int) -> int:
        barrier.wait()
        return threading.get_ident()

    assert len(set(in_threads(task, range(threads)))) == threads


@pytest.mark.usefixtures("threads")
def test_the_first_error_ends_it() -> None:
    results = in_threads(lambda n: 1 // (3 - n), range(100))
    assert list(islice(results, 3)) == [0, 0, 1]
    with pytest.raises(ZeroDivisionError):
        next(results)


@pytest.mark.usefixtures("threads")
def test_tasks_that_ask_for_threads_wait_for_nobody() -> None:
    assert list(in_threads(lambda n: sum(in_threads(lambda k: k * n, range(20))), range(30))) == [
        190 * n for n in range(30)
    ]


@pytest.mark.parametrize("wrong", ["0", "-1", "two", ""])
def test_a_wrong_number_is_named(monkeypatch, wrong) -> None:
    monkeypatch.setenv(VARIABLE, wrong)
    with pytest.raises(UsageError, match=f"{VARIABLE} is '{wrong}'"):
        thread_count()


FORKED = """
import os
from orbiframe.workers import in_threads
list(in_threads(abs, range(10)))
child = os.fork()
if not child:
    os._exit(0 if list(in_threads(abs, range(-3, 3))) == [3, 2, 1, 0, 1, 2] else 1)
raise SystemExit(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
"""


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork here")
def test_a_forked_process_has_threads_of_its_own() -> None:
    """In an interpreter of its own, for other libraries have threads that do not outlive a fork."""
    environment = {**os.environ, VARIABLE: "2"}
    subprocess.run([sys.executable, "-W", "ignore", "-c", FORKED], env=environment, check=True, timeout=60)


def test_no_byte_depends_on_the_number(monkeypatch) -> None:
    found = []
    for number in ("1", "3"):
        monkeypatch.setenv(VARIABLE, number)
        surface = pipeline.fit(mesh_of("double torus"), config(80), REGISTRY).surface
        curvature = surface.curvature(Points(surface.triangulation.patch, surface.triangulation.points))
        found.append((surface.coefficients, curvature.mean))
    for one, other in zip(*found, strict=True):
        np.testing.assert_array_equal(one, other)
