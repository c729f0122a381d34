"""Make the picture of harmonic forms: `python docs/pictures/harmonic_forms.py [FOLDER]`.

A basis of the four classes of a plate with two holes. Along the stripes the multivalued function is constant; where
they are dense and red its differential is large.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from orbiframe import fit
from orbiframe.surfaces import HarmonicForms, ShadedPicture, shaded_picture

STRIPES, WIDTH = 8, 380
CALM, STRONG, LIGHT = (np.array(c) / 255 for c in ((52, 96, 148), (186, 58, 40), (240, 243, 246)))


def main(folder: Path) -> None:
    """Write harmonic_forms.png."""
    surface = fit("dataset:plate_genus2", size=900, basis={"name": "ps2"}, progress=False).surface
    forms = HarmonicForms.on_surface(surface, degree=4)
    mesh, points = surface.tessellation(14)
    u, slopes = forms.potentials(points), forms.evaluate(points)
    first = surface.jet(points).first
    square = np.einsum("nki,nli->nkl", first, first)
    rows = []
    for k in range(forms.count):
        size = np.sqrt(np.einsum("nk,nk->n", slopes[k], np.linalg.solve(square, slopes[k][..., None])[..., 0]))
        share = np.clip(size / np.quantile(size, 0.97), 0, 1)[:, None]
        tint = CALM + share * (STRONG - CALM)
        stripe = 0.5 + 0.5 * np.tanh(4 * np.sin(2 * np.pi * STRIPES * u[:, k]))[:, None]
        rows.append(shaded_picture(mesh, width=WIDTH, colours=tint + stripe * (LIGHT - tint)).pixels)
    two = [np.concatenate(rows[k : k + 2], axis=1) for k in (0, 2)]
    ShadedPicture(np.concatenate(two)).save(folder / "harmonic_forms.png")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent)
