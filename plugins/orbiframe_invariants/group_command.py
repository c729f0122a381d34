"""orbiframe group: a closed surface from a gluing word, its group, its spectrum and its picture."""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from orbiframe import Registry, UsageError
from orbiframe.files import require_picture
from orbiframe_invariants.symbol_description import describe_symbol, is_symbol, symbol_group, symbol_rows

if TYPE_CHECKING:
    from orbiframe import Group, Word

# The shape of a surface of each sign of the Euler characteristic that is meant by "regular".
_REGULAR = {1: "finite", 0: "lattice", -1: "regular-polygon"}
_WORD_HELP = (
    "how the sides of a polygon are glued, such as abABcdCD, capitals being inverses; or bolza or klein-quartic; or "
    "Conway's symbol of an orbifold, such as *237, 4*2 or xx"
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

    if args.spectrum is not None and args.spectrum < 1:
        raise UsageError(f"--spectrum {args.spectrum}: ask for at least 1 eigenvalue")
    _require_picture(args, registry)
    if is_symbol(args.word):
        orbifold = symbol_group(args, registry)
        found = describe_symbol(orbifold, args.word) | _computed(args, orbifold, registry)
    else:
        word = word_named(args.word)
        found = _described(word)
        if args.prove:
            found["proof"] = _proof(word, args.polygon)
        if args.systole or args.spectrum or args.draw:
            found.update(_computed(args, _group(word, args.polygon, registry), registry))
    print(json.dumps(found) if args.json else "\n".join(_lines(found)))
    return 0


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


def _described(word: Word) -> dict[str, Any]:
    """What a word says without numbers."""
    from orbiframe.words import Presentation, text_of

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
    if args.spectrum:
        from orbiframe.delaunay import polygon_triangulation
        from orbiframe_invariants.laplace_spectrum import laplace_spectrum

        values = laplace_spectrum(polygon_triangulation(group), _polynomials(registry), args.spectrum)
        found["spectrum"] = [{"value": e.value, "multiplicity": e.multiplicity, "error": e.error} for e in values]
    if args.draw:
        found["picture"] = str(args.draw)
        if args.function is not None:
            found["function"] = {"number": args.function}
        _draw(args, group, registry, found.get("function", {}))
    return found


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


def _lines(found: dict[str, Any]) -> list[str]:
    """The same in words."""
    rows = symbol_rows(found) if "symbol" in found else _word_rows(found)
    return [f"{name:<10}{text}" for name, text in rows + _computed_rows(found)]


def _word_rows(found: dict[str, Any]) -> list[tuple[str, str]]:
    surface = found["surface"]
    rows = [
        ("word", found["word"]),
        ("surface", f"{surface['name']}, Euler characteristic {surface['euler_characteristic']}"),
        ("relations", ", ".join(f"{relation} = 1" for relation in found["relations"])),
        ("homology", found["homology"]),
    ]
    if proof := found.get("proof"):
        rows.append(("proof", f"exact, in {proof['ring']}"))
    if standard := found.get("standard"):
        rows += [("standard", standard["word"]), ("", f"with {_equations(standard['letters'])}")]
        rows += [("", f"and {_equations(standard['given'])}")]
    return rows


def _computed_rows(found: dict[str, Any]) -> list[tuple[str, str]]:
    rows = []
    if shortest := found.get("systole"):
        rows.append(("systole", f"{shortest['length']:.12g}, {shortest['multiplicity']} closed geodesics"))
    rows += [
        ("spectrum" if k == 0 else "", f"{e['value']:.12g} ({e['multiplicity']})")
        for k, e in enumerate(found.get("spectrum", []))
    ]
    if "function" in found:
        rows.append(("function", f"{found['function']['number']}, eigenvalue {found['function']['eigenvalue']:.9g}"))
    if "picture" in found:
        rows.append(("picture", found["picture"]))
    return rows


def _equations(change: dict[str, str]) -> str:
    """Letters and their words, such as "a = bC, b = c"."""
    return ", ".join(f"{letter} = {text or '1'}" for letter, text in change.items())
