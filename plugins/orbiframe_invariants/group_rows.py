"""What `orbiframe group` has found of a group, in lines."""

from __future__ import annotations

import math
from typing import Any

from orbiframe_invariants.symbol_description import symbol_rows


def group_lines(found: dict[str, Any]) -> list[str]:
    """The lines, each with what it is about."""
    rows = symbol_rows(found) if "symbol" in found else _word_rows(found)
    return [f"{name:<10}{text}" for name, text in rows + _computed_rows(found)]


def _word_rows(found: dict[str, Any]) -> list[tuple[str, str]]:
    surface = found["surface"]
    rows = [
        ("word", found["word"]),
        ("surface", f"{surface['name']}, Euler characteristic {surface['euler_characteristic']}"),
        ("relations", ", ".join(f"{relation} = 1" for relation in found["relations"]) + ", of side pairings"),
        ("loops", f"{_equations(found['loops'])}, along sides, in side pairings"),
        ("homology", found["homology"]),
    ]
    if proof := found.get("proof"):
        rows.append(("proof", f"exact, in {proof['ring']}"))
    if standard := found.get("standard"):
        rows += [
            ("standard", f"{standard['word']}, of loops along sides"),
            ("", f"with {_equations(standard['letters'])}"),
        ]
        rows += [("", f"and {_equations(standard['given'])}")]
    return rows


def _computed_rows(found: dict[str, Any]) -> list[tuple[str, str]]:
    rows = []
    for kind, matrices in found.get("matrices", {}).items():
        for number, (letter, matrix) in enumerate(matrices.items()):
            lines = [" ".join(f"{x:19.12g}" for x in row) for row in matrix]
            rows += [
                (kind if number == 0 else "", f"{letter} = {lines[0]}"),
                ("", f"    {lines[1]}"),
                ("", f"    {lines[2]}"),
            ]
    if periods := found.get("periods"):
        digits = min(12, max(1, int(-math.log10(periods["error"] + 1e-15))))
        lines = ["  ".join(_complex(pair, digits) for pair in row) for row in periods["matrix"]]
        rows += [("periods" if k == 0 else "", line) for k, line in enumerate(lines)]
        rows.append(("", f"within {periods['error']:.0e}"))
    if shortest := found.get("systole"):
        rows.append(("systole", f"{shortest['length']:.12g}, {shortest['multiplicity']} closed geodesics"))
    rows += [("spectrum" if k == 0 else "", _eigenvalue(e)) for k, e in enumerate(found.get("spectrum", []))]
    if "function" in found:
        rows.append(("function", f"{found['function']['number']}, eigenvalue {found['function']['eigenvalue']:.9g}"))
    if "picture" in found:
        rows.append(("picture", found["picture"]))
    return rows


def _complex(pair: list[float], digits: int) -> str:
    """A complex number with as many digits after the point as are right."""
    real, imaginary = pair
    sign = "-" if round(imaginary, digits) < 0 else "+"
    return f"{round(real, digits) + 0.0:.{digits}g} {sign} {abs(round(imaginary, digits)):.{digits}g}i"


def _eigenvalue(found: dict[str, Any]) -> str:
    """The value to the digits that are sure, its multiplicity, and its error; exact ones have none."""
    value, error = found["value"], found["error"]
    if error == 0:
        return f"{value:.15g} ({found['multiplicity']})"
    decimals = min(max(math.ceil(-math.log10(error)), 1), 15)
    return f"{value:.{decimals}f} ({found['multiplicity']}), error {error:.1e}"


def _matrix_rows(kind: str, matrices: dict[str, list[list[float]]]) -> list[tuple[str, str]]:
    """Three lines for each letter."""
    rows = []
    for letter, matrix in matrices.items():
        heads = f"{letter} =", "", ""
        rows += [
            ("", f"{head:<4}{' '.join(f'{x + 0:19.12g}' for x in row)}")
            for head, row in zip(heads, matrix, strict=True)
        ]
    return [(kind, rows[0][1]), *rows[1:]]


def _equations(change: dict[str, str]) -> str:
    """Letters and their words, such as "a = bC, b = c"."""
    return ", ".join(f"{letter} = {text or '1'}" for letter, text in change.items())
