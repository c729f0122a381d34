"""Reading takes at most five times the memory of the mesh, by the ways that large files take."""

from __future__ import annotations

import tracemalloc

import pytest
from formats import ARRAYS, REGISTRY, torus
from reader_switches import SWITCHES

from orbiframe.files import gate


def sizes(path) -> tuple[int, int]:
    """The most memory in use while a file is read, and that of its mesh, in bytes."""
    gate.read(path, REGISTRY)  # loads the compiled loops
    tracemalloc.start()
    found = gate.read(path, REGISTRY)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    return peak, sum(getattr(found, array).nbytes for array in ARRAYS)


@pytest.mark.parametrize(
    ("suffix", "options", "count"),
    [
        ("off", {}, 40_000),
        ("obj", {}, 40_000),
        ("ply", {"ascii": True}, 40_000),
        ("ply", {}, 40_000),
        ("stl", {"ascii": True}, 80_000),
        ("stl", {}, 40_000),
        ("xdmf", {}, 40_000),
        ("3mf", {}, 20_000),
    ],
)
def test_memory_grows_by_at_most_five_times_the_mesh(tmp_path, monkeypatch, suffix, options, count):
    for module, name in SWITCHES:
        monkeypatch.setattr(module, name, 0)
    found = []
    for triangles in (count, 2 * count):
        path = tmp_path / f"{triangles}.{suffix}"
        gate.write(path, torus(triangles), REGISTRY, options=options)
        found.append(sizes(path))
    (low, small), (high, large) = found
    assert high - low <= 5 * (large - small)
