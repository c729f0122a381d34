"""Kept machine code runs without numba, does what numba's own does, and goes with numba when that comes later."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

from orbiframe.compiled import kinds, machine_code

tried = pytest.mark.skipif(not machine_code.can_load(), reason="this version of numba loads its own code")

MODULE = """
from typing import NamedTuple

import numpy as np
from orbiframe.compiled import compiled

class Pair(NamedTuple):
    first: np.ndarray
    second: float

@compiled
def sums(a, factor=1.0, more=2):
    total = 0.0
    for i in range(len(a)):
        total += factor * a[i] + more
    return total

@compiled
def arrays(pair):
    out, whole, flags = np.empty((2, 3)), np.arange(4), np.zeros(2, dtype=np.bool_)
    for i in range(2):
        for j in range(3):
            out[i, j] = pair.first[j] * pair.second + np.sin(pair.first[i])
    return out, whole, flags, (pair.second > 1, 7)

@compiled
def refusing(n):
    if n < 0:
        raise ValueError("n is negative")
    return 1 / n

@compiled
def growing(n):
    found = [0.5]
    for i in range(n):
        found.append(i * 0.5)
    return sum(found)

@compiled
def keeping(a):
    return a
"""
CALLS = """
import gc, json, sys
sys.path.insert(0, sys.argv[1])
import numpy as np
from functions import *

def told(error, call):
    try:
        return call()
    except error as found:
        return str(found)

a = np.array([1.0, 2.0, 3.0])
found = [sums(a), sums(a, more=3), sums(a[::-1], 2.0), sums(np.arange(3)), sums(a.astype(np.float32))]
out, whole, flags, rest = arrays(Pair(a, 2.0))
found += [out.tolist(), whole.tolist(), str(flags.dtype), rest, out.flags.writeable, growing(10)]
found += [told(ValueError, lambda: refusing(-1)), told(ZeroDivisionError, lambda: refusing(0)), refusing(4)]
b = np.arange(1000.0)
before = sys.getrefcount(b)
for _ in range(100):
    assert keeping(b)[999] == 999.0
gc.collect()
found += [sys.getrefcount(b) - before]
print(json.dumps([found, "numba" in sys.modules]))
"""


def run(folder: Path, calls: str = CALLS, **environment: str) -> str:
    names = {**os.environ, "NUMBA_CACHE_DIR": str(folder / "kept"), **environment}
    (folder / "functions.py").write_text(MODULE)
    found = subprocess.run(
        [sys.executable, "-c", calls, str(folder)], env=names, capture_output=True, text=True, check=False
    )
    assert found.returncode == 0, found.stderr
    return found.stdout.splitlines()[-1]


@tried
def test_what_kept_code_does_is_what_numba_does(tmp_path):
    """Numbers, arrays, tuples, lists, errors and references."""
    new, kept = run(tmp_path), run(tmp_path)
    assert new.endswith(", true]")
    assert kept == new.replace(", true]", ", false]")
    assert '"n is negative"' in new


LATER = (
    CALLS
    + """
from orbiframe.compiled import compiled

@compiled
def calling(a):
    return sums(a, 1.0, 2) + growing(3)

assert "numba" not in sys.modules
print(calling(a), sums(a), growing(10), told(ValueError, lambda: refusing(-1)), "numba" in sys.modules)
"""
)


@tried
def test_numba_may_come_later(tmp_path):
    run(tmp_path, LATER.split("\nfrom orbiframe")[0])
    assert run(tmp_path, LATER) == "14.0 12.0 23.0 n is negative True"


@tried
def test_a_version_of_numba_that_was_not_tried_loads_its_own_code(tmp_path):
    calls = "import orbiframe.compiled.machine_code as code; code._TRIED = ('0.0.',)\n" + CALLS
    assert run(tmp_path, CALLS) == run(tmp_path, calls)
    assert run(tmp_path, calls).endswith(", true]")
    assert run(tmp_path, CALLS).endswith(", false]")


class Place(NamedTuple):
    x: float
    far: np.ndarray


FROZEN = np.zeros(3)
FROZEN.flags.writeable = False
VALUES = [
    1, True, 2.5, 1j, None, np.int32(1), np.uint8(1), np.float32(1), np.float64(1), np.int64(1), np.bool_(True),
    np.zeros(3), np.zeros((2, 3)), np.zeros((2, 3)).T, np.zeros((4, 4))[::2, ::2], np.zeros((3, 1)), np.zeros((1, 3)).T,
    np.zeros(2, dtype=np.intp), np.zeros(2, dtype=np.int32), np.zeros(2, dtype=np.bool_), np.zeros(2, dtype=np.uint8),
    np.zeros(2, dtype=complex), np.zeros(2, dtype=np.float32), np.array(1.0), np.zeros((0, 3)), FROZEN,
    np.frombuffer(b"12345678" * 2 + b"1", dtype=np.uint8)[1:].view(np.float64),
    (), (1, 2.0), (1, 1), (np.zeros(2), (1, np.zeros((2, 2)))), Place(1.0, np.zeros(2)),
]  # fmt: skip


@pytest.mark.parametrize("value", VALUES, ids=repr)
def test_kinds_are_described_in_the_words_for_the_types_of_numba(value):
    from numba import typeof

    from orbiframe.compiled.versions import described_types

    assert kinds.described((value, 1)) == described_types((typeof(value), typeof(1)))


@pytest.mark.parametrize(
    ("one", "other"),
    [
        (FROZEN, np.zeros(3)),
        (np.zeros(3), np.zeros(6)[::2]),
        (np.zeros((2, 3)), np.zeros((3, 2)).T),
        (np.zeros(3), np.zeros(3, dtype=np.float32)),
        (np.zeros(3), np.zeros((3, 1))),
        (1, 1.0),
        (1, True),
        (1, 2**63),
        ((1, 2), (1, 2.0)),
        ((1.0, FROZEN), Place(1.0, FROZEN)),
    ],
)
def test_what_needs_other_code_is_another_kind(one, other):
    assert kinds.kind_of(one) != kinds.kind_of(other)
    assert kinds.described((one,)) != kinds.described((other,))


@pytest.mark.parametrize(
    "value", ["text", 2**63, np.zeros(2, dtype=">f8"), np.zeros(2, dtype="M8[s]"), [1.0], (1, "x")]
)
def test_what_only_numba_knows_is_left_to_it(value):
    assert kinds.described((value,)) is None


def test_the_version_of_numba_that_is_developed_with_was_tried():
    text = (Path(__file__).parents[2] / "constraints.txt").read_text(encoding="utf-8")
    (version,) = re.findall(r"^numba==(\S+)$", text, re.MULTILINE)
    assert version.startswith(machine_code._TRIED)
