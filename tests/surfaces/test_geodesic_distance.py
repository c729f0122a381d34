"""Geodesic distance on surfaces that are hard for it."""

from __future__ import annotations

import numpy as np
from fitted import REGISTRY, mesh_of
from scipy.sparse import coo_array
from scipy.sparse.csgraph import dijkstra

from orbiframe import fit
from orbiframe.surfaces import geodesic_distance


def test_it_ends_on_a_surface_that_passes_through_itself():
    """A torus of seven vertices, whose fine triangles are blunt and folded: between the chord and the way by edges."""
    surface = fit(mesh_of("torus"), registry=REGISTRY, progress=False, basis={"name": "ps6", "size": 200}).surface
    source = surface.origin + surface.scale * surface.refinement.coarse.vertices[:1]
    found = geodesic_distance(surface, source, triangles=150_000)
    mesh, begin = found.mesh, surface.evaluate(surface.nearest(source)[0])[0]
    chord = np.linalg.norm(mesh.vertices - begin, axis=1)
    nearest = int(chord.argmin())
    edges = coo_array((mesh.edge_lengths, (mesh.tail, mesh.head))).tocsr()
    by_edges = dijkstra(edges, indices=nearest) + chord[nearest]
    assert (found.values >= chord * (1 - 1e-9)).all()
    assert (found.values <= by_edges * (1 + 1e-9) + 1e-12).all()
