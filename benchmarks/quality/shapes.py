"""Shapes: closed meshes, and the smooth surfaces that they are samples of, where there are any."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import product
from pathlib import Path

import numpy as np
import pymeshlab
from numpy.typing import NDArray

from orbiframe import Polyhedron, Registry, read
from orbiframe.meshes import orient, refine, triangulated
from quality import charts, fields
from quality.truths import Level, Truth

Floats = NDArray[np.float64]

ROOT = Path(__file__).parents[2]
SHARED = ROOT.parent / "shared"
_NOISE = 0.002


@dataclass(frozen=True)
class Shape:
    """A mesh by name. kind: the heading that it stands under.

    truth: the surface in closed form on which its vertices lie, if any; finer: a mesh of which it has some vertices.
    Where there is neither, its own faces are all that is known.
    """

    name: str
    kind: str
    mesh: Callable[[], Polyhedron]
    truth: Truth | None = None
    finer: Callable[[], Polyhedron] | None = None

    @property
    def meant(self) -> str:
        """What the mesh is: "scan", "smooth" where its vertices are samples of a smooth shape, or "faces"."""
        if self.kind == "scan":
            return "scan"
        return "smooth" if self.truth is not None or self.kind == "organic" else "faces"


def _level(field: fields.Field, reach: tuple[float, float, float], step: float) -> Level:
    high = np.array(reach)
    return Level(field, -high, high, step)


PAIR = _level(fields.melted_tori([(-1.2, 0), (1.2, 0)]), (2.9, 1.7, 0.7), 0.05)
CROSS = _level(fields.melted_tori([(0, 0), (2.4, 0), (-2.4, 0), (0, 2.4), (0, -2.4)]), (4.1, 4.1, 0.7), 0.06)
RING = _level(
    fields.melted_tori([(1.3 * np.cos(t), 1.3 * np.sin(t)) for t in np.arange(3) * 2 * np.pi / 3]),
    (3.0, 3.0, 0.7),
    0.06,
)
TANGLE = _level(fields.tanglecube, (3, 3, 3), 0.08)
SCHWARZ = _level(fields.schwarz, (6.6, 6.6, 6.6), 0.18)
STARFISH = _level(fields.starfish, (2.5, 2.5, 1.3), 0.05)
BLOB = _level(fields.blob, (2.5, 2.5, 2.5), 0.06)
ELLIPSOID = _level(fields.ellipsoid(1, 0.7, 0.5), (1.1, 0.8, 0.6), 0.02)
SPHERE = _level(fields.ellipsoid(1, 1, 1), (1.1, 1.1, 1.1), 0.03)


def _thinned(truth: Level, step: float, count: int) -> Polyhedron:
    """A net with edges collapsed until so many vertices are left: irregular."""
    thin = _collapsed(triangulated(truth.net(step)), count)
    return thin.with_vertices(truth.onto(thin.vertices))


def _collapsed(mesh: Polyhedron, count: int) -> Polyhedron:
    meshes = pymeshlab.MeshSet(verbose=False)
    meshes.add_mesh(pymeshlab.Mesh(mesh.vertices, mesh.triangles))
    faces = mesh.face_count - 2 * (len(mesh.vertices) - count)
    meshes.meshing_decimation_quadric_edge_collapse(
        targetfacenum=faces,
        preservetopology=True,
        qualitythr=1.0,
        planarquadric=True,
        planarweight=0.01,
        optimalplacement=False,
    )
    found = meshes.current_mesh()
    return Polyhedron.from_faces(found.vertex_matrix(), found.face_matrix().astype(np.intp))


def _halved(mesh: Polyhedron) -> Polyhedron:
    """Quadrilaterals cut alike, from the first corner."""
    a, b, c, d = mesh.tail.reshape(-1, 4).T
    return Polyhedron.from_faces(mesh.vertices, np.concatenate([np.stack(f, axis=1) for f in ((a, b, c), (a, c, d))]))


def _thinned_file(name: str, file: str, count: int) -> Shape:
    """A mesh of some vertices of another one, edges collapsed onto one of their ends."""
    finer = _file("meshes", file)
    return Shape(name, "organic", lambda: _collapsed(triangulated(finer()), count), finer=finer)


def _noisy(mesh: Polyhedron, share: float = _NOISE) -> Polyhedron:
    """Every vertex moved at random, by a share of the diagonal in every direction (standard deviation)."""
    noise = np.random.default_rng(11).normal(size=mesh.vertices.shape)
    return mesh.with_vertices(mesh.vertices + share * mesh.diagonal * noise)


def _file(folder: str, name: str) -> Callable[[], Polyhedron]:
    def load() -> Polyhedron:
        mesh = read(SHARED / folder / name, Registry.discover())
        return orient(mesh).polyhedron if name.startswith("blobby") else mesh

    return load


def _voxels(inside: Callable[[Floats], NDArray[np.bool_]], side: int) -> Polyhedron:
    """The boundary of those of the side^3 cubes of (-1, 1)^3 whose centres are inside, as squares."""
    grid = np.array(list(product(range(side), repeat=3)))
    full = np.zeros((side + 2,) * 3, bool)
    full[1:-1, 1:-1, 1:-1] = inside((2 * grid + 1) / side - 1).reshape((side,) * 3)
    squares = []
    for axis, ahead in product(range(3), (False, True)):
        step = np.eye(3, dtype=int)[axis] * (1 if ahead else -1)
        cell = np.argwhere(full & ~np.roll(full, -step, axis=(0, 1, 2)))
        u, v = np.eye(3, dtype=int)[[(axis + 1) % 3, (axis + 2) % 3]]
        base = cell + np.eye(3, dtype=int)[axis] * ahead
        ring = np.stack([base, base + u, base + u + v, base + v], axis=1)
        squares.append(ring if ahead else ring[:, ::-1])
    corners, index = np.unique(np.concatenate(squares).reshape(-1, 3), axis=0, return_inverse=True)
    return Polyhedron.from_faces(corners.astype(float), index.reshape(-1, 4))


def _plate(rows: int, columns: int, density: int) -> Polyhedron:
    """A plate with square holes."""
    cells = {(i, j) for i, j in product(range(2 * rows + 1), range(2 * columns + 1)) if not (i % 2 and j % 2)}
    side = 2 * max(rows, columns) + 1

    def inside(x: Floats) -> NDArray[np.bool_]:
        cell = np.floor((x + 1) / 2 * side).astype(int)
        return np.array([(i, j) in cells and k == 0 for i, j, k in cell])

    return refine(triangulated(_voxels(inside, side)), density).polyhedron


def _round_voxels(x: Floats) -> NDArray[np.bool_]:
    return np.asarray(np.linalg.norm(x, axis=1) < 0.85)


def _torus_voxels(x: Floats) -> NDArray[np.bool_]:
    return np.asarray(np.hypot(np.hypot(x[:, 0], x[:, 1]) - 0.62, x[:, 2]) < 0.3)


def _stairs(x: Floats) -> NDArray[np.bool_]:
    return np.asarray(x[:, 2] < np.floor(2 * x[:, 0]) / 2 + 0.1)


SHAPES = (
    Shape("torus 12 x 8", "smooth", lambda: charts.wound(charts.torus, 12, 8), charts.TORUS),
    Shape("torus 24 x 12", "smooth", lambda: charts.wound(charts.torus, 24, 12), charts.TORUS),
    Shape("torus 24 x 12, triangles", "smooth", lambda: _halved(charts.wound(charts.torus, 24, 12)), charts.TORUS),
    Shape("torus 288 irregular", "smooth", lambda: charts.scattered_torus(288), charts.TORUS),
    Shape("torus 1000 irregular", "smooth", lambda: charts.scattered_torus(1000), charts.TORUS),
    Shape("sphere 162", "smooth", lambda: charts.icosphere(4), SPHERE),
    Shape("ellipsoid 642 irregular", "smooth", lambda: charts.scattered_ellipsoid(642, 1, 0.7, 0.5), ELLIPSOID),
    Shape("genus 2, 1000", "smooth", lambda: PAIR.net(0.2), PAIR),
    Shape("genus 2, 600 irregular", "smooth", lambda: _thinned(PAIR, 0.08, 600), PAIR),
    Shape("genus 2, 9000", "smooth", lambda: PAIR.net(0.07), PAIR),
    Shape("genus 3, 1500", "smooth", lambda: RING.net(0.2), RING),
    Shape("genus 5, 1000", "smooth", lambda: CROSS.net(0.28), CROSS),
    Shape("genus 5, 7000", "smooth", lambda: CROSS.net(0.12), CROSS),
    Shape("tanglecube", "smooth", lambda: TANGLE.net(0.3), TANGLE),
    Shape("Schwarz P", "smooth", lambda: SCHWARZ.net(0.6), SCHWARZ),
    Shape("blob", "smooth", lambda: BLOB.net(0.15), BLOB),
    Shape("starfish 1500 irregular", "smooth", lambda: _thinned(STARFISH, 0.05, 1500), STARFISH),
    Shape("knotted tube", "smooth", lambda: charts.wound(charts.knotted_tube, 120, 10), charts.KNOT),
    Shape("Boy's surface", "one-sided", lambda: charts.boy_mesh(10), charts.BOY),
    Shape(
        "figure-eight bottle",
        "one-sided",
        lambda: charts.wound(charts.figure_eight_bottle, 40, 20, True),
        charts.FIGURE_EIGHT,
    ),
    Shape("Lawson's bottle", "one-sided", lambda: charts.wound(charts.lawson_bottle, 32, 32, True), charts.LAWSON),
    Shape("crosscap on a torus", "one-sided", _file("meshes", "crosscap_torus_k1.off")),
    Shape("three crosscaps", "one-sided", _file("meshes", "crosscap_sphere_k3.off")),
    Shape("scan of a torus", "scan", lambda: _noisy(charts.scattered_torus(2000)), charts.TORUS),
    Shape("scan of an ellipsoid", "scan", lambda: _noisy(charts.scattered_ellipsoid(1500, 1, 0.7, 0.5)), ELLIPSOID),
    Shape("scan of genus 2", "scan", lambda: _noisy(PAIR.net(0.12)), PAIR),
    Shape("scan of a starfish", "scan", lambda: _noisy(_thinned(STARFISH, 0.05, 3000), 0.001), STARFISH),
    Shape("eight", "organic", _file("meshes", "eight.off")),
    Shape("bob", "organic", _file("meshes", "gc_bob_small.ply")),
    _thinned_file("spot, 700 of 2930", "gc_spot.ply", 700),
    Shape("spot, a cage", "organic", _file("meshes", "odedstein_spot_control.obj")),
    _thinned_file("skull, 1300 of 5154", "odedstein_skull_low.obj", 1300),
    _thinned_file("knot, 800 of 3200", "knot1.off", 800),
    _thinned_file("blobby, 500 of 2027", "blobby-shuffled.off", 500),
    Shape("fox", "low polygons", _file("cases/meshes", "fox.off")),
    Shape("finger", "low polygons", _file("cases/meshes", "finger.off")),
    Shape("star", "low polygons", _file("meshes", "star.off")),
    Shape("cube", "boxes", lambda: _plate(0, 0, 3)),
    Shape("plate, genus 2", "boxes", _file("meshes", "plate_g2_q.off")),
    Shape("plate, genus 2, 198", "boxes", _file("meshes", "plate_g2_q_sub1.off")),
    Shape("plate, genus 4", "boxes", lambda: _plate(2, 2, 2)),
    Shape("plate, genus 10", "boxes", _file("meshes", "plate_g10_q.off")),
    Shape("cross", "boxes", _file("meshes", "cross_quad.off")),
    Shape("letter P", "boxes", _file("meshes", "P.off")),
    Shape("chamfered cube", "CAD", _file("cases/meshes", "chamfer_cube.off")),
    Shape("cylinder", "CAD", _file("cases/meshes", "cylinder_ngon_caps.off")),
    Shape("flange", "CAD", _file("cases/meshes", "flange.off")),
    Shape("anchor", "CAD", _file("meshes", "anchor.off")),
    Shape("rotor", "CAD", _file("meshes", "rotor.off")),
    Shape("plate with holes", "CAD", _file("meshes", "trimesh_plate_holes.STL")),
    Shape("voxels of a ball", "voxels", lambda: _voxels(_round_voxels, 9)),
    Shape("voxels of a torus", "voxels", lambda: _voxels(_torus_voxels, 14)),
    Shape("stairs", "voxels", lambda: _voxels(_stairs, 8)),
)
QUICK = ("torus 12 x 8", "torus 24 x 12", "Boy's surface", "scan of a torus", "cube", "voxels of a ball")
