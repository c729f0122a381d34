"""The laws of a group whose polygon is glued by a word."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cache
from typing import Any, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from orbiframe.components.registry import Registry
from orbiframe.errors import GeometryError
from orbiframe.groups.elements import elements_within
from orbiframe.groups.group import Group
from orbiframe.orbifolds.atlas import Atlas
from orbiframe.planes.geometry import Geometry
from orbiframe.testing.lab import Lab
from orbiframe.words.word import Word

Floats = NDArray[np.float64]
Component = Callable[[Geometry, Word], Group]

# sin, the identity, sinh by curvature, and their inverses.
_SINE: dict[int, Callable[[Any], Any]] = {1: np.sin, 0: np.asarray, -1: np.sinh}
_ARCSINE: dict[int, Callable[[Any], Any]] = {1: np.arcsin, 0: np.asarray, -1: np.arcsinh}

# A group component may decline a surface with GeometryError; it is tried on those that it takes.
CASES = (
    ("s2", "aA"),
    ("s2", "aa"),
    ("e2", "abAB"),
    ("e2", "abaB"),
    ("e2", "aabb"),
    ("h2", "abABcdCD"),
    ("h2", "abcdABCD"),
    ("h2", "aabbcc"),
    ("h2", "abACbC"),
)


def the_word_is_the_one_asked_for(component: Component, _: Lab) -> None:
    """The group has the geometry and the word that it was asked for: no other group under the name of this one."""
    for geometry, word, group in _asked(component):
        assert group.word.letters == word.letters, f"asked for '{word}', the group has the word '{group.word}'"
        assert group.geometry.curvature == geometry.curvature, f"the group of '{word}' lives in another geometry"


def pairings_are_isometries(component: Component, _: Lab) -> None:
    """The transitions of the atlas preserve X and its metric, and the first is the identity."""
    for group in _groups(component):
        atlas = group.atlas()
        assert np.array_equal(atlas.isometry[0], np.eye(3)), "transition 0 is not the identity"
        _within(group, group.geometry.isometry_defect(atlas.isometry))
        _within(group, group.geometry.isometry_defect(group.tiles(_radius(group))))


def twins_are_inverse(component: Component, _: Lab) -> None:
    """The pairing of a side and that of its mate are inverse to each other."""
    for group in _groups(component):
        atlas = group.atlas()
        assert np.array_equal(atlas.inverse[atlas.inverse], np.arange(len(atlas.inverse))), "not an involution"
        _within(group, atlas.isometry @ atlas.isometry[atlas.inverse] - np.eye(3))


def cycle_relations_hold(component: Component, _: Lab) -> None:
    """The product of the pairings of the sides that one crosses round a vertex is the identity."""
    for group in _groups(component):
        for relation in group.word.letter_relations:
            _within(group, group.element(relation) - np.eye(3))


def orientation_matches_the_word(component: Component, _: Lab) -> None:
    """A generator reverses orientation if and only if its letter occurs twice with the same sign."""
    for group in _groups(component):
        for side, letter in enumerate(group.word.letters):
            parity = group.geometry.parity(group.generator(abs(letter)))
            assert parity == (-1 if group.word.reverses(side) else 1), f"letter {abs(letter)} has parity {parity}"


def area_obeys_gauss_bonnet(component: Component, _: Lab) -> None:
    """The area is positive, and curvature times area is 2 pi times the Euler characteristic of the word."""
    for group in _groups(component):
        assert group.area > 0, f"area {group.area}"
        _within(group, group.geometry.curvature * group.area - 2 * np.pi * group.word.euler_characteristic)


def elements_have_no_fixed_point(component: Component, _: Lab) -> None:
    """Every element other than the identity moves every point: X/H is a surface without singular points."""
    free = ("translation", "glide", "rotary reflection")
    for group in _groups(component):
        for g in group.tiles(_radius(group))[1:]:
            assert group.geometry.classify(g, 1e-6) in free, f"a {group.geometry.classify(g, 1e-6)} is in the group"


def reduction_is_idempotent_and_invariant(component: Component, lab: Lab) -> None:
    """reduce gives y = g x; it leaves y alone; and it takes a point and its images under the group to the same y."""
    for group in _groups(component):
        x = _points(group, lab, 50)
        y, g = group.reduce(x)
        _within(group, group.geometry.act(g, x) - y)
        again, identity = group.reduce(y)
        _within(group, again - y)
        _within(group, identity - np.eye(3))
        for h in group.tiles(_radius(group))[:20]:
            _within(group, group.reduce(group.geometry.act(h, x))[0] - y)


def tiles_cover_a_disc_once(component: Component, lab: Lab) -> None:
    """Each point of a disc lies in exactly one tile, and the share that lies in F has the area of X/H."""
    for group in _groups(component):
        tiles, x = group.tiles(_radius(group)), _points(group, lab, 200)
        pulled = group.geometry.act(group.geometry.inverse(tiles)[:, None], x)
        counts = _inside(group, pulled).sum(axis=0)
        assert (counts == 1).all(), f"points lie in {sorted(set(counts.tolist()))} tiles"
        share = _inside(group, _points(group, lab, 20_000)).mean()
        assert abs(share * _disc_area(group) / group.area - 1) < 0.06, f"area of F {share * _disc_area(group):.4g}"


def tiles_are_named_by_words(component: Component, _: Lab) -> None:
    """The tiles are what words in the generators make: every tile has a word, and no word with a near image is missing.

    The words come from walks that start at the pairings of the atlas and know nothing of `tiles`.
    """
    for group in _groups(component):
        radius = 2 * _radius(group)
        tiles = group.tiles(radius)
        centres = group.geometry.distance(group.geometry.origin, tiles[..., 0])
        found = elements_within(group, max(radius, float(centres.max())) + 1e-6)
        matrices = found.precise().matrix
        apart = np.abs(tiles[:, None] - matrices).max(axis=(2, 3))
        _within(group, apart.min(axis=1))
        _within(group, apart.min(axis=0)[found.distance <= radius - 1e-6])
        for number in range(0, len(found), 1 + len(found) // 50):
            _within(group, group.element(found.word(number)) - matrices[number])


LAWS: tuple[Callable[[Component, Lab], None], ...] = (
    the_word_is_the_one_asked_for,
    pairings_are_isometries,
    twins_are_inverse,
    cycle_relations_hold,
    orientation_matches_the_word,
    area_obeys_gauss_bonnet,
    elements_have_no_fixed_point,
    reduction_is_idempotent_and_invariant,
    tiles_cover_a_disc_once,
    tiles_are_named_by_words,
)


# ---- mutants --------------------------------------------------------------------------------------------------------


class _Altered(Group):
    """A group of which some methods or attributes are replaced; each replacement gets the original group first."""

    def __init__(self, group: Group, changes: dict[str, Callable[..., Any]]) -> None:
        self._group, self._changes = group, changes
        self.geometry, self.word = group.geometry, group.word
        self.area = changes["area"](group) if "area" in changes else group.area

    def atlas(self) -> Atlas:
        return cast(Atlas, self._ask("atlas"))

    def tiles(self, radius: float) -> Floats:
        return cast(Floats, self._ask("tiles", radius))

    def reduce(self, x: ArrayLike) -> tuple[Floats, Floats]:
        return cast("tuple[Floats, Floats]", self._ask("reduce", x))

    def generator(self, label: int) -> Floats:
        return cast(Floats, self._ask("generator", label))

    def _ask(self, name: str, *args: object) -> object:
        if name in self._changes:
            return self._changes[name](self._group, *args)
        return getattr(self._group, name)(*args)


def _altered(**changes: Callable[..., Any]) -> Callable[[Component], Component]:
    return lambda component: lambda geometry, word: _Altered(component(geometry, word), changes)


def _bent_atlas(group: Group) -> Atlas:
    atlas = group.atlas()
    return _with_isometries(atlas, atlas.isometry * np.where(np.arange(3) == 1, 1.0, 1.001))


def _turned_atlas(group: Group) -> Atlas:
    atlas = group.atlas()
    return _with_isometries(atlas, atlas.isometry @ group.geometry.rotation(0.1))


def _without_second(tiles: Floats) -> Floats:
    return np.concatenate([tiles[:1], tiles[2:]])


def _with_isometries(atlas: Atlas, isometry: Floats) -> Atlas:
    return Atlas(atlas.geometry, atlas.radius, atlas.tail, atlas.head, atlas.inverse, isometry)


def _of_another_word(component: Component) -> Component:
    """The group of another word of the same surface: its letters one place on."""
    return lambda geometry, word: component(geometry, Word((*word.letters[1:], word.letters[0])))


MUTANTS: dict[str, Callable[[Component], Component]] = {
    "the_word_is_the_one_asked_for": _of_another_word,
    "pairings_are_isometries": _altered(atlas=_bent_atlas),
    "twins_are_inverse": _altered(atlas=_turned_atlas),
    "cycle_relations_hold": _altered(generator=lambda g, label: g.generator(label) @ g.geometry.rotation(0.1 * label)),
    "orientation_matches_the_word": _altered(generator=lambda g, a: g.generator(a) @ g.geometry.reflection(0.0)),
    "area_obeys_gauss_bonnet": _altered(area=lambda g: g.area + 0.1 if g.geometry.curvature else -g.area),
    "elements_have_no_fixed_point": _altered(
        tiles=lambda g, radius: np.concatenate([g.tiles(radius), g.geometry.rotation(2 * np.pi / 3)[None]])
    ),
    "reduction_is_idempotent_and_invariant": _altered(
        reduce=lambda _, x: tuple(np.array(part) for part in (x, np.broadcast_to(np.eye(3), (*np.shape(x), 3))))
    ),
    "tiles_cover_a_disc_once": _altered(tiles=lambda g, radius: np.repeat(g.tiles(radius), 2, axis=0)),
    "tiles_are_named_by_words": _altered(tiles=lambda g, radius: _without_second(g.tiles(radius))),
}


# ---- things to try --------------------------------------------------------------------------------------------------


@cache
def _geometry(name: str) -> Geometry:
    return cast(Geometry, Registry.discover().load("geometry", name)())


def _groups(component: Component) -> Iterator[Group]:
    return (group for _, _, group in _asked(component))


def _asked(component: Component) -> Iterator[tuple[Geometry, Word, Group]]:
    """Geometry and word of the cases that the component takes, with the group that it gives."""
    taken = 0
    for name, text in CASES:
        geometry, word = _geometry(name), Word.parse(text)
        try:
            group = component(geometry, word)
        except GeometryError:
            continue
        taken += 1
        yield geometry, word, group
    assert taken, "the component takes none of the surfaces " + ", ".join(f"{text} in {name}" for name, text in CASES)


def _radius(group: Group) -> float:
    """A disc that contains F."""
    return float(min(np.pi, 1.02 * group.atlas().radius[0]))


def _disc_area(group: Group) -> float:
    return float(4 * np.pi * _SINE[group.geometry.curvature](_radius(group) / 2) ** 2)


def _points(group: Group, lab: Lab, count: int) -> Floats:
    """Points that are uniformly spread over the disc: the area within r grows like S(r/2)^2."""
    sine, arcsine = _SINE[group.geometry.curvature], _ARCSINE[group.geometry.curvature]
    half = arcsine(sine(_radius(group) / 2) * np.sqrt(lab.rng.uniform(0, 1, count)))
    return group.geometry.from_polar(2 * half, lab.rng.uniform(-np.pi, np.pi, count))


def _inside(group: Group, x: Floats) -> NDArray[np.bool_]:
    """Whether points lie in F: those that reduction leaves alone."""
    y, _ = group.reduce(x)
    return np.asarray(group.geometry.distance(x, y) < 1e-6)


def _within(group: Group, defect: ArrayLike) -> None:
    """Rounding errors of group elements grow like cosh^2 of the size of F, a few times over."""
    allowed = 1e-12 * np.cosh(2 * _radius(group)) ** 2
    worst = float(np.abs(defect).max())
    assert worst <= allowed, f"'{group.word}': off by {worst:.3g}, allowed is {allowed:.3g}"
