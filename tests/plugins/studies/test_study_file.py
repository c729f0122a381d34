"""What a study file says, and what is wrong in it is said before any work."""

from __future__ import annotations

import pytest
from orbiframe_studies.plan import Plan
from orbiframe_studies.study_file import read_study
from studies import written

from orbiframe import ConfigError, Registry


def plan_of(path, overrides=()) -> Plan:
    return Plan(read_study(path, overrides), Registry.discover())


def fits_of(plan: Plan):
    return [fit for chain in plan.chains() for fit in next(chain)]


def test_every_combination_in_the_order_of_the_file(tmp_path):
    path = written(
        tmp_path,
        '[sweep]\nbasis.name = ["gaussian", "wendland"]\nbasis.size = [10, 20]\n'
        '[[case]]\nname = "smooth"\nfitter.fairing = 0.1\n[[case]]\nname = "rough"\n',
    )
    plan = plan_of(path)
    assert (plan.expected, plan.chain_length) == (8, 1)
    titles = [fit.title for fit in fits_of(plan)]
    assert titles[:3] == [
        "cube.off, smooth, name gaussian, size 10",
        "cube.off, smooth, name gaussian, size 20",
        "cube.off, smooth, name wendland, size 10",
    ]
    assert titles[4] == "cube.off, rough, name gaussian, size 10"
    fits = fits_of(plan)
    assert len({fit.key for fit in fits}) == 8
    assert fits[0].tables["fitter"] == {"name": "least-squares", "fairing": 0.1}
    assert fits[0].tables["basis"] == {"name": "gaussian", "size": 10}


def test_patterns_are_sorted_and_a_mesh_counts_once(tmp_path):
    path = written(tmp_path, "")
    for name in ("b.off", "a.off"):
        (tmp_path / name).write_bytes((tmp_path / "cube.off").read_bytes())
    path.write_text(path.read_text().replace('["cube.off"]', '["b.off", "*.off"]'))
    assert [fit.name for fit in fits_of(plan_of(path))] == ["b.off", "a.off", "cube.off"]


def test_datasets_are_meshes_by_their_names(tmp_path):
    path = written(tmp_path, "")
    text = path.read_text()
    path.write_text(text.replace('["cube.off"]', '["dataset:torus", "cube.off"]'))
    fits = fits_of(plan_of(path))
    assert [fit.name for fit in fits] == ["dataset:torus", "cube.off"]
    assert fits[0].mesh.is_file()
    path.write_text(text.replace('["cube.off"]', '["dataset:tors"]'))
    with pytest.raises(ConfigError, match=r"line 3: there is no dataset 'tors'.* Did you mean 'torus'"):
        plan_of(path)


def test_a_key_is_the_content_and_not_the_words(tmp_path):
    first = fits_of(plan_of(written(tmp_path, "[sweep]\nbasis.width = [1.7, 2.0]")))
    # The default said aloud, under another name, from a copy of the mesh, with numbers written otherwise.
    (tmp_path / "other").mkdir()
    path = written(tmp_path / "other", '[basis]\nname = "gaussian"\n[sweep]\nbasis.width = [2, 1.70]')
    second = fits_of(plan_of(path))
    assert [fit.key for fit in second] == [fit.key for fit in reversed(first)]
    # Another size, other bytes of the mesh, other things to keep: other content.
    assert fits_of(plan_of(path, ["basis.size=50"]))[0].key not in {fit.key for fit in first}
    kept = path.read_text().replace('["cube.off"]', '["cube.off"]\nkeep = ["mesh"]')
    path.write_text(kept)
    assert fits_of(plan_of(path))[0].key != second[0].key
    with (tmp_path / "cube.off").open("a") as mesh:
        mesh.write("# a comment\n")
    assert fits_of(plan_of(tmp_path / "quick.toml"))[0].key != first[0].key


def test_a_plugin_file_belongs_to_the_content(tmp_path):
    plugin = tmp_path / "content_basis.py"
    text = (
        "from orbiframe import Component, hookimpl\n"
        "@hookimpl\ndef orbiframe_components():\n"
        '    return [Component("basis", "own", "orbiframe_bases.gaussian:Gaussian", "")]\n'
    )
    plugin.write_text(text)
    path = written(tmp_path, '[basis]\nname = "own"')
    path.write_text('plugins = ["content_basis.py"]\n' + path.read_text())
    before = fits_of(plan_of(path))[0].key
    plugin.write_text(text + "# edited\n")
    assert fits_of(plan_of(path))[0].key != before


def test_seeds_go_to_the_noise(tmp_path):
    path = written(tmp_path, "")
    path.write_text(path.read_text().replace('["cube.off"]', '["cube.off"]\nseeds = [3, 4]\nnoise = 0.001'))
    fits = fits_of(plan_of(path))
    assert [fit.seed for fit in fits] == [3, 4]
    assert fits[0].key != fits[1].key


WRONG = [
    ("[swep]\nbasis.size = [1]", ["quick.toml, line 10", "no table named 'swep'", "Did you mean 'sweep'?"]),
    ("[sweep]\nbasis.siez = [1]", ["quick.toml, line 11", "[basis] has no option 'siez'", "Did you mean 'size'?"]),
    ("[sweep]\nbasis.size = ['x']", ["quick.toml, line 11", "basis.size = 'x'", "integer"]),
    ("[sweep]\nbasis.size = 5", ["quick.toml, line 11", "a list of values is required"]),
    ("[sweep]\nbasis.size = []", ["a list of values is required"]),
    ("[sweep]\nbasis.size = [5, 5]", ["basis.size has a value twice"]),
    ("[sweep]\nsize = [5]", ["'size'; write TABLE.KEY"]),
    ("[sweep]\nbass.size = [5]", ["'bass.size'", "Did you mean 'basis'?"]),
    ("[sweep]\nbasis.name = ['gausian']", ["no basis named 'gausian'", "Did you mean 'gaussian'?"]),
    ("[[case]]\nbasis.size = 3", ["case 1 has no name"]),
    ("[[case]]\nname = 'a'\n[[case]]\nname = 'a'", ["two cases are named 'a'"]),
    ("[[case]]\nname = 'a'\nbasis.size = 'b'", ["basis.size = 'b'"]),
    ("[case]\nname = 'a'", ["[[case]]"]),
    (
        "[[case]]\nname = 'a'\nbasis.size = 3\n[sweep]\nbasis.size = [4]",
        ["set by [sweep] and by [[case]]"],
    ),
    ("[until]\nbelow = 0", ["until.below = 0"]),
    ("[until]\nbelow = 0.1\nfactor = 1", ["until.factor = 1"]),
    ("[until]\nbelow = 0.1\nmost = 5", ["until.most = 5.0 is below the start"]),
    ("[until]\nbelow = 0.1\nmeasure = 'rms'", ["until.measure = 'rms'", "'fit.rms' or 'fit.max'"]),
    ("[until]\nbelow = 0.1\nkey = 'basis.siez'", ["[basis] has no option 'siez'"]),
    ("[until]\nstart = 10", ["[until] needs the option 'below'"]),
    ("[until]\nbelow = 1\n[search]\ntrials = 1\nspace = {basis = {width = [1.0]}}", ["[until] or [search], not both"]),
    ("[search]\ntrials = 3\nspace = {}", ["[search] needs a space"]),
    ("[search]\ntrials = 3\nspace = {basis = {width = 3}}", ["search.space.basis.width = 3", "low"]),
    ("[search]\ntrials = 3\nspace = {basis = {width = {low = 3, high = 1}}}", ["low must be below high"]),
    ("[search]\ntrials = 3\nspace = {basis = {wdith = {low = 1, high = 2}}}", ["'wdith'", "Did you mean 'width'?"]),
    ("plugins = 3", ["[output] has no option 'plugins'"]),
]


@pytest.mark.parametrize(("text", "said"), WRONG, ids=[text for text, _ in WRONG])
def test_what_is_wrong_is_said_with_its_place(tmp_path, text, said):
    with pytest.raises(ConfigError) as caught:
        plan_of(written(tmp_path, text))
    for words in said:
        assert words in str(caught.value)


SETTINGS = [
    ('["cbue.off"]', ["quick.toml, line 3", "there is no mesh", "Did you mean 'cube.off'?"]),
    ('["*.obj"]', ["no file is like '*.obj'"]),
    ("[]", ["study.meshes = []"]),
    ('"cube.off"', ["study.meshes = 'cube.off'"]),
    ('["/dev/null"]', ["/dev/null is no regular file"]),
    ('["cube.off"]\nseeds = [1, 1]\nnoise = 0.1', ["study.seeds has a number twice"]),
    ('["cube.off"]\nseeds = [1]', ["quick.toml, line 4", "option 'seed'", "study.noise"]),
    ('["cube.off"]\nnoise = 0.1', ["study.noise needs seeds"]),
    ('["cube.off"]\nkeep = ["array"]', ["study.keep[0] = ['array']", "'arrays'"]),
    ('["cube.off"]\nmemory = 0', ["study.memory = 0"]),
    ('["cube.off"]\nmehses = 3', ["'mehses'", "Did you mean 'meshes'?"]),
]


@pytest.mark.parametrize(("value", "said"), SETTINGS, ids=[value for value, _ in SETTINGS])
def test_what_is_wrong_with_the_settings_is_said(tmp_path, value, said):
    path = written(tmp_path, "")
    path.write_text(path.read_text().replace('["cube.off"]', value))
    with pytest.raises(ConfigError) as caught:
        plan_of(path)
    for words in said:
        assert words in str(caught.value)


def test_an_override_of_what_is_varied_is_refused_and_one_of_the_sweep_wins(tmp_path):
    path = written(tmp_path, "[sweep]\nbasis.size = [10, 20]")
    with pytest.raises(ConfigError, match=r"basis\.size is set by --set basis\.size=5 and by \[sweep\]"):
        plan_of(path, ["basis.size=5"])
    assert [fit.parameters["basis.size"] for fit in fits_of(plan_of(path, ["sweep.basis.size=[30]"]))] == [30]
    assert fits_of(plan_of(path, {"basis.width": 2.0}))[0].tables["basis"] == {"width": 2.0, "size": 10}


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"[basis]\nsize = 3\n", r"no table \[study\]"),
        (b"[study]\nmeshes = '\xe9'\n", r"s\.toml cannot be read"),
        (b"[study\n", r"s\.toml is not TOML"),
        (b"study = 3\n", "'study' must be a table"),
    ],
)
def test_files_that_are_no_study(tmp_path, content, said):
    path = tmp_path / "s.toml"
    path.write_bytes(content)
    with pytest.raises(ConfigError, match=said):
        read_study(path)
    with pytest.raises(ConfigError, match=r"absent\.toml cannot be read"):
        read_study(tmp_path / "absent.toml")
