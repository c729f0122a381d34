"""Every law on every installed component, and every mutant rejected by its law."""

from __future__ import annotations

from itertools import islice

import pytest

from orbiframe.cli import plugin as commands
from orbiframe.components.registry import Registry, resolve
from orbiframe.errors import OrbiframeError, PluginError, UsageError
from orbiframe.plugin import KINDS, Component
from orbiframe.testing import Lab, Untried, component_laws, contract_tests, laws_of
from orbiframe.testing.check import check, equipments
from orbiframe.testing.kit import bound, has_laws, tried
from orbiframe.words import standard_word

REGISTRY = Registry.discover()
REGISTRY.register("commands", commands)
DECLARED = [component for component, _ in REGISTRY.declarations()]


def title(component: Component) -> str:
    return f"{component.kind}/{component.name}"


def component_cases():
    """Readers, writers and exporters of several suffixes on the first; `tests/plugins` tries the others."""
    return [
        pytest.param(component, equipment, law, id=" ".join([title(component), *suffix(equipment), law.__name__]))
        for component in DECLARED
        for equipment in islice(equipments(component, REGISTRY), 1)
        if tried_here(component, equipment)
        for law in laws_of(component.kind).laws
    ]


def tried_here(component: Component, equipment: dict) -> bool:
    """Readers of formats that nobody writes have tests of their own; Open3D signs FBX with the time."""
    alone = component.kind == "reader" and equipment.get("counterpart") is None
    return not alone and component.name not in ("nastran", "open3d")


def suffix(equipment: dict) -> list[str]:
    return [equipment["suffix"]] if "suffix" in equipment else []


def mutant_cases():
    """Each mutation on the first installed component of its kind that needs no extra."""
    return [pytest.param(kind, name, id=f"{kind} {name}") for kind in KINDS for name in sorted(laws_of(kind).mutants)]


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_has_laws_a_mutant_for_each_and_a_component(kind):
    laws = laws_of(kind)
    names = [law.__name__ for law in laws.laws]
    assert len(set(names)) == len(names) > 0
    assert sorted(laws.mutants) == sorted(names)
    assert all(law.__doc__ for law in laws.laws)
    assert REGISTRY.components(kind)


@pytest.mark.parametrize("law", component_laws.LAWS, ids=lambda law: law.__name__)
@pytest.mark.parametrize("component", DECLARED, ids=title)
def test_every_component_keeps_the_laws_of_components(component, law):
    require_extra(component)
    law(component)


def require_extra(component: Component) -> None:
    """Skip what comes with an extra that is not installed here: none of the development's, but Intel's libraries."""
    try:
        resolve(component)
    except PluginError as error:
        if not (component.extra and "is not installed" in str(error)):
            raise
        pytest.skip(str(error))


@pytest.mark.parametrize(("component", "equipment", "law"), component_cases())
def test_every_component_keeps_the_laws_of_its_kind(component, equipment, law, tmp_path):
    require_extra(component)
    try:
        law(bound(resolve(component), equipment.get("params", {})), Lab(tmp_path, **equipment))
    except Untried as reason:
        pytest.skip(str(reason))


@pytest.mark.parametrize(("kind", "name"), mutant_cases())
def test_every_mutant_is_rejected(kind, name, tmp_path):
    laws = laws_of(kind)
    law = next(law for law in laws.laws if law.__name__ == name)
    installed = [c for c in REGISTRY.components(kind) if not c.extra]
    assert any(rejected(law, laws.mutants[name], c, tmp_path / c.name) for c in installed)


def rejected(law, mutation, component: Component, folder) -> bool:
    equipment = next(iter(equipments(component, REGISTRY)))
    folder.mkdir()
    broken = mutation(bound(resolve(component), equipment.get("params", {})))
    return tried(law, broken, Lab(folder, **equipment)).error is not None


MALFORMED = {
    "target_resolves": Component("basis", "a", "no_such_package_anywhere:f", "one line"),
    "signature_fits": Component("basis", "a", "tests_of_the_kit:one_argument", "one line"),
    "options_documented": Component("fitter", "a", "tests_of_the_kit:undocumented", "one line"),
    "summary_is_one_line": Component("fitter", "a", "tests_of_the_kit:documented", "One line. And a stop."),
    "suffixes_are_written_alike": Component(
        "reader", "a", "tests_of_the_kit:one_argument", "one line", None, (".OFF",)
    ),
}


@pytest.fixture
def _helper_module(monkeypatch):
    import sys
    import types

    module = types.ModuleType("tests_of_the_kit")
    module.one_argument, module.undocumented, module.documented = one_argument, undocumented, documented
    monkeypatch.setitem(sys.modules, "tests_of_the_kit", module)


def one_argument(x):
    """One."""


def undocumented(*, strength: float = 1.0):
    """Nothing is said."""


def documented(*, strength: float = 1.0):
    """strength: how strong."""


@pytest.mark.usefixtures("_helper_module")
@pytest.mark.parametrize("name", [law.__name__ for law in component_laws.LAWS])
def test_every_malformed_component_is_rejected(name):
    law = next(law for law in component_laws.LAWS if law.__name__ == name)
    with pytest.raises((AssertionError, OrbiframeError)):
        law(MALFORMED[name])


@pytest.mark.usefixtures("_helper_module")
def test_a_component_that_cannot_be_imported_gets_one_verdict():
    (verdict,) = check(MALFORMED["target_resolves"], REGISTRY)
    assert "no_such_package_anywhere" in verdict.error


def test_a_kind_without_laws_is_named():
    assert [kind for kind in KINDS if has_laws(kind)] == list(KINDS)
    with pytest.raises(UsageError, match="no laws for the kind 'spline'; kinds with laws: geometry"):
        laws_of("spline")


test_h2_by_the_public_way = contract_tests("geometry", REGISTRY.load("geometry", "h2"))


class Elsewhere:
    """A geometry whose every construction fails."""

    def __init__(self) -> None:
        raise ValueError("nothing works")


test_expected_failures_are_strict = contract_tests(
    "geometry",
    Elsewhere,
    expected_failures={law.__name__: "the component cannot even be made" for law in laws_of("geometry").laws},
)


def test_expected_failures_are_laws():
    with pytest.raises(UsageError, match="no law of the kind 'geometry' is named 'no_such_law'"):
        contract_tests("geometry", Elsewhere, expected_failures={"no_such_law": "why"})


def test_options_are_bound(tmp_path):
    seen = []

    def recorded(*, scale: float = 1.0) -> None:
        seen.append(scale)
        raise ValueError

    test = contract_tests("geometry", recorded, params={"scale": 0.4})
    with pytest.raises(ValueError):  # noqa: PT011
        test(laws_of("geometry").laws[0], tmp_path)
    assert seen == [0.4]


def test_a_fitter_that_does_not_claim_to_be_linear_is_not_tried(tmp_path):
    base = type(REGISTRY.load("fitter", "least-squares")())
    law = next(law for law in laws_of("fitter").laws if law.__name__ == "result_is_linear_in_the_values")

    class Cubed(base):
        """As good as linear for small values, and not linear."""

        linear = False

        def fit(self, basis, samples):
            found = super().fit(basis, samples)
            return found + 1e-3 * found**3

    assert tried(law, Cubed, Lab(tmp_path)).untried == "it does not claim to be linear (Fitter.linear)"
    Cubed.linear = True
    assert "differ" in tried(law, Cubed, Lab(tmp_path)).error


def test_a_group_that_has_the_word_and_not_the_relations_is_rejected(tmp_path):
    """The generators of one gluing under the word of another one of the same surface."""
    regular = REGISTRY.load("group", "regular-polygon")

    def stubborn(geometry, word):
        group = regular(geometry, standard_word(word.euler_characteristic, word.orientable))
        group.word = word
        return group

    verdicts = [tried(law, stubborn, Lab(tmp_path)) for law in laws_of("group").laws]
    assert any(verdict.error for verdict in verdicts)
    assert verdicts[0].law == "the_word_is_the_one_asked_for"
    assert verdicts[0].error is None
