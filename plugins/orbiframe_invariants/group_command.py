"""orbiframe group: a closed surface from a gluing word, its group, its spectrum and its picture."""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from orbiframe import Registry, UsageError
from orbiframe.files import require_picture
from orbiframe_invariants.group_rows import group_lines
from orbiframe_invariants.polygon_file import SUFFIX, polygon_of_file
from orbiframe_invariants.symbol_description import describe_symbol, is_symbol, symbol_group

if TYPE_CHECKING:
    from orbiframe import Group, Word
    from orbiframe.groups import PolygonGroup
    from orbiframe_invariants.laplace_spectrum import Eigenvalue

# The shape of a surface of each sign of the Euler characteristic that is meant by "regular".
_REGULAR = {1: "finite", 0: "lattice", -1: "regular-polygon"}
_WORD_HELP = (
    "how the sides of a polygon are glued, such as abABcdCD, capitals being inverses; or bolza or klein-quartic; or "
    "Conway's symbol of an orbifold, such as *237, 4*2 or xx; or a .toml file with a word and the vertices of a polygon"
)
PICTURE = "group"


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    add = parser.add_argument
    add("word", metavar="WORD", help=_WORD_HELP)
    add("--polygon", metavar="NAME", default="regular", help="regular (the default), or the name of a group")
    add("--prove", action="store_true", help="prove the relations of the regular polygon exactly, without rounding")
    add("--systole", action="store_true", help="the shortest closed geodesic, and how many there are")
    add("--spectrum", metavar="N", type=int, help="the N smallest eigenvalues of the Laplacian, with multiplicities")
    add("--degree", metavar="D", type=int, help="of the polynomials of --spectrum, even, from 4 to 14; default 10")
    add("--tolerance", metavar="T", type=float, help="the largest error of --spectrum, relative to values above 1")
    add("--periods", action="store_true", help="the period matrix of an orientable surface, in its standard letters")
    add("--matrices", action="store_true", help="the matrices of the side pairings, and of the loops along the sides")
    add("--draw", metavar="FILE", type=Path, help="a picture of the polygon and its tiles, .svg, .png or .pdf")
    add("--model", metavar="NAME", help="of the picture: projective, conformal (the default), hyperboloid or sphere")
    shown = parser.add_mutually_exclusive_group().add_argument
    shown("--tiles", metavar="N", type=int, help="draw at most N tiles, the nearest")
    shown("--radius", metavar="R", type=float, help="draw the tiles that meet the disc of radius R about the origin")
    add("--function", metavar="K", type=int, help="draw eigenfunction K of the Laplacian, the constant one being 0")
    add("--json", action="store_true", help="print one JSON object")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace, registry: Registry) -> int:
    """Describe the group, compute and draw what was asked for."""
    from orbiframe_invariants.named_words import word_named

    _require_spectrum(args)
    _require_picture(args, registry)
    if Path(args.word).suffix == SUFFIX:
        own = _own_polygon(args, registry)
        found = _described(own.word) | _computed(args, own, registry)
    elif is_symbol(args.word):
        orbifold = symbol_group(args, registry)
        found = describe_symbol(orbifold, args.word) | _computed(args, orbifold, registry)
    else:
        word = word_named(args.word)
        found = _described(word)
        if args.prove:
            found["proof"] = _proof(word, args.polygon)
        if args.systole or args.spectrum or args.draw or args.matrices or args.periods:
            found.update(_computed(args, _group(word, args.polygon, registry), registry))
    print(json.dumps(found) if args.json else "\n".join(group_lines(found)))
    return 0


def _require_spectrum(args: argparse.Namespace) -> None:
    """Raise UsageError for a number of eigenvalues, a degree or a tolerance that cannot be."""
    if args.spectrum is None:
        for name in ("degree", "tolerance"):
            if getattr(args, name) is not None:
                raise UsageError(f"--{name} belongs to a spectrum; say how many eigenvalues, such as --spectrum 5")
    elif args.spectrum < 1:
        raise UsageError(f"--spectrum {args.spectrum}: ask for at least 1 eigenvalue")
    if args.degree is not None and (args.degree % 2 or not 4 <= args.degree <= 14):
        raise UsageError(f"--degree {args.degree}: give an even degree from 4 to 14")
    if args.tolerance is not None and not 0 < args.tolerance < 1:
        raise UsageError(f"--tolerance {args.tolerance:g}: give a number between 0 and 1, such as 1e-9")


def _require_picture(args: argparse.Namespace, registry: Registry) -> None:
    """Raise UsageError for options of a picture without its file, or a file that is none."""
    if args.draw is not None:
        require_picture(args.draw, PICTURE, registry)
        return
    for name in ("model", "tiles", "radius", "function"):
        if getattr(args, name) is not None:
            raise UsageError(f"--{name} belongs to a picture; name its file with --draw, such as --draw tiles.svg")


def _proof(word: Word, polygon: str) -> dict[str, Any]:
    """What is proved of the relations, and in which ring."""
    from orbiframe_invariants.exact_relations import prove_relations

    if polygon != "regular":
        raise UsageError(
            f"--prove is for the regular polygon, whose entries are algebraic; leave out --polygon {polygon}"
        )
    count = len(prove_relations(word))
    return {"relations": count, "ring": f"Z[zeta, t], zeta of order {4 * len(word)}"}


def _group(word: Word, polygon: str, registry: Registry) -> Group:
    sign = (word.euler_characteristic > 0) - (word.euler_characteristic < 0)
    name = _REGULAR[sign] if polygon == "regular" else polygon
    group: Group = registry.load("group", name)(registry.geometry(sign), word)
    return group


def _own_polygon(args: argparse.Namespace, registry: Registry) -> PolygonGroup:
    """The group of a file, which has no named polygon and no regular one."""
    if args.prove or args.polygon != "regular":
        raise UsageError(
            f"--prove and --polygon are for words, and {args.word} has a polygon of its own; leave them out"
        )
    return polygon_of_file(Path(args.word), registry)


def _described(word: Word) -> dict[str, Any]:
    """What a word says without numbers."""
    from orbiframe.words import Presentation, text_of
    from orbiframe_invariants.polygon_loops import loops_in_pairings

    deficit = 2 - word.euler_characteristic
    one_vertex = len(word.vertex_cycles) == 1
    found: dict[str, Any] = {
        "word": str(word),
        "surface": {
            "name": word.surface,
            "euler_characteristic": word.euler_characteristic,
            "orientable": word.orientable,
            "genus": deficit // 2 if word.orientable else deficit,
        },
        "vertices": len(word.vertex_cycles),
        "relations": ["".join(map(text_of, relation)) for relation in word.letter_relations],
        "homology": Presentation.of(word if one_vertex else word.standard).homology_text,
        "loops": {text_of(k): "".join(map(text_of, loop)) for k, loop in sorted(loops_in_pairings(word).items())},
    }
    return found | ({} if word == word.standard else {"standard": _reduced(word)})


def _reduced(word: Word) -> dict[str, Any]:
    """The standard word, its letters in those of the given word, and those of the given word in its letters."""
    from orbiframe.words import text_of
    from orbiframe_invariants.canonical_word import canonical_form

    reduced = canonical_form(word)
    changes = {"letters": reduced.new_in_old, "given": reduced.old_in_new}
    texts = {
        name: {text_of(k): "".join(map(text_of, letters)) for k, letters in change.items()}
        for name, change in changes.items()
    }
    return {"word": str(reduced.standard), **texts}


def _computed(args: argparse.Namespace, group: Group, registry: Registry) -> dict[str, Any]:
    found: dict[str, Any] = {}
    if args.systole:
        from orbiframe_invariants.closed_geodesics import systole

        shortest = systole(group)
        found["systole"] = {"length": shortest.length, "multiplicity": shortest.multiplicity}
    if args.periods:
        found["periods"] = _periods(group, registry)
    if args.matrices:
        from orbiframe_invariants.generator_matrices import generator_matrices

        found["matrices"] = generator_matrices(group)
    if args.spectrum and (elements := getattr(group, "elements", None)) is not None:
        from orbiframe_invariants.spherical_spectrum import spherical_spectrum

        found["spectrum"] = _listed(spherical_spectrum(elements, args.spectrum))
    elif args.spectrum:
        from orbiframe.delaunay import polygon_triangulation
        from orbiframe_invariants.laplace_spectrum import DEGREE, laplace_spectrum

        values = laplace_spectrum(
            polygon_triangulation(group),
            _polynomials(registry),
            args.spectrum,
            degree=DEGREE if args.degree is None else args.degree,
            tolerance=args.tolerance,
        )
        found["spectrum"] = _listed(values)
    if args.draw:
        found["picture"] = str(args.draw)
        if args.function is not None:
            found["function"] = {"number": args.function}
        _draw(args, group, registry, found.get("function", {}))
    return found


def _periods(group: Group, registry: Registry) -> dict[str, Any]:
    """The period matrix, rows of real and imaginary parts, and a bound of its error."""
    from orbiframe_invariants.periods import group_periods

    found = group_periods(group, _polynomials(registry))
    rows = [[[float(z.real) + 0.0, float(z.imag)] for z in row] for row in found.matrix]
    return {"matrix": rows, "error": found.error, "degree": found.forms.basis.degree}


def _listed(values: list[Eigenvalue]) -> list[dict[str, Any]]:
    return [{"value": e.value, "multiplicity": e.multiplicity, "error": e.error} for e in values]


def _draw(args: argparse.Namespace, group: Group, registry: Registry, about: dict[str, Any]) -> None:
    """Write the picture, and say which eigenvalue its function has."""
    function = None
    if args.function is not None:
        from orbiframe.delaunay import polygon_triangulation
        from orbiframe.functions import lifted
        from orbiframe_invariants.laplace_spectrum import eigenfunction

        space, coefficients, about["eigenvalue"] = eigenfunction(
            polygon_triangulation(group), _polynomials(registry), args.function
        )
        function = lifted(space, coefficients)
    draw_group = registry.load("picture", PICTURE)
    draw_group(args.draw, group, model=args.model, radius=args.radius, tiles=args.tiles, function=function)


def _polynomials(registry: Registry) -> Any:
    """The family of continuous piecewise polynomials of even degree."""
    bernstein = registry.load("basis", "bernstein")
    return lambda domain, degree: bernstein(domain.orbifold, domain, degree=degree)
