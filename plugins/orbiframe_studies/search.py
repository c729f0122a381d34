"""Search: optuna chooses values, a batch at a time, in an order that depends on its seed and the results alone."""

from __future__ import annotations

from collections.abc import Generator
from typing import Any

from orbiframe import PluginError
from orbiframe_studies.study import Search

# What comes out of it: the values to try next; what goes in: the measures of those, None for fits that failed.
Suggestions = Generator[list[dict[str, Any]], list[float | None], None]


def suggestions(search: Search) -> Suggestions:
    """Batches of values, "table.key" to value, until all trials are made; then one empty batch.

    Raises PluginError where optuna is not installed.
    """
    study, states = _study(search)
    made = 0
    while made < search.trials:
        trials = [study.ask() for _ in range(min(search.batch, search.trials - made))]
        values = yield [_values(trial, search.space) for trial in trials]
        made += len(trials)
        for trial, value in zip(trials, values, strict=True):
            if value is None:
                study.tell(trial, state=states.FAIL)
            else:
                study.tell(trial, value)
    yield []


def _study(search: Search) -> tuple[Any, Any]:
    try:
        import optuna
    except ImportError as error:
        raise PluginError('[search] needs the package optuna: pip install "orbiframe[studies]"') from error
    optuna.logging.set_verbosity(optuna.logging.WARNING)
    sampler = optuna.samplers.TPESampler(seed=search.seed)
    return optuna.create_study(direction="minimize", sampler=sampler), optuna.trial.TrialState


def _values(trial: Any, space: dict[str, Any]) -> dict[str, Any]:
    return {name: _value(trial, name, values) for name, values in space.items()}


def _value(trial: Any, name: str, values: Any) -> Any:
    if isinstance(values, list):
        return values[trial.suggest_int(name, 0, len(values) - 1)]
    whole = isinstance(values["low"], int) and isinstance(values["high"], int)
    suggest = trial.suggest_int if whole else trial.suggest_float
    return suggest(name, values["low"], values["high"], log=values.get("log", False))
