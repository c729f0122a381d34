"""Exact patches: they are the surface, share their edges as it does, and look outward."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import spline_checks as checks
from exact_surfaces import REGISTRY, at_lattice, on_cells, surface_of
from orbiframe_bases.bernstein import Bernstein
from orbiframe_bases.powell_sabin import PowellSabin2

from orbiframe import FitError
from orbiframe.functions.samples import coordinate_samples
from orbiframe.meshes.face_diagonals import triangulated
from orbiframe.meshes.orientation import reversed_faces
from orbiframe.surfaces import PeriodicPatch, patches_of
from orbiframe.surfaces.patch_gluing import alike, quartered
from orbiframe.surfaces.periodic_patch import _pieces
from orbiframe.surfaces.triangle_patches import triangle_patches
from orbiframe.testing.polyhedra import reference_polyhedra
from orbiframe.triangulations import GeodesicTriangulation

SURFACES = ["tetrahedron", "projective plane", "torus", "Klein bottle", "double torus"]
FAMILIES = [
    ("ps2", {}),
    ("ps3", {}),
    ("ps6", {}),
    ("bernstein", {"degree": 3}),
    ("bernstein", {"degree": 4, "size": 400}),
]
TENSORS = [
    {"degree": 3, "counts": (7, 6)},
    {"degree": 2, "knots_u": (0.1, 0.1, 0.4, 0.7), "knots_v": (0.2, 0.5, 0.8)},
    {"degree": 1, "counts": (5, 4)},
    {"degree": 3, "knots_u": (0.0, 0.3, 0.3, 0.8), "knots_v": (0.0, 0.0, 0.3, 0.7)},
    {"degree": 3, "counts": (2, 1)},
]
each_surface = pytest.mark.parametrize("name", SURFACES)


def options_id(options: dict) -> str:
    return " ".join(f"{key}={value}" for key, value in options.items())


# ---- triangles ------------------------------------------------------------------------------------------------------


@each_surface
@pytest.mark.parametrize(("family", "options"), FAMILIES, ids=[f"{f} {options_id(o)}" for f, o in FAMILIES])
def test_patches_are_the_surface(name, family, options):
    """At random points of all micro triangles, whose corners a patch may have in the other order."""
    surface = surface_of(name, family, **options)
    patches = patches_of(surface)
    inside = np.random.default_rng(1).dirichlet([1, 1, 1], size=5)
    straight, turned = on_cells(surface, inside), on_cells(surface, inside[:, [0, 2, 1]])
    found = patches.evaluate(inside)
    error = np.minimum(np.abs(found - straight).max(axis=(1, 2)), np.abs(found - turned).max(axis=(1, 2)))
    assert error.max() < 1e-12 * np.abs(patches.points).max()
    assert (patches.weights > 0).all()


@each_surface
@pytest.mark.parametrize("family", ["ps2", "ps6"])
def test_quadrilaterals_are_the_triangles(name, family):
    """The map of quadrilateral c is bilinear between corner, middles and centroid."""
    patches = patches_of(surface_of(name, family))
    s, t = np.random.default_rng(2).random((2, 4))
    found = patches.quadrilaterals().evaluate(s, t).reshape(-1, 3, 4, 3)
    corners = np.eye(3)
    for c in range(3):
        after, before = (corners[c] + corners[(c + 1) % 3]) / 2, (corners[c] + corners[(c + 2) % 3]) / 2
        shares = (1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t
        places = corners[c], after, np.full(3, 1 / 3), before
        inside = sum(np.outer(w, place) for w, place in zip(shares, places, strict=True))
        assert np.abs(found[:, c] - patches.evaluate(inside)).max() < 1e-12


@each_surface
def test_orientable_surfaces_look_outward(name):
    """The volume by the divergence theorem, on points of the patches, is positive; so it is for a mirror image."""
    surface = surface_of(name, "ps2")
    for one in (surface, replace(surface, coefficients=surface.coefficients * [-1, 1, 1])):
        quads = patches_of(one).quadrilaterals()
        assert quads.gluing.same.any() != one.orbifold.orientable
        if one.orbifold.orientable:
            assert volume(quads) > 0
            assert volume(quads) == pytest.approx(quads.volume, rel=0.02)
        require_watertight(quads)


def volume(quads, count: int = 12) -> float:
    grid = np.linspace(0, 1, count)
    s, t = (a.ravel() for a in np.meshgrid(grid, grid, indexing="ij"))
    p = quads.evaluate(s, t).reshape(-1, count, count, 3)
    a, b, c, d = p[:, :-1, :-1], p[:, 1:, :-1], p[:, 1:, 1:], p[:, :-1, 1:]
    return float((np.cross(a, b) * c).sum() + (np.cross(a, c) * d).sum()) / 6


def require_watertight(quads) -> None:
    """Border curves of twins are one curve, run the other way unless `same` says otherwise."""
    x, zero = np.linspace(0, 1, 7), np.zeros(7)
    sides = [quads.evaluate(*pair) for pair in ((x, zero), (zero + 1, x), (1 - x, zero + 1), (zero, 1 - x))]
    curves = np.stack(sides, axis=1).reshape(-1, 7, 3)
    twin, same = quads.gluing
    assert (twin[twin] == np.arange(len(twin))).all()
    assert (same[twin] == same).all()
    assert (twin != np.arange(len(twin))).all()
    beyond = np.where(same[:, None, None], curves[twin], curves[twin][:, ::-1])
    assert np.abs(curves - beyond).max() < 1e-12 * np.abs(curves).max()


@pytest.mark.parametrize("name", list(checks.MAKERS))
def test_gluing_has_the_topology_of_the_surface(name):
    """Vertices less edges plus patches is the Euler characteristic, on domains with one vertex too."""
    domain = checks.domain(name)
    chi = domain.orbifold.euler_characteristic
    for basis in (PowellSabin2(domain.orbifold, domain), Bernstein(domain.orbifold, domain, degree=2)):
        random = np.random.default_rng(5).normal(size=(basis.size, 3))
        made = replace(surface_of("tetrahedron", "ps2"), basis=basis, coefficients=random)
        triangles = triangle_patches(made, basis).gluing
        for gluing, corners in ((triangles, 3), (quartered(triangles), 4)):
            vertices, sides = gluing.corner_classes(corners).max() + 1, len(gluing.twin)
            assert vertices - sides // 2 + sides // corners == chi
        assert triangles.same.any() != domain.orbifold.orientable


@pytest.mark.parametrize("name", ["tetrahedron", "torus", "double torus"])
def test_triangles_in_mirrored_frames_make_the_same_surface(name):
    """Seen in a mirror a triangle runs the other way, so that some gluings reverse on an orientable surface too."""
    surface = surface_of(name, "ps2")
    chosen = np.random.default_rng(7).random(surface.basis.domain.face_count) < 0.4
    domain = mirrored(surface.basis.domain, chosen)
    assert domain.same.any()
    assert domain.gluing_defect < 1e-9
    basis = PowellSabin2(surface.orbifold, domain)
    fitter = REGISTRY.load("fitter", "least-squares")()
    fitted = fitter.fit(basis, coordinate_samples(surface.triangulation))
    patches = patches_of(replace(surface, basis=basis, coefficients=fitted))
    assert not patches.gluing.same.any()
    quads = patches.quadrilaterals()
    require_watertight(quads)
    assert quads.volume == pytest.approx(patches_of(surface).quadrilaterals().volume, rel=1e-6)


def mirrored(domain: GeodesicTriangulation, chosen: np.ndarray) -> GeodesicTriangulation:
    """The same triangles, the chosen ones in frames that are mirrored: corners 0, 2, 1, and sides the other way."""
    mirror = np.where(chosen[:, None, None], np.diag([1.0, 1.0, -1.0]), np.eye(3))
    halfedge = np.arange(3 * domain.face_count)
    old = np.where(np.repeat(chosen, 3), 3 * (halfedge // 3) + 2 - halfedge % 3, halfedge)
    twin = domain.twin[old]
    here, there = halfedge // 3, twin // 3
    corner = np.where(chosen[:, None], [0, 2, 1], [0, 1, 2])
    return replace(
        domain,
        corners=np.take_along_axis(domain.corners, corner[..., None], 1) @ mirror,
        twin=old[twin],
        same=domain.same[old] ^ chosen[here] ^ chosen[there],
        gluing=mirror[here] @ domain.gluing[old] @ mirror[there],
        placement=domain.placement @ mirror,
    )


@pytest.mark.parametrize("name", ["double torus", "projective plane"])
def test_signs_undo_turned_faces(name):
    mesh = triangulated(reference_polyhedra()[name])
    flip = np.random.default_rng(3).random(mesh.face_count) < 0.4
    turned = reversed_faces(mesh, flip)
    sign = alike(turned.twin, turned.same)
    if name == "double torus":
        assert np.array_equal(sign * sign[0], np.where(flip, -1, 1) * (1 - 2 * flip[0]))
    else:
        assert (sign == 1).all()


def test_functions_without_patches_are_refused():
    with pytest.raises(FitError, match="neither polynomials on triangles nor tensor products"):
        patches_of(surface_of("tetrahedron", "gaussian", size=30))


def test_weights_that_are_not_positive_are_refused():
    """On an octant the weight of an edge is the cosine of a right angle."""
    domain = checks.sphere()
    surface = surface_of("tetrahedron", "ps2")
    basis = Bernstein(domain.orbifold, domain, degree=2)
    with pytest.raises(FitError, match="weight 4 of micro triangle 0 of triangle 0"):
        triangle_patches(replace(surface, basis=basis, coefficients=np.ones((basis.size, 3))), basis)


# ---- tensor products ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["torus", "Klein bottle"])
@pytest.mark.parametrize("options", TENSORS, ids=options_id)
def test_periodic_patches_are_the_surface(name, options):
    """Bezier pieces at random parameters, where knots are repeated too; on the Klein bottle each part once."""
    if name == "Klein bottle" and "knots_v" in options:
        options = {**options, "knots_v": (0.0, 0.0, 0.3, 0.7) if options["degree"] == 3 else (0.2, 0.5, 0.8)}
    surface = surface_of(name, "tensor-bspline", **options)
    patch = patches_of(surface)
    assert isinstance(patch, PeriodicPatch)
    pieces = patch.quadrilaterals()
    s, t = np.random.default_rng(4).random((2, 3))
    ends = [np.append(np.unique(k), k[0] + p) for k, p in zip(patch.knots, patch.periods, strict=True)]
    rows = len(pieces.points) // (len(ends[1]) - 1)
    u = ends[0][:rows, None] + np.diff(ends[0])[:rows, None] * s
    v = ends[1][:-1, None] + np.diff(ends[1])[:, None] * t
    both = np.broadcast_arrays(u[:, None], v[None])
    place = np.stack(both, axis=-1).reshape(-1, 2)
    straight, turned = at_lattice(surface, place), at_lattice(surface, place[:, ::-1])
    found = pieces.evaluate(s, t).reshape(-1, 3)
    error = min(np.abs(found - straight).max(), np.abs(found - turned).max())
    assert error < 1e-12
    require_watertight(pieces)
    vertices, sides = pieces.gluing.corner_classes(4).max() + 1, len(pieces.gluing.twin)
    assert vertices - sides // 2 + sides // 4 == 0
    assert pieces.gluing.same.any() == (name == "Klein bottle")
    if name == "torus" and min(patch.points.shape[:2]) > 3:
        assert volume(pieces) > 0


def test_pieces_add_up_to_one():
    forms = _pieces(np.array([0.0, 0.25, 0.25, 0.5]), 3, 1.0)
    assert forms.shape == (3, 4, 4)
    assert np.abs(forms.sum(axis=2) - 1).max() < 1e-14
