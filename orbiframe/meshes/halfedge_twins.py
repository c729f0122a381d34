"""Twins in large polyhedra, found in one compiled loop over the vertices."""

from __future__ import annotations

from numpy import empty, full, int32, zeros

from orbiframe.compiled.decorator import compiled


@compiled
def find_twins(vertex_count, offsets, tail, twin, same):  # type: ignore[no-untyped-def]
    """Enter the twin of each halfedge, and whether it runs the same way, where exactly two have the same two ends."""
    start, far, half = _by_lower_end(vertex_count, offsets, tail)
    # Of each vertex: the last lower end it was met from, how often, and its first and last halfedge from there.
    seen, times = full(vertex_count, -1, int32), empty(vertex_count, int32)
    first, last = empty(vertex_count, int32), empty(vertex_count, int32)
    for vertex in range(vertex_count):
        for place in range(start[vertex], start[vertex + 1]):
            end = far[place]
            if seen[end] != vertex:
                seen[end], times[end], first[end] = vertex, 0, half[place]
            times[end] += 1
            last[end] = half[place]
        for place in range(start[vertex], start[vertex + 1]):
            end, h = far[place], half[place]
            if times[end] == 2:
                twin[h] = first[end] if h == last[end] else last[end]
                same[h] = tail[h] == tail[twin[h]]


@compiled
def _by_lower_end(vertex_count, offsets, tail):  # type: ignore[no-untyped-def]
    """Halfedges in order of the lower of their ends: where each vertex starts, the other end, the halfedge."""
    start = zeros(vertex_count + 2, int32)
    far, half = empty(len(tail), int32), empty(len(tail), int32)
    for face in range(len(offsets) - 1):
        before = tail[offsets[face + 1] - 1]
        for h in range(offsets[face], offsets[face + 1]):
            start[min(before, tail[h]) + 2] += 1
            before = tail[h]
    for vertex in range(vertex_count):
        start[vertex + 2] += start[vertex + 1]
    for face in range(len(offsets) - 1):
        for h in range(offsets[face], offsets[face + 1]):
            end = tail[h + 1] if h + 1 < offsets[face + 1] else tail[offsets[face]]
            place = start[min(tail[h], end) + 1]
            start[min(tail[h], end) + 1] += 1
            far[place], half[place] = max(tail[h], end), h
    return start, far, half
