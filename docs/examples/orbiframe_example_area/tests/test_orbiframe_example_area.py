"""The laws of commands, tried on `orbiframe area`, and what it prints."""

from orbiframe_example_area.command import configure

from orbiframe import write
from orbiframe.cli.main import main
from orbiframe.testing import Lab, contract_tests

test_area = contract_tests("command", configure)


def test_a_torus_has_no_total_curvature(tmp_path, capsys):
    """By Gauss and Bonnet."""
    write(tmp_path / "torus.off", Lab(tmp_path).polyhedra["torus"])
    assert main(["area", str(tmp_path / "torus.off"), "--size", "100"]) == 0
    area, curvature = (float(line.split()[-1]) for line in capsys.readouterr().out.splitlines())
    assert area > 0
    assert abs(curvature) < 0.1
