"""Every file of the corpus gets its answer: the mesh, or an error that names the file and the place; nothing else."""

from __future__ import annotations

import warnings
from collections import Counter

import numpy as np
import pytest
from corpus.answers import Mesh, Refused
from corpus.bad_files import cases

from orbiframe import FormatError, Polyhedron
from orbiframe.components.registry import Registry
from orbiframe.files import gate

REGISTRY = Registry.discover()
CASES = list(cases())


def test_there_are_many_cases_and_each_name_is_there_once():
    assert len(CASES) >= 150
    assert max(Counter(case.name for case in CASES).values()) == 1
    assert sum(isinstance(case.answer, Mesh) for case in CASES) >= 50


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_every_file_gets_its_answer(case, tmp_path):
    path = tmp_path / case.name
    path.write_bytes(case.content)
    if isinstance(case.answer, Refused):
        with pytest.raises(FormatError, match=f"(?s){case.name.replace('.', '[.]')}.*({case.answer.words})"):
            gate.read(path, REGISTRY)
        return
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        found = gate.read(path, REGISTRY)
    require(found, case.answer)
    assert bool(told) == case.answer.warned, [str(w.message) for w in told]


def require(found: Polyhedron, wanted: Mesh) -> None:
    assert np.array_equal(found.vertices, wanted.points)
    assert [found.face_corners(f).tolist() for f in range(found.face_count)] == wanted.faces
