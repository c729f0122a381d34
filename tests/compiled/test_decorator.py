"""Compiled functions: one version for each type, none that fails when Python calls it, and options that are kept."""

from __future__ import annotations

import threading
import time

import numpy as np
import pytest
from numba.core.compiler_lock import global_compiler_lock

from orbiframe.compiled import code_folders, compiled
from orbiframe.compiled.code_folders import CodeFolder


@pytest.fixture(autouse=True)
def nothing_kept(tmp_path, monkeypatch):
    """Everything is compiled in every test."""
    monkeypatch.setattr(code_folders, "code_folders", lambda source: [CodeFolder(tmp_path, True, True)])


@compiled
def _power(base, exponent):  # type: ignore[no-untyped-def]
    """The power."""
    result = base
    for _ in range(exponent - 1):
        result *= base
    return result


@compiled
def _sum_of_powers(base):  # type: ignore[no-untyped-def]
    return _power(base, 2) + _power(base, 3) + _power(base, 4)


def test_numbers_in_calls_share_one_version():
    assert _sum_of_powers(2.0) == 4 + 8 + 16
    assert [str(kind) for kinds in _power.dispatcher.signatures for kind in kinds] == ["float64", "int64"]


@compiled
def _inside(x):  # type: ignore[no-untyped-def]
    return x + 1


@compiled
def _outside(x):  # type: ignore[no-untyped-def]
    return _inside(x) * 2


def test_a_function_that_compiled_code_called_first_can_be_called_from_python():
    """Compiled code needs no wrapper for Python's objects, and a call without one would end the process."""
    assert _outside(3) == 8
    assert _inside(3) == 4
    assert _inside(3) == 4
    assert _outside(4) == 10
    assert len(_inside.dispatcher.signatures) == 1
    assert _outside(0.5) == 3.0
    assert _inside(0.5) == 1.5


@compiled
def _waited_for(x):  # type: ignore[no-untyped-def]
    return x + 2


@compiled
def _compiled_meanwhile(x):  # type: ignore[no-untyped-def]
    return _waited_for(x)


def test_a_thread_that_waits_for_the_compiler_gets_a_version_that_python_can_call():
    found: list[int] = []
    with global_compiler_lock:
        thread = threading.Thread(target=lambda: found.append(_waited_for(1)))
        thread.start()
        time.sleep(0.2)
        assert _compiled_meanwhile(1) == 3
    thread.join()
    assert found == [3]


@compiled
def _both(x):  # type: ignore[no-untyped-def]
    return x - 1


@compiled
def _caller_of_both(x):  # type: ignore[no-untyped-def]
    return _both(x)


def test_a_function_that_python_called_first_can_be_called_from_compiled_code():
    assert _both(3) == 2
    assert _caller_of_both(3) == 2


@compiled
def _quotient(a, b):  # type: ignore[no-untyped-def]
    return a / b


@compiled(may_divide_by_zero=True)
def _numpy_quotient(a, b):  # type: ignore[no-untyped-def]
    return a / b


@compiled(may_divide_by_zero=True)
def _calls_quotient(a, b):  # type: ignore[no-untyped-def]
    return _quotient(a, b)


def test_division_by_zero_is_as_the_function_says_and_not_as_its_caller_does():
    assert _numpy_quotient(1.0, 0.0) == np.inf
    with pytest.raises(ZeroDivisionError):
        _calls_quotient(1.0, 0.0)
    with pytest.raises(ZeroDivisionError):
        _quotient(1.0, 0.0)


@compiled(inline=True)
def _inlined(x):  # type: ignore[no-untyped-def]
    return 3 * x


@compiled(arrays=False)
def _first(x):  # type: ignore[no-untyped-def]
    return _inlined(x[0])


def test_inlined_and_without_arrays():
    assert _first(np.array([2.0])) == 6.0
    assert _inlined.dispatcher.signatures == []


def test_the_docstring_stays():
    assert _power.__doc__ == "The power."
