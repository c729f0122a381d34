"""What people use of a study: tables, orders, the page, comparisons."""

from __future__ import annotations

import html
import json
import math
import re

import pytest
from orbiframe_studies.orders import fitted_order, series_of
from orbiframe_studies.report_command import told_apart
from orbiframe_studies.results import Results
from studies import lines, written

from orbiframe import FormatError, UsageError

SWEEP = '[sweep]\nbasis.name = ["gaussian", "ps2"]\nbasis.size = [20, 40]\n'


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    from orbiframe.cli.main import main

    folder = tmp_path_factory.mktemp("studies")
    (folder / "<b>.off").write_text("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
    path = written(folder, SWEEP)
    text = path.read_text().replace('["cube.off"]', '["cube.off", "<b>.off"]\nkeep = ["arrays"]')
    path.write_text(text)
    assert main(["run", str(path), "--workers", "1", "--quiet"]) == 1
    return path


@pytest.mark.parametrize("order", [0.5, 2.0, 4.0])
def test_an_order_is_found_again(order):
    unknowns = [50, 100, 400, 1000]
    errors = [3.0 * n ** (-order / 2) for n in unknowns]
    assert fitted_order(unknowns, errors) == pytest.approx(order)


@pytest.mark.parametrize(
    ("names", "short"),
    [
        (["a.off, ps2, size 1", "a.off, ps3, size 1"], ["ps2, size 1", "ps3, size 1"]),
        (["a.off, ps2", "b.off, ps2"], ["a.off, ps2", "b.off, ps2"]),
        (["a.off", "a.off, ps2"], ["a.off", "a.off, ps2"]),
        (["a.off, ps2", "a.off, ps2"], ["ps2", "ps2"]),
        (["a.off, ps2"], ["a.off, ps2"]),
        ([], []),
    ],
)
def test_names_leave_out_what_all_begin_with(names, short):
    assert told_apart(names) == short


def test_one_size_has_no_order():
    assert fitted_order([10, 10], [1.0, 2.0]) is None
    assert fitted_order([10, 20], [1.0, 0.0]) is None


def test_series_differ_in_more_than_the_size(study):
    found = series_of(Results.of(study).rows())
    assert [series.name for series in found] == ["cube.off, gaussian", "cube.off, ps2"]
    assert all(len(series.errors) == 2 and series.order > 0 for series in found)
    assert found[0].unknowns == (20, 40)
    assert series_of(Results.of(study).rows(), "fit.max")[0].errors > found[0].errors


def test_frames_of_pandas_and_polars_have_the_rows(study):
    results = Results.of(study)
    frame = results.to_pandas()
    assert list(frame["basis.size"]) == [20, 40] * 4
    assert list(frame["status"]) == ["done"] * 4 + ["failed"] * 4
    row = next(results.rows())
    assert frame["fit.rms"][0] == row["report"]["fit"]["rms"]
    assert math.isnan(frame["fit.rms"][7])
    assert (frame["timing.total"] > 0).all()
    same = results.to_polars()
    assert same["fit.rms"].to_list()[:4] == list(frame["fit.rms"][:4])
    assert same["error.type"].to_list()[4:] == ["TopologyError"] * 4


def test_the_page_shows_all_and_needs_nothing_else(orbiframe, study):
    ran = orbiframe("report", study)
    assert ran.status == 0
    assert re.search(r"cube\.off, gaussian: 2 fits, least error \S+, order \d", ran.out)
    page = (study.with_suffix("") / "report.html").read_text()
    assert page.count('<tr class="failed">') == 4
    assert page.count("<svg") == 2
    assert page.count("data:image/png;base64,") == 4
    assert "&lt;b&gt;.off" in page
    assert "<b>.off" not in page
    assert not re.search(r'(?:src|href)="(?!data:|#)', page)
    assert not re.search(r"<script[^>]+src|@import|<link", page)
    error = list(Results.of(study).rows())[7]["error"]["text"]
    for words in ("order ", "unknowns", "seconds", html.escape(error)):
        assert words in page
    again = orbiframe("report", study, "-o", study.with_name("again.html"), "--quiet")
    assert (again.status, again.out) == (0, "")
    assert study.with_name("again.html").read_text() == page


def test_a_study_is_equal_to_itself_and_differences_are_named(orbiframe, study, tmp_path):
    ran = orbiframe("compare", study, study)
    assert "8 in both, 8 with equal fit.rms" in ran.out
    other = tmp_path / "other"
    other.mkdir()
    folder = study.with_suffix("")
    for name in ("study.json", "timings.jsonl"):
        (other / name).write_bytes((folder / name).read_bytes())
    rows = lines(folder / "table.jsonl")
    rows[0]["report"]["fit"]["rms"] *= 2
    rows[1]["parameters"]["basis.size"] = 41
    (other / "table.jsonl").write_text("".join(json.dumps(row) + "\n" for row in rows))
    found = json.loads(orbiframe("compare", study, other, "--json").out)
    assert (found["fits"], found["equal"]) == (7, 6)
    assert found["error"] == pytest.approx(2 ** (1 / 3))
    assert found["seconds"] == pytest.approx(1.0)
    (pair,) = found["different"]
    assert pair["second"]["error"] == 2 * pair["first"]["error"]
    assert [len(found["only_first"]), len(found["only_second"])] == [1, 1]
    ran = orbiframe("compare", study, other)
    assert "only in B cube.off" in ran.out


@pytest.mark.parametrize("command", ["report", "compare"])
def test_what_is_no_study_is_refused(orbiframe, study, tmp_path, command):
    more = [study] if command == "compare" else []
    ran = orbiframe(command, tmp_path, *more)
    assert (ran.status, "no folder of a study" in ran.err) == (2, True)
    ran = orbiframe(command, study, *more, "--measure", "fit.rsm")
    assert (ran.status, "Did you mean 'fit.rms'?" in ran.err) == (2, True)


def test_tables_that_are_damaged_say_where(study, tmp_path):
    folder = study.with_suffix("")
    (tmp_path / "study.json").write_bytes((folder / "study.json").read_bytes())
    results = Results.of(tmp_path)
    with pytest.raises(FormatError, match=r"table\.jsonl cannot be read.*run the study again"):
        list(results.rows())
    (tmp_path / "table.jsonl").write_text('{"run": 0, "key": "a"}\n{"run": 1, "k')
    with pytest.raises(FormatError, match=r"table\.jsonl, line 2"):
        list(results.rows())
    with pytest.raises(FormatError, match="no arrays of a fit"):
        results.arrays("absent")
    with pytest.raises(UsageError):
        Results.of(tmp_path / "absent")
