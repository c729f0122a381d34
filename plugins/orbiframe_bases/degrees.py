"""Degrees: which polynomials a basis has room and digits for."""

from __future__ import annotations

from orbiframe import UsageError

# A polynomial of degree 15 has 136 coefficients on every triangle, and half of the 16 digits are left to its values.
MOST = 15


def require_degree(basis: str, degree: int, least: int, most: int = MOST) -> None:
    """Raise UsageError for a degree that a basis cannot have."""
    if degree < least:
        raise UsageError(f"option degree of the basis {basis} is {degree}; it must be at least {least}")
    if degree > most:
        raise UsageError(
            f"option degree of the basis {basis} is {degree}: {(degree + 1) * (degree + 2) // 2} coefficients on every "
            f"triangle; it must be at most {most}, and more functions (basis.size) bring more than higher degrees"
        )
