# Everything runs in a virtual environment of its own; needed: Python 3.11 or later with venv and pip, and make.

PYTHON ?= python3
VENV ?= .venv
BIN = $(VENV)/bin
PIP = $(BIN)/python -m pip install --quiet --disable-pip-version-check --constraint constraints.txt

.PHONY: demo warm-up test quick lowest fresh lint docs mutants constraints clean

demo: $(VENV)/warm  ## one smooth surface from a mesh of genus 2
	$(BIN)/orbiframe fit datasets/plate_genus2.off -o plate_genus2_smooth.ply

warm-up: $(VENV)/warm  ## everything compiled, so that nothing waits for it later

test: $(VENV)/developer  ## all tests, with Open3D, on all cores
	$(BIN)/python -m pytest -m "not fresh" --numprocesses auto --dist worksteal

quick: $(VENV)/developer  ## the tests that take no time, on all cores
	$(BIN)/python -m pytest --numprocesses auto --dist worksteal

lowest: $(VENV)/developer  ## the quick tests with the lowest versions that pyproject.toml allows
	$(BIN)/python .ci/lowest.py testing pictures studies cluster > $(VENV)/lowest.txt
	$(PYTHON) -m venv $(VENV)-lowest
	$(VENV)-lowest/bin/pip install --quiet --constraint $(VENV)/lowest.txt --editable ".[testing,pictures,studies,cluster]" mpmath jsonschema import-linter hatchling "pyparsing<3.3"
	$(VENV)-lowest/bin/python -m pytest --numprocesses auto --dist worksteal

fresh:  ## a fresh environment for each interpreter in PYTHONS: installed from the sdist, and used
	.ci/fresh $(or $(PYTHONS),$(PYTHON))

lint: $(VENV)/developer  ## style, types, and who imports whom
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

docs: $(VENV)/developer  ## the site in build/site, without a warning and without a network
	$(BIN)/python -m sphinx --fail-on-warning --fresh-env --quiet -c docs -d build/doctrees . build/site
	@echo "build/site/index.html"

mutants: $(VENV)/developer  ## faults planted one at a time, and which of them no test notices
	$(BIN)/python benchmarks/mutants.py

constraints: $(VENV)/developer  ## the versions in use become the versions to install
	$(BIN)/python -m pip freeze --exclude-editable > constraints.txt

clean:
	rm -rf $(VENV) $(VENV)-lowest

$(VENV)/python:
	$(PYTHON) -m venv $(VENV)
	touch $@

$(VENV)/user: pyproject.toml constraints.txt | $(VENV)/python
	$(PIP) --editable .
	touch $@

$(VENV)/warm: $(VENV)/user $(shell find orbiframe plugins -name '*.py')
	$(BIN)/orbiframe warm-up
	touch $@

$(VENV)/developer: pyproject.toml constraints.txt | $(VENV)/python
	$(PIP) --editable ".[dev,open3d]"
	touch $@ $(VENV)/user
