"""Shorter STEP files: the same points at every reference, text as it was."""

from __future__ import annotations

import re

from orbiframe_exact.step_text import shorter

TEXT = """DATA;
#1 = PRODUCT('#3 = x','it''s #4','',(#2));
#2 = CARTESIAN_POINT('',(0.,1.,2.));
#3 = CARTESIAN_POINT('',(0.,1.,3.));
#4 = CARTESIAN_POINT('',(0.,1.
    ,2.));
#44 = CARTESIAN_POINT('named',(0.,1.,2.));
#5 = B_SPLINE_CURVE_WITH_KNOTS('',1,(#2,#3,#4
    ,#44),.UNSPECIFIED.);
ENDSEC;
"""


def test_points_are_written_once_and_names_in_text_stay() -> None:
    assert shorter(TEXT) == (
        "DATA;\n#1=PRODUCT('#3 = x','it''s #4','',(#2));\n#2=CARTESIAN_POINT('',(0.,1.,2.));\n"
        "#3=CARTESIAN_POINT('',(0.,1.,3.));\n#44=CARTESIAN_POINT('named',(0.,1.,2.));\n"
        "#5=B_SPLINE_CURVE_WITH_KNOTS('',1,(#2,#3,#2\n,#44),.UNSPECIFIED.);\nENDSEC;\n"
    )


def test_a_shorter_text_stays_as_it_is() -> None:
    assert shorter(shorter(TEXT)) == shorter(TEXT)


def test_every_reference_is_to_something() -> None:
    text = shorter(TEXT)
    names = set(re.findall(r"^(#\d+)=", text, re.MULTILINE))
    assert set(re.findall(r"[(,](#\d+)", text)) <= names


def test_small_coordinates_have_no_exponent_and_are_the_same_numbers() -> None:
    points = "#2 = CARTESIAN_POINT('',(1.5E-02,-2.E-03,6.25E-12));\n#3 = CARTESIAN_POINT('1.5E-02',(0.,1.,2.));\n"
    found = shorter(points)
    assert found == "#2=CARTESIAN_POINT('',(0.015,-0.002,6.25E-12));\n#3=CARTESIAN_POINT('1.5E-02',(0.,1.,2.));\n"
