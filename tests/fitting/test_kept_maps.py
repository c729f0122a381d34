"""Maps that are kept: the same to the bit, computed once, and never trusted blindly."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from orbiframe import Config, FormatError, Registry, fit, read
from orbiframe.files.map_file import load_map, save_map
from orbiframe.fitting import KeptMaps

DATASETS = Path(__file__).parents[2] / "datasets"
QUICK = {"fitter.name": "least-squares", "output.refine": 1, "basis.size": 40}
REGISTRY = Registry.discover()


def fitted(name, maps, **options):
    config = Config.load(None, QUICK | {key.replace("__", "."): value for key, value in options.items()}, REGISTRY)
    return fit(DATASETS / f"{name}.off", config, REGISTRY, maps=maps)


def kept_files(folder: Path) -> list[Path]:
    return sorted(folder.rglob("*.npz"))


def without_times(report):
    return {key: value for key, value in report.items() if key != "seconds"}


@pytest.fixture(scope="module")
def plate():
    return fitted("plate_genus2_coarse", None)


def test_a_kept_map_gives_the_same_surface_to_the_bit(tmp_path, plate):
    for maps in (KeptMaps(tmp_path), KeptMaps(tmp_path)):
        found = fitted("plate_genus2_coarse", maps)
        assert np.array_equal(found.surface.coefficients, plate.surface.coefficients)
        assert without_times(found.report) == without_times(plate.report)
    assert (maps.computed, maps.kept) == (0, 1)


def test_bases_share_one_map_and_other_maps_are_others(tmp_path):
    maps = KeptMaps(tmp_path)
    for basis in ("gaussian", "wendland", "ps2"):
        fitted("plate_genus2_coarse", maps, basis__name=basis)
    assert (maps.computed, maps.kept) == (1, 2)
    fitted("plate_genus2_coarse", maps, map__weights="uniform")
    assert maps.computed == 2
    fitted("plate_genus2_coarse", maps, shape__method="regular-faces")
    assert maps.computed == 3  # the map is there, the shapes are new
    fitted("cube", maps)
    assert maps.computed == 4


@pytest.mark.long
def test_forty_bases_compute_one_map(tmp_path):
    maps = KeptMaps(tmp_path)
    for number in range(40):
        fitted("plate_genus2_coarse", maps, basis__width=1.2 + number / 40)
    assert (maps.computed, maps.kept, len(kept_files(tmp_path))) == (1, 39, 1)


def test_a_damaged_file_is_made_again(tmp_path, plate):
    fitted("plate_genus2_coarse", KeptMaps(tmp_path))
    (path,) = kept_files(tmp_path)
    whole = path.read_bytes()
    damaged = bytearray(whole)
    damaged[len(whole) // 2] ^= 1
    for content in (bytes(damaged), whole[: len(whole) // 2]):
        path.write_bytes(content)
        maps = KeptMaps(tmp_path)
        found = fitted("plate_genus2_coarse", maps)
        assert maps.computed == 1
        assert np.array_equal(found.surface.coefficients, plate.surface.coefficients)
        assert path.read_bytes() == whole


def test_where_nothing_can_be_written_maps_are_computed(tmp_path, plate):
    (tmp_path / "file").write_text("this is no folder")
    maps = KeptMaps(tmp_path / "file")
    assert np.array_equal(fitted("plate_genus2_coarse", maps).surface.coefficients, plate.surface.coefficients)
    assert maps.computed == 1


def test_a_map_belongs_to_its_mesh(tmp_path, plate):
    triangulation = plate.surface.triangulation
    path = tmp_path / "map.npz"
    save_map(triangulation, path)
    geometry = triangulation.orbifold.geometry
    found = load_map(path, triangulation.polyhedron, geometry)
    assert np.array_equal(found.points, triangulation.points)
    assert (found.group, found.weights) == (triangulation.group, triangulation.weights)
    with pytest.raises(FormatError, match=r"map\.npz"):
        load_map(path, read(DATASETS / "sphere.off", REGISTRY), geometry)
