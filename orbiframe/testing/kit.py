"""Kit: the laws of a kind, run one by one, under pytest or without it."""

from __future__ import annotations

import importlib
import importlib.util
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from orbiframe.errors import UsageError
from orbiframe.plugin import KINDS
from orbiframe.testing.lab import Lab, Untried

Law = Callable[[Callable[..., Any], Lab], None]
Mutation = Callable[[Callable[..., Any]], Callable[..., Any]]


@dataclass(frozen=True, slots=True)
class Laws:
    """The laws of one kind, and for each law a mutation.

    A law `(component, lab) -> None` raises if the component breaks it; its docstring is the law in words. The
    component is the class or function itself, with its options bound: a law calls it with the positional arguments of
    the kind. A mutation takes a correct component and returns a broken one, which the law of that name must reject.
    """

    kind: str
    laws: tuple[Law, ...]
    mutants: Mapping[str, Mutation]


@dataclass(frozen=True, slots=True)
class Verdict:
    """Whether a law held: `error` is None, or what the law found; `untried`: why it could not be tried."""

    law: str
    statement: str
    error: str | None
    untried: str | None = None


def laws_of(kind: str) -> Laws:
    """The laws of a kind. Raises UsageError for a kind that has none."""
    if not has_laws(kind):
        raise UsageError(
            f"there are no laws for the kind '{kind}'; kinds with laws: {', '.join(filter(has_laws, KINDS))}"
        )
    module = importlib.import_module(f"orbiframe.testing.{kind}_laws")
    return Laws(kind, module.LAWS, module.MUTANTS)


def has_laws(kind: str) -> bool:
    """Whether the kit has a module of laws for a kind."""
    return kind in KINDS and importlib.util.find_spec(f"orbiframe.testing.{kind}_laws") is not None


def contract_tests(
    kind: str,
    component: Callable[..., Any],
    *,
    params: Mapping[str, object] | None = None,
    suffix: str | None = None,
    counterpart: Callable[..., Any] | None = None,
    expected_failures: Mapping[str, str] | None = None,
) -> Callable[..., None]:
    """A test for pytest, to be bound to a name that starts with test_: one case for each law of the kind.

    component: the class or function; params: options bound to it; suffix and counterpart: for files, see `Lab`.
    A law that cannot be tried is skipped, with the reason. expected_failures: laws that are known not to hold, with the
    reason; a law in it that holds fails the test. Raises UsageError for a kind without laws, or an expected failure
    that is no law.
    """
    import pytest

    reasons = dict(expected_failures or {})
    laws = laws_of(kind).laws
    _require_laws(reasons, laws, kind)
    options = dict(params or {})

    @pytest.mark.parametrize("law", [_case(law, reasons.get(law.__name__)) for law in laws])
    def contract(law: Law, tmp_path: Path) -> None:
        try:
            law(bound(component, options), Lab(tmp_path, options, suffix, counterpart))
        except Untried as reason:
            pytest.skip(str(reason))

    return contract


def bound(component: Callable[..., Any], params: Mapping[str, object]) -> Callable[..., Any]:
    """The component with its options bound; the component itself where there are none."""
    return partial(component, **params) if params else component


def statement(law: Callable[..., object]) -> str:
    """The law in words: the first line of its docstring."""
    return (law.__doc__ or law.__name__).strip().splitlines()[0]


def tried(law: Callable[..., None], *materials: object) -> Verdict:
    """What one law says of what it is given."""
    try:
        law(*materials)
    except Untried as reason:
        return Verdict(law.__name__, statement(law), None, str(reason))
    except (Exception, SystemExit) as error:
        return Verdict(law.__name__, statement(law), f"{type(error).__name__}: {error}")
    return Verdict(law.__name__, statement(law), None)


def _case(law: Law, reason: str | None) -> Any:
    import pytest

    marks = [] if reason is None else [pytest.mark.xfail(strict=True, reason=reason)]
    return pytest.param(law, id=law.__name__, marks=marks)


def _require_laws(names: Mapping[str, str], laws: tuple[Law, ...], kind: str) -> None:
    known = [law.__name__ for law in laws]
    for name in names:
        if name not in known:
            raise UsageError(f"no law of the kind '{kind}' is named '{name}'; its laws are {', '.join(known)}")
