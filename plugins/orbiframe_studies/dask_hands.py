"""Fits by the workers of a dask scheduler; through it go only descriptions of fits and their rows."""

from __future__ import annotations

import os
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import lru_cache
from typing import Any

from orbiframe import OrbiframeError, PluginError, Registry
from orbiframe.workers import Outcome
from orbiframe_studies.one_fit import Entry, Terms, fit_task
from orbiframe_studies.plan import Fit
from orbiframe_studies.runner import Hands, Told
from orbiframe_studies.source import Source

LOCAL = "local"
# Fits that wait at the scheduler for each that is being done, so that no worker waits for us.
_AHEAD = 2
_PATIENCE = "10s"


def dask_hands(address: str, workers: int) -> Hands:
    """Fits by the workers of the scheduler at an address, or of one that is started here with so many workers.

    A fit whose worker is lost is done by another one; after four workers it counts as lost. Raises PluginError where
    dask.distributed is not installed, ClusterError where no scheduler answers.
    """
    distributed = _distributed()

    def hands(fits: Source, registry: Registry, terms: Terms, told: Told) -> Iterator[Outcome]:
        with _client(distributed, address, workers) as client:
            yield from _outcomes(distributed, client, fits, registry, terms, told)

    return hands


class ClusterError(OrbiframeError):
    """A cluster that does not answer."""


def _distributed() -> Any:
    try:
        import distributed
    except ImportError as error:
        raise PluginError('--scheduler needs dask.distributed: pip install "orbiframe[cluster]"') from error
    return distributed


@contextmanager
def _client(distributed: Any, address: str, workers: int) -> Iterator[Any]:
    """A connection to the scheduler, ended with whatever was started for it."""
    if address == LOCAL:
        cluster = distributed.LocalCluster(
            n_workers=workers, threads_per_worker=1, processes=True, dashboard_address=None, silence_logs="ERROR"
        )
        with cluster, distributed.Client(cluster) as client:
            yield client
        return
    try:
        client = distributed.Client(address, timeout=_PATIENCE)
    except (OSError, TimeoutError, ValueError) as error:
        raise ClusterError(
            f"no dask scheduler answers at '{address}' ({error}); start one with `dask scheduler`, and workers with "
            "`dask worker ADDRESS --nthreads 1`"
        ) from error
    with client:
        yield client


def _outcomes(
    distributed: Any, client: Any, fits: Source, registry: Registry, terms: Terms, told: Told
) -> Iterator[Outcome]:
    """Keep all workers busy, with a few fits more than they can do at once."""
    under_way: dict[Any, Fit] = {}
    completed = distributed.as_completed(with_results=False, raise_errors=False)
    while True:
        while len(under_way) < _wanted(client) and (fit := fits.take()) is not None:
            future = client.submit(do_fit, registry, terms, fit, key=f"orbiframe-{fit.key}", pure=False)
            under_way[future] = fit
            completed.add(future)
        if not under_way:
            if fits.finished:
                return
            continue
        future = next(completed)
        fit = under_way.pop(future)
        told(fit, "done on the cluster", None)
        yield _outcome(distributed, future, fit)
        future.release()


def _wanted(client: Any) -> int:
    workers = client.scheduler_info(n_workers=-1)["workers"].values()
    return max(_AHEAD * sum(int(worker["nthreads"]) for worker in workers), 1)


def _outcome(distributed: Any, future: Any, fit: Fit) -> Outcome:
    if future.status == "cancelled":
        raise ClusterError("the scheduler has gone; start it, and run the study again: it goes on where it stopped")
    error = future.exception()
    if error is None:
        return Outcome(fit, future.result())
    if isinstance(error, distributed.scheduler.KilledWorker):
        return Outcome(fit, lost="with the worker, four times")
    return Outcome(fit, error=error)


_one_at_a_time = threading.Lock()


def do_fit(registry: Registry, terms: Terms, fit: Fit) -> Entry:
    """One fit on a worker; on one with several threads, one after the other."""
    with _one_at_a_time:
        return _task(registry, terms)(fit, _silent)


def _task(registry: Registry, terms: Terms) -> Callable[[Fit, Any], Entry]:
    return _kept_task(_Keyed(registry, terms))


class _Keyed:
    """What a worker needs for a study, equal for all fits of it."""

    def __init__(self, registry: Registry, terms: Terms) -> None:
        self.registry, self.terms = registry, terms

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Keyed) and self.terms == other.terms

    def __hash__(self) -> int:
        return hash((self.terms, os.getpid()))


@lru_cache(maxsize=1)
def _kept_task(keyed: _Keyed) -> Callable[[Fit, Any], Entry]:
    return fit_task(keyed.registry, keyed.terms)


def _silent(_stage: str, _seconds: float | None) -> None: ...
