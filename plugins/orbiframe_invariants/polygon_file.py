"""Polygon files: a fundamental polygon of one's own, as a TOML file of its vertices and its gluing word."""

from __future__ import annotations

import math
import tomllib
from pathlib import Path
from typing import TYPE_CHECKING, Any

from orbiframe import FormatError, Registry, Word
from orbiframe.components import did_you_mean

if TYPE_CHECKING:
    from orbiframe.groups import PolygonGroup

SUFFIX = ".toml"
KEYS = ("word", "vertices", "model")
MODELS = ("projective", "conformal", "polar")


def polygon_of_file(path: Path, registry: Registry) -> PolygonGroup:
    """The group of the polygon of a file.

    word: as on the command line, letter p glues the side from vertex p to the next one; vertices: a list of pairs,
    counterclockwise round the origin; model: what the pairs are, coordinates in the "projective" or "conformal" model,
    or "polar", distance and angle in degrees. The plane is that of the surface. Raises FormatError for a file that is
    not so, GeometryError for a polygon that does not meet Poincare's conditions, TopologyError for no gluing word.
    """
    from orbiframe.groups import FundamentalPolygon, PolygonGroup
    from orbiframe_invariants.named_words import word_named

    table = _table(path)
    word: Word = word_named(table["word"])
    pairs = _pairs(path, table["vertices"])
    geometry = registry.geometry(word.euler_characteristic)
    model = table.get("model", MODELS[0])
    if model not in MODELS:
        raise FormatError(f"{path}: model is {model!r}; it must be one of {', '.join(MODELS)}")
    if model == "polar":
        radii, degrees = zip(*pairs, strict=True)
        vertices = geometry.from_polar(radii, [math.radians(angle) for angle in degrees])
    else:
        vertices = geometry.from_chart(model, pairs)
    return PolygonGroup(FundamentalPolygon(geometry, vertices, word))


def _table(path: Path) -> dict[str, Any]:
    try:
        found = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError) as error:
        raise FormatError(f"{path} cannot be read: {getattr(error, 'strerror', None) or error}") from error
    except tomllib.TOMLDecodeError as error:
        raise FormatError(f"{path} is no TOML: {error}") from error
    for key in found:
        if key not in KEYS:
            raise FormatError(f"{path}: the key '{key}' is not known, but {', '.join(KEYS)}.{did_you_mean(key, KEYS)}")
    for key, kind in (("word", str), ("vertices", list)):
        if not isinstance(found.get(key), kind):
            raise FormatError(
                f'{path}: {key} is missing or no {"text" if kind is str else "list"}; write word = "abAB" and '
                "vertices = [[x, y], …], one for each letter"
            )
    return found


def _pairs(path: Path, vertices: list[Any]) -> list[tuple[float, float]]:
    for number, pair in enumerate(vertices):
        sound = isinstance(pair, list) and len(pair) == 2
        if not sound or not all(type(x) in (int, float) and math.isfinite(x) for x in pair):
            raise FormatError(f"{path}: vertex {number} is {pair}; it must be two numbers, such as [0.5, -0.25]")
    return [(float(x), float(y)) for x, y in vertices]
