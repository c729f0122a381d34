"""Outcomes of a task for many items, in this process and in others."""

from __future__ import annotations

import os
import threading
import time

import pytest
from worker_tasks import adding, broken, counting_threads, killed_once

from orbiframe.workers import peak_memory, processors, reset_peak, work


def test_one_worker_works_here_in_order_and_takes_items_one_at_a_time():
    taken, told = [], []
    items = (taken.append(item) or item for item in (1, -1, 2))
    outcomes = work(items, adding, (10,), told=lambda *heard: told.append(heard))
    assert next(outcomes).result == (11, os.getpid())
    assert taken == [1]
    second, third = outcomes
    assert isinstance(second.error, ValueError)
    assert (second.result, second.lost) == (None, "")
    assert third.result == (12, os.getpid())
    assert told == [(item, "adds", None) for item in (1, -1, 2)]


def test_processes_do_each_item_once_and_what_one_of_them_breaks_costs_nobody_else_anything():
    told = []
    outcomes = {
        outcome.item: outcome
        for outcome in work(
            [3, -1, -2, 4, -3, 5], adding, (10,), workers=2, told=lambda item, stage, _: told.append((item, stage))
        )
    }
    assert [outcomes[item].result[0] for item in (3, 4, 5)] == [13, 14, 15]
    assert os.getpid() not in {outcomes[item].result[1] for item in (3, 4, 5)}
    assert str(outcomes[-1].error) == "minus one"
    assert outcomes[-2].lost == "by signal 9"
    assert isinstance(outcomes[-3].error, RuntimeError)
    # What kills its process is tried twice.
    assert sorted(told) == [
        (-3, "adds"),
        (-2, "adds"),
        (-2, "adds"),
        (-1, "adds"),
        (3, "adds"),
        (4, "adds"),
        (5, "adds"),
    ]


def test_each_of_several_processes_has_one_thread(monkeypatch):
    monkeypatch.delenv("ORBIFRAME_THREADS", raising=False)
    assert [outcome.result for outcome in work([1, 2], counting_threads, workers=2)] == [1, 1]
    monkeypatch.setenv("ORBIFRAME_THREADS", "3")
    assert [outcome.result for outcome in work([1, 2], counting_threads, workers=2)] == [3, 3]


def test_what_a_dead_process_did_is_done_by_another(tmp_path):
    assert [outcome.result for outcome in work(["it"], killed_once, (tmp_path / "mark",), workers=2)] == ["it done"]


def test_whoever_stops_listening_ends_the_processes():
    before, begun = threading.active_count(), time.monotonic()
    outcomes = work([1, -4, -4, 2], adding, (0,), workers=2)
    assert next(outcomes).result[0] == 1
    outcomes.close()
    assert threading.active_count() == before
    assert time.monotonic() - begun < 30


class Waiting:
    """One item, and then nothing until it is closed."""

    def __init__(self) -> None:
        self.given, self.closed = False, threading.Event()

    def __iter__(self):
        return self

    def __next__(self):
        if self.given:
            self.closed.wait()
            raise StopIteration
        self.given = True
        return 1

    def close(self) -> None:
        self.closed.set()


def test_whoever_waits_for_an_item_is_told_that_there_is_none():
    before = threading.active_count()
    outcomes = work(Waiting(), adding, (0,), workers=2)
    assert next(outcomes).result[0] == 1
    outcomes.close()
    assert threading.active_count() == before


def test_items_that_cannot_be_had_stop_the_work():
    def items():
        yield 1
        raise ValueError("no more")

    with pytest.raises(ValueError, match="no more"):
        list(work(items(), adding, (0,), workers=2))


def test_a_task_that_cannot_be_made_loses_its_items(capfd):
    outcomes = list(work([1], broken, workers=2))
    assert outcomes[0].lost == "with status 1"
    assert "this task cannot be made" in capfd.readouterr().err


def test_memory_is_watched_from_a_reset_on():
    reset_peak()
    before = peak_memory()
    block = b"x" * 50_000_000
    assert peak_memory() - before > 40_000_000
    del block
    assert processors() >= 1
