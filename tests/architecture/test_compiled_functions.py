"""Compiled functions are quick to compile: no pattern in them for which numba compiles pages of its own code."""

from __future__ import annotations

import ast
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from orbiframe.compiled.machine_code import can_load

ROOT = Path(__file__).parents[2]
SOURCES = sorted([*(ROOT / "orbiframe").rglob("*.py"), *(ROOT / "plugins").rglob("*.py")])
DOOR = ROOT / "orbiframe" / "compiled"

# What takes numba seconds, by the name with which it is called; a loop does it at no cost.
SLOW_CALLS = {"concatenate", "cross", "dot", "eye", "hstack", "identity", "sort", "sorted", "stack", "unique", "vstack"}


def compiled_functions(tree: ast.Module) -> Iterator[ast.FunctionDef]:
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef):
            decorators = [d.func if isinstance(d, ast.Call) else d for d in node.decorator_list]
            if any(isinstance(d, ast.Name) and d.id == "compiled" for d in decorators):
                yield node


def offences(tree: ast.Module) -> Iterator[str]:
    """The lines of compiled functions that assign to slices or call what compiles slowly."""
    for function in compiled_functions(tree):
        arrays = _arrays(function)
        for node in ast.walk(function):
            if isinstance(node, ast.Assign | ast.AugAssign):
                targets = node.targets if isinstance(node, ast.Assign) else [node.target]
                yield from _assignments(targets, node.value, arrays)
            if isinstance(node, ast.Call) and _name(node.func) in SLOW_CALLS:
                yield f"{node.lineno}: calls {_name(node.func)}"


def _assignments(targets: list[ast.expr], value: ast.expr, arrays: set[str]) -> Iterator[str]:
    for target in targets:
        if isinstance(target, ast.Tuple):
            values = value.elts if isinstance(value, ast.Tuple) else [value] * len(target.elts)
            for part, own in zip(target.elts, values, strict=True):
                yield from _assignments([part], own, arrays)
        elif isinstance(target, ast.Subscript):
            if any(isinstance(part, ast.Slice) for part in ast.walk(target.slice)):
                yield f"{target.lineno}: assigns to a slice"
            elif isinstance(value, ast.Name) and value.id in arrays:
                yield f"{target.lineno}: assigns the array {value.id} to a row"


def _arrays(function: ast.FunctionDef) -> set[str]:
    """The names that the function binds to arrays of its own making."""
    makers = {"empty", "zeros", "ones", "full", "arange", "copy", "array", "empty_like", "zeros_like"}
    found = set()
    for node in ast.walk(function):
        if isinstance(node, ast.Assign):
            for target in node.targets:
                pairs = [(target, node.value)]
                if isinstance(target, ast.Tuple) and isinstance(node.value, ast.Tuple):
                    pairs = list(zip(target.elts, node.value.elts, strict=True))
                for name, value in pairs:
                    if isinstance(name, ast.Name) and isinstance(value, ast.Call) and _name(value.func) in makers:
                        found.add(name.id)
    return found


def _name(function: ast.expr) -> str:
    return function.attr if isinstance(function, ast.Attribute) else getattr(function, "id", "")


def imports_numba(tree: ast.Module) -> bool:
    modules = [alias.name for node in ast.walk(tree) if isinstance(node, ast.Import) for alias in node.names]
    modules += [str(node.module) for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)]
    return any(module.split(".")[0] in ("numba", "llvmlite") for module in modules)


def test_only_the_folder_of_compiled_code_imports_numba():
    importers = {path for path in SOURCES if imports_numba(ast.parse(path.read_text()))}
    assert importers
    assert all(DOOR in path.parents for path in importers), importers


def test_no_compiled_function_has_a_slow_pattern():
    found = {str(path.relative_to(ROOT)): list(offences(ast.parse(path.read_text()))) for path in SOURCES}
    assert {path: lines for path, lines in found.items() if lines} == {}


def test_the_search_finds_compiled_functions():
    found = [function for path in SOURCES for function in compiled_functions(ast.parse(path.read_text()))]
    assert len(found) > 100


OFFENCES = [
    ("a[:] = b", "assigns to a slice"),
    ("a[0, 1:] = 0.0", "assigns to a slice"),
    ("x, a[i, :3] = 1, b", "assigns to a slice"),
    ("a[1:] += 1", "assigns to a slice"),
    ("row = np.empty(3)\n    a[i] = row", "assigns the array row to a row"),
    ("x, row = 1, b.copy()\n    x, a[i] = 2, row", "assigns the array row to a row"),
    ("a.sort()", "calls sort"),
    ("b = np.concatenate((a, a))", "calls concatenate"),
    ("b = np.eye(3)", "calls eye"),
]


@pytest.mark.parametrize(("body", "offence"), OFFENCES, ids=[body for body, _ in OFFENCES])
@pytest.mark.parametrize("decorator", ["compiled", "compiled(arrays=False)"])
def test_an_offence_is_found(decorator, body, offence):
    found = list(offences(ast.parse(f"@{decorator}\ndef f(a, b, i):\n    {body}\n")))
    assert len(found) == 1
    assert offence in found[0]


@pytest.mark.parametrize("body", ["a[i] = b[i]", "a[i, 1] = 2.0", "a[i], n = 1, 2", "n = a[:3]"])
def test_what_is_quick_is_no_offence(body):
    assert list(offences(ast.parse(f"@compiled\ndef f(a, b, i):\n    {body}\n"))) == []


def test_other_functions_may_do_as_they_like():
    assert list(offences(ast.parse("def f(a):\n    a[:] = np.sort(a)\n"))) == []


COUNT = """
import sys
from orbiframe.cli.main import main
from orbiframe.compiled.kept_code import KeptCode

asked, entry = [], KeptCode.entry
def counted(self, kinds):
    asked.append(f"{self._function.__module__}.{self._function.__qualname__}")
    return entry(self, kinds)

KeptCode.entry = counted
assert main(["fit", "datasets/plate_genus2.off", "-o", sys.argv[1], "--size", "50", "--refine", "1", "--quiet"]) == 0
print(*asked, "numba" in sys.modules)
"""


def test_a_fit_needs_few_compiled_functions(tmp_path):
    command = [sys.executable, "-c", COUNT, str(tmp_path / "smooth.ply")]
    subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    run = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    *needed, numba = run.stdout.split()
    # All is kept, and numba is not even imported where its code was tried without it.
    assert numba == str(not can_load())
    # Those that Python calls; each is called with one combination of types.
    assert 10 <= len(needed) <= 35, needed
    assert sorted(needed) == sorted(set(needed))
