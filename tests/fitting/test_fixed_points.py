"""Fixed points: met exactly with their normals, the rest as before, and refused where they make no sense."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from fitted import REGISTRY, mesh_of
from open_shapes import cylinder

from orbiframe import ConfigError, FitError, UsageError, fit, read
from orbiframe.functions import joined
from orbiframe.functions.samples import Samples
from orbiframe.meshes.unions import disjoint_union
from orbiframe.orbifolds.atlas import Points

PLATE = read(Path(__file__).parents[2] / "datasets" / "plate_genus2.off", REGISTRY)
POINT, OTHER, NORMAL = [0.5, 0.5, 1.1], [2.5, 1.5, 1.0], [0.2, 0.0, 1.0]


def pinned(mesh, *fixed, **settings):
    return fit(mesh, registry=REGISTRY, progress=False, data={"fixed": list(fixed)}, **({"size": 150} | settings))


@pytest.mark.parametrize("fitter", ["sliding", "smoothing", "robust"])
@pytest.mark.parametrize("basis", ["gaussian", "ps2"])
def test_points_and_normals_are_met(fitter, basis):
    settings = {"basis": {"name": basis}, "fitter": fitter}
    result = pinned(PLATE, POINT, [*OTHER, *NORMAL], **settings)
    surface = result.surface
    feet, distance = surface.nearest(np.array([POINT, OTHER]))
    assert distance.max() < 1e-10 * PLATE.diagonal
    turned = np.cross(surface.normals(feet)[1], np.array(NORMAL) / np.linalg.norm(NORMAL))
    assert np.linalg.norm(turned) < 1e-7
    assert result.report["data"]["fixed"] == 2


def test_far_from_them_the_surface_is_that_without():
    free, held = pinned(PLATE).surface, pinned(PLATE, POINT).surface
    there = held.evaluate(held.vertex_points)
    away = np.linalg.norm(there - free.evaluate(free.vertex_points), axis=1)
    near = np.linalg.norm(there - POINT, axis=1)
    assert away[near < 0.2].max() > 0.05
    assert away[near > 2.0].max() < 1e-2


def test_on_a_mesh_with_a_boundary():
    mesh = cylinder()
    place = mesh.vertices[mesh.tail[mesh.face == 40]].mean(axis=0) * 1.03
    surface = pinned(mesh, place.tolist(), boundary="auto").surface
    assert surface.distance(place[None])[0] < 1e-10 * mesh.diagonal


def test_two_heights_over_one_place_contradict():
    with pytest.raises(FitError, match=r"fixed point [01] and [01], which pull apart"):
        pinned(PLATE, [0.5, 0.5, 1.1], [0.5, 0.5, 1.2])


def test_least_squares_alone_names_the_others():
    with pytest.raises(FitError, match=r"'sliding'.*fitter\.name"):
        pinned(PLATE, POINT, fitter="least-squares")


@pytest.mark.parametrize(
    ("fixed", "said"),
    [
        ([[0, 0]], "fixed"),
        ([[0.0, 0.0, float("nan")]], "finite"),
        ([POINT, [*OTHER, 0, 0, 0]], "point 1.*normal"),
        ([[40.0, 0.0, 0.0]], "point 0.*diagonals away.*unit"),
    ],
)
def test_points_that_make_no_sense_are_refused(fixed, said):
    with pytest.raises(ConfigError, match=said):
        pinned(PLATE, *fixed)


def test_they_are_of_one_component():
    two = disjoint_union([mesh_of("cube"), mesh_of("cube")])
    from orbiframe.fitting import fit_parts

    with pytest.raises(UsageError, match=r"data\.fixed.*--component"):
        fit_parts(two, registry=REGISTRY, progress=False, data={"fixed": [POINT]})


def test_samples_are_joined_with_what_only_some_know():
    points = Points(np.zeros(2, dtype=np.intp), np.tile([1.0, 0, 0], (2, 1)))
    numbers = np.zeros((2, 3)), np.ones(2), np.ones(2)
    one = Samples(points, *numbers, length=np.full(2, 0.5), order=3, still=np.array([True, False]))
    other = Samples(points, *numbers, fixed=np.array([True, True]), normals=np.eye(3)[:2])
    both = joined(one, other)
    assert both.still.tolist() == [True, False, False, False]
    assert both.fixed.tolist() == [False, False, True, True]
    assert both.length.tolist() == [0.5, 0.5, 0, 0]
    assert both.order == 3
    assert both.held is None
    np.testing.assert_array_equal(both.normals, [[np.nan] * 3] * 2 + np.eye(3)[:2].tolist())
