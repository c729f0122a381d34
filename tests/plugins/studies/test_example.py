"""The paper's own study, as it ships, at small size."""

from __future__ import annotations

import tomllib

import pytest
from documents import ROOT, module_of
from matplotlib.image import imread
from orbiframe_studies.orders import series_of
from orbiframe_studies.plan import Plan
from orbiframe_studies.results import Results
from orbiframe_studies.study_file import read_study

from orbiframe import Registry

EXAMPLE = ROOT / "docs" / "examples" / "two_holed_box.toml"


def test_the_study_is_of_eight_families_and_four_sizes():
    plan = Plan(read_study(EXAMPLE), Registry.discover())
    assert plan.expected == 32
    assert tomllib.loads(EXAMPLE.read_text())["study"]["meshes"] == ["../../datasets/plate_genus2.off"]


@pytest.mark.long
def test_errors_of_all_families_fall_with_their_number(orbiframe, tmp_path):
    families = ["gaussian", "bernstein", "ps2", "ps6"]
    small = [
        f"sweep.basis.name={families}",
        "sweep.basis.size=[100, 300]",
        "fitter.name=least-squares",
        "output.refine=1",
    ]
    folder = tmp_path / "box"
    sets = [word for text in small for word in ("--set", text)]
    assert orbiframe("run", EXAMPLE, "--into", folder, "--workers", 1, *sets).status == 0
    assert orbiframe("report", folder).status == 0
    series = series_of(Results.of(folder).rows())
    assert [each.name.split(", ")[1] for each in series] == families
    for each in series:
        # A smooth surface near sharp edges: distances fall like h^1.5 at least, and no faster than twice that.
        assert 1.0 < each.order < 4.0, each
    assert len(list((folder / "kept").rglob("*.h5"))) == 8
    assert len(list((folder / "maps").rglob("*.npz"))) == 1
    assert (folder / "report.html").read_text().count("data:image/png") == 8
    module_of(ROOT / "docs" / "pictures" / "two_holed_box.py").draw(folder, tmp_path / "orders.png")
    height, width, _ = imread(tmp_path / "orders.png").shape
    assert 300 < height < width < 1200
