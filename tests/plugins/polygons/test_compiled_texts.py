"""The compiled ways of large files give what the plain ways of small files give."""

from __future__ import annotations

import subprocess
import sys
import warnings

import numpy as np
import pytest
from corpus.bad_files import cases
from hypothesis import given, settings, strategies as st
from orbiframe_polygons import floats, lines, text, weld
from reader_switches import SWITCHES

from orbiframe import FormatError, Polyhedron
from orbiframe.components.registry import Registry
from orbiframe.files import gate
from orbiframe.meshes import polyhedron

REGISTRY = Registry.discover()

DIGITS = st.text("0123456789", max_size=25)
DECIMALS = st.builds(
    lambda sign, whole, part, power: f"{sign}{whole or '0'}.{part}e{power}",
    *(st.sampled_from(["", "+", "-"]), DIGITS, DIGITS, st.integers(-400, 400)),
)
FLOATS = st.floats(allow_nan=False, allow_infinity=False)
# Halfway between two floats, to the last digit.
HALVES = st.builds(lambda m, k: str((2 * m + 1) * 2**k), st.integers(2**52, 2**53 - 1), st.integers(0, 10))


def compiled(words: list[str]) -> np.ndarray:
    data = np.frombuffer(" ".join(words).encode(), dtype=np.uint8)
    found = floats._compiled(data, len(words))
    assert found is not None
    return found


@settings(max_examples=300, deadline=None)
@given(st.lists(st.one_of(DECIMALS, FLOATS.map(repr), HALVES, st.integers().map(str)), min_size=1, max_size=30))
def test_every_decimal_number_is_read_correctly_rounded(words):
    assert compiled(words).tobytes() == np.array([float(word) for word in words]).tobytes()


def test_random_bits_are_written_as_python_writes_them_and_read_back():
    rng = np.random.default_rng(7)
    bits = rng.integers(0, 2**64, 100_000, dtype=np.uint64)
    edges = [2.0**k for k in range(-1074, 1024)] + [float(f"1e{k}") for k in range(-323, 309)]
    edges += [
        0.0,
        5e-324,
        2.2250738585072014e-308,
        1.7976931348623157e308,
        9007199254740993.0,
        1e16,
        123456789012345680.0,
    ]
    values = np.concatenate([bits.view(np.float64), edges, np.nextafter(edges, 0), rng.normal(size=20_000).round(3)])
    values = np.concatenate([values, -values])
    values = values[np.isfinite(values)]
    rows = lines.Rows([values], ["", "\n"], np.zeros(len(values) + 1, dtype=np.intp), np.empty(0, dtype=np.intp))
    words = rows.compiled().decode().split()
    assert words == list(map(repr, values.tolist()))
    assert compiled(words).tobytes() == values.tobytes()


@settings(max_examples=200, deadline=None)
@given(FLOATS)
def test_every_float_is_written_as_python_writes_it(value):
    rows = lines.Rows([np.array([value])], ["", ""], np.zeros(2, dtype=np.intp), np.empty(0, dtype=np.intp))
    assert rows.compiled().decode() == repr(value)


def test_words_that_are_no_numbers_are_seen():
    for word in ("nan", "1d3", "0x1p3", "1-2", "1e", ".", "-", "1_0", "１", "1" * 30 + "x", "1e5e5"):
        assert floats._compiled(np.frombuffer(f"1 {word} 2".encode(), np.uint8), 3) is None, word


def test_a_word_of_twenty_digits_that_wraps_round_to_zero():
    assert compiled([str(2**64), str(2**64 * 10), f"0.{2**64}"]).tolist() == [
        2.0**64,
        10 * 2.0**64,
        float(f"0.{2**64}"),
    ]


@settings(max_examples=200, deadline=None)
@given(st.text("ab \t\n\v1", max_size=60))
def test_lines_are_found_the_same_way(content):
    codes = np.frombuffer(content.encode(), dtype=np.uint8)
    if len(codes):
        for plain, fast in zip(text._found(codes), text._found_compiled(codes), strict=True):
            assert np.array_equal(plain, fast)


@pytest.mark.parametrize("kind", [np.float32, np.float64])
def test_points_are_welded_the_same_way(kind):
    rng = np.random.default_rng(3)
    few = rng.choice([-1.5, -0.0, 0.0, 1e-30, 7], size=(3000, 3, 3)).astype(kind)
    for corners in (few, rng.normal(size=(4000, 3, 3)).astype(kind), few[:, ::-1]):
        for plain, fast in zip(weld._sorted(corners), weld._hashed(corners), strict=True):
            assert np.array_equal(plain, fast)
            assert not np.signbit(fast[fast == 0]).any()


def test_rows_are_put_the_same_way():
    rng = np.random.default_rng(5)
    offsets = np.cumsum([0, *rng.integers(0, 6, 300)])
    numbers = rng.integers(0, 10**6, offsets[-1])
    columns = [rng.normal(size=300), rng.integers(0, 256, 300).astype(np.uint8), np.zeros(300)]
    for lead, twice in ((None, False), ("f", True), ("", False)):
        rows = lines.Rows(columns, ["<", "> <", "|", ">\n"], offsets, numbers, lead, twice)
        assert rows.compiled() == rows.plain()


@settings(max_examples=50, deadline=None)
@given(st.lists(st.lists(st.integers(0, 6), max_size=6), max_size=12))
def test_twins_are_found_the_same_way(faces):
    made = Polyhedron.from_faces(np.zeros((7, 3)), faces)
    if not len(made.tail):
        return
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(polyhedron, "LARGE", 0)
        fast = Polyhedron.from_faces(np.zeros((7, 3)), faces)
    assert np.array_equal(made.twin, fast.twin)
    assert np.array_equal(made.same, fast.same)


def answer(path) -> object:
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        try:
            found = gate.read(path, REGISTRY)
        except FormatError as error:
            return str(error)
    return (
        *(getattr(found, t).tobytes() for t in ("vertices", "offsets", "tail", "twin")),
        [str(w.message) for w in told],
    )


def test_every_file_of_the_corpus_gets_the_same_answer(tmp_path, monkeypatch):
    answers = {}
    for case in cases():
        (tmp_path / case.name).write_bytes(case.content)
        answers[case.name] = answer(tmp_path / case.name)
    for module, name in SWITCHES:
        monkeypatch.setattr(module, name, 0)
    for name, expected in answers.items():
        assert answer(tmp_path / name) == expected


def test_a_large_file_is_written_and_read_by_the_compiled_ways(tmp_path):
    rng = np.random.default_rng(1)
    size = 400
    grid = np.arange(size * size).reshape(size, size)
    quads = np.stack([grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]], axis=-1).reshape(-1, 4)
    made = Polyhedron.from_faces(rng.normal(size=(size * size, 3)), quads)
    assert made.vertices.size + made.tail.size > lines.LARGE
    for suffix in (".off", ".obj"):
        gate.write(tmp_path / f"a{suffix}", made, REGISTRY)
        assert (tmp_path / f"a{suffix}").stat().st_size > text.LARGE
        found = gate.read(tmp_path / f"a{suffix}", REGISTRY)
        assert np.array_equal(found.vertices, made.vertices)
        assert np.array_equal(found.tail, made.tail)
    content = (tmp_path / "a.off").read_bytes()
    (tmp_path / "bad.off").write_bytes(content[:-3_000_000] + b"x" + content[-3_000_000:])
    line = content[:-3_000_000].count(b"\n") + 1
    with pytest.raises(FormatError, match=f"line {line}: found"):
        gate.read(tmp_path / "bad.off", REGISTRY)


def test_small_files_need_no_compiler(tmp_path):
    gate.write(tmp_path / "a.off", Polyhedron.from_faces(np.eye(3), [[0, 1, 2]]), REGISTRY)
    code = (
        "import sys; from pathlib import Path; from orbiframe.files import gate; "
        "from orbiframe.components.registry import Registry\n"
        f"gate.read(Path({str(tmp_path / 'a.off')!r}), Registry.discover())\n"
        "assert 'numba' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
