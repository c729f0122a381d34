"""Fits of chains, given out one by one."""

from __future__ import annotations

import threading
from pathlib import Path

from orbiframe_studies.plan import Fit
from orbiframe_studies.source import Source


def fit(key: str) -> Fit:
    return Fit(key, Path(key), key, {}, "", {}, None)


def chain(*batches):
    """A chain that asks for one batch after the other, and remembers what it was sent."""
    for batch in batches:
        rows = yield [fit(key) for key in batch]
        assert [row["key"] for row in rows] == list(batch)


def row(key):
    return {"key": key}


def test_chains_are_opened_when_there_is_time_for_them():
    opened = []

    def chains():
        for name in "abc":
            opened.append(name)
            yield chain([name])

    source = Source(chains(), lambda _: None)
    assert next(source).key == "a"
    assert opened == ["a"]
    source.put("a", row("a"))
    assert source.ended == 1
    assert [each.key for each in (next(source), next(source))] == ["b", "c"]
    assert (source.take(), source.finished) == (None, False)
    source.put("c", row("c"))
    source.put("b", row("b"))
    assert (source.take(), source.finished, source.rows) == (None, True, 3)


def test_what_comes_next_waits_for_the_rows_before_it():
    source = Source(iter([chain(["a", "b"], ["c"])]), lambda _: None)
    assert [next(source).key, next(source).key] == ["a", "b"]
    assert source.take() is None
    source.put("b", row("b"))
    assert source.take() is None
    source.put("a", row("a"))
    assert next(source).key == "c"


def test_a_thread_waits_until_there_is_something_or_all_is_over():
    source = Source(iter([chain(["a"], ["b"])]), lambda _: None)
    assert next(source).key == "a"
    got = []
    thread = threading.Thread(target=lambda: got.extend(source), daemon=True)
    thread.start()
    source.put("a", row("a"))
    while not got:
        thread.join(0.01)
    source.put("b", row("b"))
    thread.join(10)
    assert [each.key for each in got] == ["b"]
    assert not thread.is_alive()


def test_closing_ends_whoever_waits():
    source = Source(iter([chain(["a"])]), lambda _: None)
    next(source)
    thread = threading.Thread(target=lambda: list(source), daemon=True)
    thread.start()
    source.close()
    thread.join(10)
    assert not thread.is_alive()


def test_what_is_known_is_not_done_and_what_two_chains_want_is_done_once():
    source = Source(iter([chain(["a"], ["b"]), chain(["b", "a"]), chain(["c"])]), {"a": row("a")}.get)
    assert [next(source).key, next(source).key] == ["b", "c"]
    source.put("b", row("b"))
    source.put("c", row("c"))
    assert (source.ended, source.rows) == (3, 5)
