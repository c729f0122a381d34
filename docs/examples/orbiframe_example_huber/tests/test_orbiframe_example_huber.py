"""The laws of fitters, tried on Huber's fit, and what it is for."""

import numpy as np
from orbiframe_example_huber.fitter import Huber

from orbiframe import Registry, Samples, fit
from orbiframe.testing import Lab, contract_tests

test_huber = contract_tests("fitter", Huber)


def test_outliers_do_not_pull(tmp_path):
    """A tenth of the values is off by 1, and the fit within a thousandth of the others, where squares are not."""
    triangulation = Lab(tmp_path).triangulations["torus"]
    basis = Registry.discover().load("basis", "gaussian")(triangulation.orbifold, triangulation, size=40)
    rng = np.random.default_rng(1)
    face = rng.integers(triangulation.polyhedron.face_count, size=2000)
    points = triangulation.locate(face, rng.dirichlet(np.ones(3), 2000))
    truth = basis.design_matrix(points) @ rng.normal(size=(40, 1))
    values = truth + (np.arange(2000) % 10 == 0)[:, None]
    samples = Samples(points, values, np.ones(2000), np.ones(2000))
    squares = Huber(rounds=0).fit(basis, samples)
    away = [np.abs(basis.values(points, c) - truth).max() for c in (squares, Huber().fit(basis, samples))]
    assert away[1] < 1e-3
    assert away[1] < away[0] / 50


def test_it_fits_a_mesh(tmp_path):
    """By its name, once the package is installed."""
    mesh = Lab(tmp_path).polyhedra["torus"]
    assert fit(mesh, fitter="huber", size=100, data={"lift": False}, refine=1).report["fit"]["fitter"] == "huber"
