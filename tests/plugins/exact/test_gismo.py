"""G+Smo files read back: closed along all interfaces, as splinepy finds them; equal knots along strips."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from pathlib import Path

import numpy as np
import pytest
from fitted import DATASETS, REGISTRY, fitted
from orbiframe_exact.gismo import write_gismo
from scipy.interpolate import BSpline

from orbiframe.files import gate
from orbiframe.surfaces.surface import OrbifoldSurface

CUBE = DATASETS / "cube.off"
NAMES = ["double torus", "Klein bottle"]
Patch = tuple[list[np.ndarray], np.ndarray]


def patches_of(path: Path) -> tuple[dict[int, Patch], np.ndarray]:
    """Knots and control points (n_s, n_t, 3) of every patch by its number, and the interfaces, (E, 8)."""
    root = ElementTree.parse(path).getroot()
    found = {}
    for piece in root.findall("Geometry"):
        knots = [np.array(row.text.split(), float) for row in piece.findall("Basis/Basis/KnotVector")]
        sizes = [len(row) - 6 for row in knots]
        poles = np.array(piece.find("coefs").text.split(), float).reshape(*sizes[::-1], 3)
        found[int(piece.get("id"))] = knots, np.swapaxes(poles, 0, 1)
    first, last = map(int, root.find("MultiPatch/patches").text.split())
    assert list(found) == list(range(first, last + 1))
    return found, np.array(root.find("MultiPatch/interfaces").text.split(), int).reshape(-1, 8)


def evaluated(patch: Patch, s: np.ndarray, t: np.ndarray) -> np.ndarray:
    (knots_s, knots_t), poles = patch
    rows, columns = BSpline(knots_s, np.eye(len(poles)), 5)(s), BSpline(knots_t, np.eye(poles.shape[1]), 5)(t)
    return np.einsum("na,nb,abk->nk", rows, columns, poles)


def across(interface: np.ndarray, patches: dict[int, Patch], u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Points of both patches along an interface, by its own numbers."""
    one, side, other, side_there, *rest = interface.tolist()
    to, kept = rest[:2], rest[2:]
    fixed, along = (side - 1) // 2, 1 - (side - 1) // 2
    here = np.empty((2, len(u)))
    here[fixed], here[along] = (side - 1) % 2, u
    there = np.empty((2, len(u)))
    there[to[fixed]] = (side_there - 1) % 2
    there[to[along]] = u if kept[along] else 1 - u
    assert to[fixed] == (side_there - 1) // 2
    assert kept[fixed] == ((side - 1) % 2 != (side_there - 1) % 2)
    return evaluated(patches[one], *here), evaluated(patches[other], *there)


def written(name: str, path: Path, **options: object) -> OrbifoldSurface:
    surface = fitted(name, 60).surface
    gate.export(path, surface, REGISTRY, options={"tolerance": 1e-3, **options})
    return surface


@pytest.mark.parametrize("conforming", [False, True])
@pytest.mark.parametrize("name", NAMES)
def test_patches_meet_along_every_interface(name: str, conforming: bool, tmp_path: Path) -> None:
    surface = written(name, tmp_path / "p.xml", conforming=conforming)
    patches, interfaces = patches_of(tmp_path / "p.xml")
    assert len(interfaces) == 2 * len(patches)
    assert len({(p, s) for row in interfaces.tolist() for p, s in (row[:2], row[2:4])}) == 4 * len(patches)
    size = np.linalg.norm(np.ptp(surface.tessellate(1).vertices, axis=0))
    for interface in interfaces:
        here, there = across(interface, patches, np.linspace(0, 1, 9))
        np.testing.assert_allclose(here, there, atol=1e-9 * size)


@pytest.mark.parametrize("name", NAMES)
def test_conforming_patches_have_the_same_functions_and_points_on_their_edges(name: str, tmp_path: Path) -> None:
    written(name, tmp_path / "plain.xml")
    written(name, tmp_path / "equal.xml", conforming=True)
    plain, equal = patches_of(tmp_path / "plain.xml")[0], patches_of(tmp_path / "equal.xml")
    for one, side, other, side_there, *_ in equal[1].tolist():
        borders = []
        for number, which in ((one, side), (other, side_there)):
            knots, poles = equal[0][number]
            along = 1 - (which - 1) // 2
            borders.append((knots[along], poles[:, -(which % 2 == 0)] if along == 0 else poles[-(which % 2 == 0)]))
        (knots, line), (knots_there, line_there) = borders
        back = np.linalg.norm(line[0] - line_there[0]) > 1e-9
        np.testing.assert_array_equal(knots, 1 - knots_there[::-1] if back else knots_there)
        line_there = line_there[::-1] if back else line_there
        np.testing.assert_array_equal(line[1:-1], line_there[1:-1])
        np.testing.assert_allclose(line, line_there, atol=1e-12)
    s, t = np.random.default_rng(0).random((2, 50))
    for number, patch in equal[0].items():
        np.testing.assert_allclose(evaluated(patch, s, t), evaluated(plain[number], s, t), atol=1e-11)
    assert any(len(equal[0][n][0][0]) > len(plain[n][0][0]) for n in plain)


def test_splinepy_finds_the_same_interfaces(tmp_path: Path) -> None:
    splinepy = pytest.importorskip("splinepy", reason="splinepy has no wheel for this Python")
    written("Klein bottle", tmp_path / "p.xml", conforming=True)
    read = splinepy.io.gismo.load(str(tmp_path / "p.xml"))
    read = read[0] if isinstance(read, (tuple, list)) else read
    again = splinepy.Multipatch(splines=read.patches)
    again.determine_interfaces()
    np.testing.assert_array_equal(again.interfaces, read.interfaces)
    assert (read.interfaces >= 0).all()
    patches, ours = patches_of(tmp_path / "p.xml")
    theirs = np.add(again.interface_orientations(), [100, 1, 100, 1, 0, 0, 0, 0])
    assert {tuple(row) for row in theirs.tolist()} <= {tuple(row) for row in ours.tolist()} | set(map(swapped, ours))
    for patch, spline in zip(patches.values(), read.patches, strict=True):
        s, t = np.random.default_rng(1).random((2, 20))
        np.testing.assert_allclose(spline.evaluate(np.stack([s, t], axis=1)), evaluated(patch, s, t), atol=1e-12)


def test_gismo_itself_reads_a_surface_without_boundary(tmp_path: Path) -> None:
    gismo = pytest.importorskip("pygismo", reason="pygismo is for Linux: pip install pygismo")
    written("Klein bottle", tmp_path / "p.xml", conforming=True)
    read, alone = gismo.core.gsMultiPatch(), gismo.core.gsMultiPatch()
    gismo.io.gsReadFile(str(tmp_path / "p.xml"), read)
    patches, ours = patches_of(tmp_path / "p.xml")
    assert (read.nPatches(), read.domainDim(), read.targetDim()) == (len(patches), 2, 3)
    assert (len(read.interfaces()), len(read.boundaries())) == (len(ours), 0)
    for number, patch in enumerate(patches.values()):
        alone.addPatch(read.patch(number))
        s, t = np.random.default_rng(number).random((2, 20))
        np.testing.assert_allclose(read.patch(number).eval(np.stack([s, t])).T, evaluated(patch, s, t), atol=1e-12)
    # The patches without the interfaces of the file: G+Smo finds them by their corners.
    assert alone.computeTopology(1e-6, False, False)
    assert (len(alone.interfaces()), len(alone.boundaries())) == (len(ours), 0)


def swapped(row: np.ndarray) -> tuple[int, ...]:
    """An interface seen from its other patch."""
    one, side, other, side_there, first, second, keeps_first, keeps_second = row.tolist()
    to, kept = [0, 0], [0, 0]
    to[first], to[second] = 0, 1
    kept[first], kept[second] = keeps_first, keeps_second
    return other, side_there, one, side, *to, *kept


def test_from_the_command_line(orbiframe, tmp_path) -> None:
    ran = orbiframe(
        "fit", CUBE, "-o", tmp_path / "p.xml", "--conforming", "--size", 60, "--faces", 20, "--export-tolerance", 1e-3
    )
    assert (ran.status, ran.err) == (0, "")
    assert "B-spline faces" in ran.out
    assert len(patches_of(tmp_path / "p.xml")[0]) >= 20


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        (("-o", "p.step", "--conforming"), "--conforming is for patches of G+Smo, as patches.xml"),
        (("-o", "p.ply", "--conforming"), "--conforming is for patches of G+Smo, as patches.xml"),
        (("-o", "p.xml", "--exact"), "--exact is for files that hold exact surfaces, such as part.step"),
        (("-o", "p.xml", "--faces", 0), "--faces 0: give 1 to"),
    ],
)
def test_what_does_not_fit_together_is_refused(orbiframe, tmp_path, monkeypatch, options, sentence) -> None:
    if "p.step" in options:
        pytest.importorskip("OCP", reason='Open CASCADE is the extra "orbiframe[cad]"')
    monkeypatch.chdir(tmp_path)
    ran = orbiframe("fit", CUBE, *options)
    assert ran.status == 2
    assert sentence in ran.err
    assert not list(tmp_path.iterdir())


def test_the_same_surface_gives_the_same_bytes(tmp_path: Path) -> None:
    surface = fitted("cube", 60).surface
    for name in ("a.xml", "b.xml"):
        write_gismo(tmp_path / name, surface, conforming=True, tolerance=1e-2)
    assert (tmp_path / "a.xml").read_bytes() == (tmp_path / "b.xml").read_bytes()
