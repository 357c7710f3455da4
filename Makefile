# `make demo` and `make test` need Python >= 3.11, make and git; no root, no compiler.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/$(if $(filter Windows_NT,$(OS)),Scripts,bin)
INSTALLED := $(VENV)/.installed
PIP := $(BIN)/python -m pip --disable-pip-version-check --quiet

.PHONY: help demo check test docs lint bench torture clean

help:
	@echo "make demo   the two-blade case: solve it and write demo/report.html"
	@echo "make check  linters, type check and the quick tests: less than a minute after the first time"
	@echo "make test   linters, type check and the tests, with their coverage; STICKSLIP_REQUIRE_TOOLS=1 adds the longest"
	@echo "make docs   the documentation as a web site, build/site/index.html (some minutes; solves the examples)"
	@echo "make lint   linters and type check only"
	@echo "make bench  curves beside a dense Newton and pyHarm (installs the extra [bench]; some minutes)"
	@echo "make torture  random problems that try the solver, one table (hours; resumes from build/torture)"
	@echo "make clean  remove the environment and what was built"

$(INSTALLED): pyproject.toml constraints.txt
	@$(PYTHON) -c 'import sys; sys.exit(0 if sys.version_info >= (3, 11) else "stickslip needs Python 3.11 or newer, but $(PYTHON) is " + sys.version.split()[0] + "; name another one: make PYTHON=python3.12")'
	@echo "Preparing $(VENV) (once)"
	$(PYTHON) -m venv $(VENV)
	$(PIP) install --upgrade pip --constraint constraints.txt
	$(PIP) install --constraint constraints.txt --build-constraint constraints.txt --group dev --editable .
	@touch $@

demo: $(INSTALLED)
	@mkdir -p demo
	$(BIN)/stickslip new demo/study.toml --force
	$(BIN)/stickslip run demo/study.toml --out demo
	@echo "Open demo/report.html in a browser."

# Without its cache: a module that moves changes the order of imports in files that do not change.
lint: $(INSTALLED)
	$(BIN)/ruff check --no-cache .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

# One process of tests for each core, at most four; more threads in each would only wait for each other. Tests of a file
# share what they prepared, so a file stays in one process. The processes that tests start find the package compiled, also
# where the environment forbids to store that.
PYTEST = OMP_NUM_THREADS=1 PYTHONDONTWRITEBYTECODE= $(BIN)/python -m pytest --numprocesses auto --maxprocesses 4 --dist loadfile --no-loadscope-reorder
# Slow tests that wait for a browser or for another process leave their core to one more process of tests.
ONE_MORE = $$($(BIN)/python -c 'import os; print(1 + (os.cpu_count() or 1))')

# The linters take one core, and only for seconds, so they run beside the tests.
LINTERS_BESIDE = $(MAKE) --no-print-directory lint & linters=$$!
BOTH = tests=$$?; wait $$linters && exit $$tests

check: $(INSTALLED)
	@$(LINTERS_BESIDE); $(PYTEST) -m "not slow" --durations=10 --durations-min=1; $(BOTH)

# Continuous integration runs the longest tests too: processes that die, whole studies, benchmarks. They alone run many
# lines, so without them the coverage is printed and not required.
CHOSEN = $(if $(STICKSLIP_REQUIRE_TOOLS),,-m "not long" --cov-fail-under=0)

test: $(INSTALLED)
	@$(LINTERS_BESIDE); $(PYTEST) $(CHOSEN) --numprocesses $(ONE_MORE) --cov --cov-report=term; $(BOTH)

# The site asks no server for anything: neither while it is built nor in the browser.
docs: $(INSTALLED)
	NO_MKDOCS_2_WARNING=1 OMP_NUM_THREADS=1 $(BIN)/python -m mkdocs build --strict
	@echo "Open build/site/index.html in a browser."

bench: $(INSTALLED)
	$(PIP) install --constraint constraints.txt --build-constraint constraints.txt --editable .[bench]
	$(BIN)/python -W ignore benchmarks/bench.py

torture: $(INSTALLED)
	$(BIN)/python benchmarks/torture.py build/torture --peaks

clean:
	rm -rf $(VENV) build demo .coverage* .pytest_cache .mypy_cache .ruff_cache .hypothesis
