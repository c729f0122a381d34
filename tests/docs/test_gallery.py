"""The gallery shows what its commands make, in files that are small."""

from __future__ import annotations

import re
import subprocess
import sys
import xml.etree.ElementTree as ElementTree

import pytest
from documents import ROOT, blocks, links

PAGE = ROOT / "docs" / "gallery.md"
FIGURES = ["1", "2", "3", "5", "8", "9a", "9b", "10", "11a", "11b"]
PICTURES = [PAGE.parent / link for link in links(PAGE) if link.startswith("pictures/gallery/")]
SCRIPTS = sorted((ROOT / "docs" / "pictures").glob("figure_*.py"))


def test_every_figure_that_can_be_drawn_is_there():
    assert set(FIGURES) <= {picture.stem.removeprefix("figure_") for picture in PICTURES}


def test_every_picture_has_the_one_command_that_makes_it():
    made = [line for block in blocks(PAGE) for line in block.text.splitlines() if re.search(r"figure|--draw|-o ", line)]
    for picture in PICTURES:
        assert sum(picture.name in line for line in made if not line.startswith("picture ")) == 1, picture.name


def test_every_picture_in_the_folder_is_shown():
    assert sorted(PICTURES) == sorted((PAGE.parent / "pictures" / "gallery").iterdir())


@pytest.mark.parametrize("picture", PICTURES, ids=lambda path: path.name)
def test_pictures_are_small(picture):
    limit = 200_000 if picture.suffix == ".svg" else 150_000
    assert picture.stat().st_size < limit


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: path.stem)
def test_a_script_makes_its_figure_again(script, tmp_path):
    """The same paths; numbers within a hundredth of a point of the page, which rounding may turn over."""
    target = tmp_path / f"{script.stem}.svg"
    subprocess.run([sys.executable, str(script), str(target)], check=True)
    shown, made = (numbers(path) for path in (PAGE.parent / "pictures" / "gallery" / target.name, target))
    assert len(shown) == len(made)
    assert all(abs(a - b) <= 0.0201 for a, b in zip(shown, made, strict=True))


def numbers(path):
    root = ElementTree.parse(path).getroot()
    data = " ".join(element.get("d", "") for element in root.iter())
    return [float(number) for number in re.findall(r"-?\d*\.?\d+", data)]
