"""Automatic differentiation: `jax` in double precision, imported when it is first used."""

from __future__ import annotations

import os
from typing import Any

import lazy_loader

os.environ.setdefault("JAX_ENABLE_X64", "1")


class _Numpy:
    """`jax.numpy`, for which the loader would import `jax` at once."""

    def __getattr__(self, name: str) -> Any:
        return getattr(jax.numpy, name)


jax: Any = lazy_loader.load("jax")
jnp: Any = _Numpy()
