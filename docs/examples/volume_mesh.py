"""Tetrahedra inside a smooth surface, curved at the boundary, by Gmsh: `pip install gmsh`, then

    orbiframe fit MESH -o fine.ply --save surface.npz
    orbiframe remesh surface.npz -o even.ply --edge-length H
    python volume_mesh.py surface.npz even.ply volume.msh --order 2

The triangles of even.ply become the boundary. Its nodes are put where the smooth surface is nearest, and nodes inside
are moved until no element is turned over; where that does not help, triangles there are halved, and all begins anew. An
element with a Jacobian that is not positive at last is an error, and so is a node of the boundary that is not on the
surface: nothing is written then.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import NamedTuple

import gmsh
import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from orbiframe import OrbifoldSurface, Polyhedron, read
from orbiframe.files import load_surface

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

# A node of the boundary lies on the surface if it is so near, in diagonals of the mesh.
NEAR = 1e-9
# So often triangles are halved where elements stay turned over.
ROUNDS = 6
# Elements are mended whose least Jacobian is below this share of the straight element's, with so many layers about
# them; the barrier rises so often at most, with so many steps each time.
ENOUGH, LAYERS, RISES, STEPS = 0.2, 2, 12, 60


class Volume(NamedTuple):
    """What was made.

    elements, nodes, triangles: how many, the last at the boundary; jacobian: the least ratio of the smallest and the
    largest Jacobian in an element; volume: of all; distance: the largest of a node of the boundary from the surface, in
    units of the mesh.
    """

    elements: int
    nodes: int
    triangles: int
    jacobian: float
    volume: float
    distance: float


def main() -> None:
    """Read the arguments, make the mesh, say what came out."""
    parser = argparse.ArgumentParser(description="tetrahedra inside a smooth surface, curved at the boundary")
    parser.add_argument("surface", type=Path, help="what `orbiframe fit --save` wrote")
    parser.add_argument("triangles", type=Path, help="what `orbiframe remesh` made of it")
    parser.add_argument("output", type=Path, help="volume.msh")
    parser.add_argument("--order", type=int, default=2, choices=(1, 2, 3, 4), help="of the elements; default 2")
    args = parser.parse_args()
    try:
        made = volume_mesh(load_surface(args.surface), read(args.triangles), args.output, args.order)
    except ValueError as error:
        sys.exit(f"volume_mesh: {error}")
    print(
        f"{made.elements} tetrahedra of order {args.order}, {made.nodes} nodes, {made.triangles} triangles at the "
        f"boundary; volume {made.volume:.6g}; Jacobians within elements at least 1 : {1 / made.jacobian:.3g}; boundary "
        f"within {made.distance:.1e} of the surface"
    )


def volume_mesh(surface: OrbifoldSurface, triangles: Polyhedron, output: Path, order: int = 2) -> Volume:
    """Write the tetrahedra inside a closed triangle mesh whose vertices lie on a surface.

    Raises ValueError for a mesh that bounds no solid, and where a Jacobian is not positive or a node is not on the
    surface.
    """
    if not surface.orbifold.orientable:
        raise ValueError("a nonorientable surface has no inside; take an orientable one")
    boundary = triangles
    gmsh.initialize()
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        for _ in range(ROUNDS):
            _fill(boundary)
            gmsh.model.mesh.setOrder(order)
            distance = _put_boundary_on(surface)
            bad = _turned(boundary) if order > 1 else np.zeros(0, dtype=np.int64)
            if not len(bad):
                break
            touched = np.isin(boundary.triangles, bad).all(axis=1)
            boundary = halved(
                surface, boundary, np.isin(np.arange(boundary.edge_count), boundary.edge.reshape(-1, 3)[touched])
            )
        made = Volume(*_counts(), boundary.face_count, *_quality(), distance)
        _require_sound(made, triangles.diagonal)
        gmsh.write(str(output))
    finally:
        gmsh.finalize()
    return made


# ---- the boundary ----------------------------------------------------------------------------------------------------


def halved(surface: OrbifoldSurface, mesh: Polyhedron, wanted: Bools) -> Polyhedron:
    """A triangle mesh with some edges (E,) halved; the longest edge of a triangle with such an edge is halved first."""
    edge, length, wanted = mesh.edge.reshape(-1, 3), _lengths(mesh), wanted.copy()
    first = length[edge].argmax(axis=1)
    row = np.arange(len(edge))
    while (missing := wanted[edge].any(axis=1) & ~wanted[edge[row, first]]).any():
        wanted[edge[row, first][missing]] = True
    points, _ = surface.nearest(mesh.vertices[_ends(mesh)[wanted]].mean(axis=1))
    new = np.where(wanted, len(mesh.vertices) + np.cumsum(wanted) - 1, -1)
    a, b, c = (mesh.triangles[row, (first + k) % 3] for k in range(3))
    ab, bc, ca = (new[edge[row, (first + k) % 3]] for k in range(3))
    cut, second, third = ab >= 0, (ab >= 0) & (bc >= 0), (ab >= 0) & (ca >= 0)
    parts = [
        (~cut, (a, b, c)),
        (second, (ab, b, bc)),
        (second, (ab, bc, c)),
        (cut & ~second, (ab, b, c)),
        (third, (a, ab, ca)),
        (third, (ca, ab, c)),
        (cut & ~third, (a, ab, c)),
    ]
    faces = np.concatenate([np.stack(corners, axis=1)[which] for which, corners in parts])
    return Polyhedron.from_faces(np.concatenate([mesh.vertices, surface.evaluate(points)]), faces)


def _ends(mesh: Polyhedron) -> Ints:
    """The two vertices of every edge, (E, 2)."""
    half = np.flatnonzero(mesh.representative)
    return np.stack([mesh.tail[half], mesh.head[half]], axis=1)


def _lengths(mesh: Polyhedron) -> Floats:
    return np.asarray(np.linalg.norm(np.diff(mesh.vertices[_ends(mesh)], axis=1)[:, 0], axis=1))


# ---- the inside ------------------------------------------------------------------------------------------------------


def _fill(boundary: Polyhedron) -> None:
    """A discrete surface of the triangles, and tetrahedra inside, about as large as the triangles."""
    gmsh.clear()
    gmsh.model.add("volume")
    face = gmsh.model.addDiscreteEntity(2)
    gmsh.model.mesh.addNodes(2, face, np.arange(1, len(boundary.vertices) + 1), boundary.vertices.ravel())
    gmsh.model.mesh.addElementsByType(face, 2, [], boundary.triangles.ravel() + 1)
    gmsh.model.geo.addVolume([gmsh.model.geo.addSurfaceLoop([face])])
    gmsh.model.geo.synchronize()
    gmsh.option.setNumber("Mesh.MeshSizeMax", float(_lengths(boundary).max()))
    try:
        gmsh.model.mesh.generate(3)
        gmsh.model.mesh.optimize("Netgen")
    except Exception as error:
        raise ValueError(
            f"Gmsh makes no tetrahedra of these triangles ({error}): they may pass through each other; remesh with a "
            "smaller --edge-length, or fit with a larger --size"
        ) from error


def _put_boundary_on(surface: OrbifoldSurface) -> float:
    """Move the new nodes of the boundary to the nearest points of the surface; how far all are from it then."""
    tags, where, _ = gmsh.model.mesh.getNodes(2, includeBoundary=True)
    points, _ = surface.nearest(where.reshape(-1, 3))
    on = surface.evaluate(points)
    for tag, place in zip(tags, on, strict=True):
        gmsh.model.mesh.setNode(tag, place, [])
    return float(surface.distance(on).max())


def _turned(boundary: Polyhedron) -> Ints:
    """Move nodes inside near elements that are turned over; the vertices of the boundary near those that stay so.

    The functional of Toulorge, Geuzaine, Remacle and Lambrechts (Robust untangling of curvilinear meshes, 2013): the
    ratio of each Jacobian to that of the straight element is kept near 1 and above a barrier, which rises with the
    least of them.
    """
    elements = Elements.read()
    if elements is None:
        return np.zeros(0, dtype=np.int64)
    elements.untangle()
    for tag, place in zip(elements.tags[elements.free], elements.where[elements.free], strict=True):
        gmsh.model.mesh.setNode(tag, place, [])
    (_,), (tags,), (nodes,) = gmsh.model.mesh.getElements(3)
    bad = ~(np.asarray(gmsh.model.mesh.getElementQualities(tags, "minDetJac")) > 0)
    corners = nodes.reshape(len(tags), -1)[bad, :4].astype(np.int64) - 1
    return np.unique(corners[corners < len(boundary.vertices)])


class Elements(NamedTuple):
    """Elements near those that are turned over.

    tags, where: of their nodes, and their places, (n, 3); nodes: (e, k), of each element; free: the nodes that may
    move; slopes: of the shape functions at points of an element, (p, k, 3); straight: the Jacobian of each element with
    straight sides, (e,).
    """

    tags: Ints
    where: Floats
    nodes: Ints
    free: Ints
    slopes: Floats
    straight: Floats

    @classmethod
    def read(cls) -> Elements | None:
        """Those with a bad Jacobian, turned over or not, and all within so many layers; None where all are good."""
        (kind,), (tags,), (listed,) = gmsh.model.mesh.getElements(3)
        bad = np.asarray(gmsh.model.mesh.getElementQualities(tags, "minSJ")) < ENOUGH
        if not bad.any():
            return None
        nodes = listed.reshape(len(tags), -1).astype(np.int64)
        for _ in range(LAYERS):
            bad = np.isin(nodes[:, :4], nodes[bad][:, :4]).any(axis=1)
        every, where, _ = gmsh.model.mesh.getNodes()
        place = np.zeros((int(every.max()) + 1, 3))
        place[every.astype(np.int64)] = where.reshape(-1, 3)
        outer = gmsh.model.mesh.getNodes(2, includeBoundary=True)[0].astype(np.int64)
        held = np.concatenate([outer, nodes[~bad].ravel()])
        used, local = np.unique(nodes[bad], return_inverse=True)
        _, _, order, _, corners, _ = gmsh.model.mesh.getElementProperties(kind)
        points = np.concatenate([gmsh.model.mesh.getIntegrationPoints(kind, f"Gauss{3 * order}")[0], corners])
        slopes = gmsh.model.mesh.getBasisFunctions(kind, points, "GradLagrange")[1].reshape(len(points) // 3, -1, 3)
        nodes = local.reshape(int(bad.sum()), -1)
        sides = place[used][nodes[:, 1:4]] - place[used][nodes[:, :1]]
        return cls(used, place[used], nodes, np.flatnonzero(~np.isin(used, held)), slopes, np.linalg.det(sides))

    def untangle(self) -> None:
        """Move the free nodes, in place."""
        barrier = -np.inf
        for _ in range(RISES):
            least = float((np.linalg.det(self._matrices(self.where)) / self.straight[:, None]).min())
            if least >= ENOUGH:
                return
            if barrier > -np.inf and least < barrier + 0.02:
                return
            barrier = least - max(0.1 * abs(least), 0.05)
            start = self.where[self.free].ravel()
            found = minimize(self.energy, start, (barrier,), method="L-BFGS-B", jac=True, options={"maxiter": STEPS})
            self.where[self.free] = found.x.reshape(-1, 3)

    def energy(self, moved: Floats, barrier: float) -> tuple[float, Floats]:
        """The functional and its slope for places of the free nodes, flat."""
        where = self.where.copy()
        where[self.free] = moved.reshape(-1, 3)
        matrices = self._matrices(where)
        ratio = np.linalg.det(matrices) / self.straight[:, None]
        if ratio.min() <= barrier:
            return 1e12, np.zeros_like(moved)
        log = np.log((ratio - barrier) / (1 - barrier))
        factor = (2 * log / (ratio - barrier) + 2 * (ratio - 1)) / self.straight[:, None]
        a, b, c = np.moveaxis(matrices, 2, 0)
        cofactors = np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)], axis=2) * factor[..., None, None]
        total = np.zeros_like(where)
        np.add.at(total, self.nodes, np.einsum("epji,pkj->eki", cofactors, self.slopes, optimize=True))
        return float((log**2 + (ratio - 1) ** 2).sum()), total[self.free].ravel()

    def _matrices(self, where: Floats) -> Floats:
        """The derivatives dx / dxi of each element at each point, (e, p, 3, 3), rows xi."""
        return np.asarray(np.einsum("pkj,eki->epji", self.slopes, where[self.nodes], optimize=True))


# ---- what came out ---------------------------------------------------------------------------------------------------


def _counts() -> tuple[int, int]:
    elements = sum(len(tags) for tags in gmsh.model.mesh.getElements(3)[1])
    return elements, len(gmsh.model.mesh.getNodes()[0])


def _quality() -> tuple[float, float]:
    """The least ratio of the smallest and the largest Jacobian in an element, and the volume of all."""
    (kind,), (tags,), _ = gmsh.model.mesh.getElements(3)
    least, most = (gmsh.model.mesh.getElementQualities(tags, name) for name in ("minDetJac", "maxDetJac"))
    points, weights = gmsh.model.mesh.getIntegrationPoints(kind, "Gauss8")
    _, determinants, _ = gmsh.model.mesh.getJacobians(kind, points)
    return float(np.min(least / most)), float((determinants.reshape(-1, len(weights)) @ weights).sum())


def _require_sound(made: Volume, diagonal: float) -> None:
    if not made.jacobian > 0:
        raise ValueError(
            f"the least Jacobian is {made.jacobian:.2g}, so an element is turned over; remesh with a smaller "
            "--edge-length"
        )
    if not made.distance <= NEAR * diagonal:
        raise ValueError(f"a node of the boundary is {made.distance:.2g} away from the surface; please report it")


if __name__ == "__main__":
    main()
