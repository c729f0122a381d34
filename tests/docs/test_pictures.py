"""Scripts of pictures make again what the pages show."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest
from documents import ROOT
from matplotlib.image import imread

FOLDER = ROOT / "docs" / "pictures"
MADE = {
    "harmonic_forms": ["harmonic_forms.png"],
    "make": ["four_shapes.png"],
    "open_meshes": ["open_meshes.png"],
    "square_faces": ["square_faces_disc.png", "square_faces_space.png"],
    "textures": ["textures.png"],
}


def test_every_script_is_run():
    """The figures of the paper and the orders of its example have tests of their own."""
    scripts = {path.stem for path in FOLDER.glob("*.py")}
    assert {name for name in scripts if not name.startswith("figure_")} == {*MADE, "two_holed_box"}


@pytest.mark.long
@pytest.mark.parametrize("script", MADE)
def test_a_script_makes_its_pictures_again(script, tmp_path):
    """But for digits: a hundredth of the light, on the average of all pixels."""
    target = tmp_path / MADE[script][0] if script == "make" else tmp_path
    subprocess.run([sys.executable, FOLDER / f"{script}.py", target], check=True, timeout=600)
    assert sorted(path.name for path in tmp_path.iterdir()) == MADE[script]
    for name in MADE[script]:
        shown, made = (imread(path / name)[..., :3] for path in (FOLDER, tmp_path))
        assert shown.shape == made.shape
        assert np.abs(shown - made).mean() < 0.01, name
