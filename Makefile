# Building, trying and checking clast. `make` alone lists the targets.
#
#   PYTHON       the interpreter the environment is made from (3.11 or newer)
#   WORKERS      processes for the tests
#   PORT         port on which docs-serve shows the documentation site
#   PYTEST_ARGS  further arguments for pytest, for example PYTEST_ARGS="-k incline"

PYTHON ?= python3
WORKERS ?= 2
PYTEST_ARGS ?=
PORT ?= 8000

VENV := .venv
BIN := $(VENV)/bin
PIP := $(BIN)/python -m pip --disable-pip-version-check

.DEFAULT_GOAL := help
.NOTPARALLEL:
.PHONY: help env env-test env-docs demo paper verify docs docs-serve reference test test-fast format lint types layers check build clean distclean

help:
	@echo "make env        make .venv and install clast in it"
	@echo "make demo       run, verify and draw the block on an incline"
	@echo "make paper      repeat the paper's studies and write docs/paper.md (some minutes)"
	@echo "make verify     run all verification problems and write docs/verification.md (minutes)"
	@echo "make docs       build the documentation site into build/site"
	@echo "make docs-serve builds it and shows it on http://127.0.0.1:8000, with its search"
	@echo "make reference  write docs/reference/case-file.md from the models of the case file"
	@echo "make test       run all tests"
	@echo "make test-fast  run the tests that are not marked slow"
	@echo "make format     format the code and sort its imports"
	@echo "make lint       check format and style (ruff)"
	@echo "make types      check types (mypy)"
	@echo "make layers     check that imports point downwards (import-linter)"
	@echo "make check      lint, types and layers"
	@echo "make build      build the wheel into dist"
	@echo "make clean      remove what was built; make distclean removes .venv too"
	@echo ""
	@echo "Another interpreter: make env PYTHON=python3.12"

# --- environment ---------------------------------------------------------------------------

$(BIN)/pip:
	@command -v "$(PYTHON)" >/dev/null 2>&1 || { \
	    echo "clast: there is no $(PYTHON). Install Python 3.11 or newer, or name one:" >&2; \
	    echo "       make env PYTHON=/path/to/python" >&2; exit 1; }
	@"$(PYTHON)" -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { \
	    echo "clast: Python 3.11 or newer is needed; $(PYTHON) is" \
	        "$$("$(PYTHON)" -c 'import sys; print("%d.%d.%d" % sys.version_info[:3])')." >&2; \
	    echo "       Name a newer one: make env PYTHON=python3.12" >&2; exit 1; }
	@"$(PYTHON)" -c 'import ensurepip, venv' 2>/dev/null || { \
	    echo "clast: $(PYTHON) cannot make virtual environments (venv or ensurepip is missing)." >&2; \
	    echo "       On Debian and Ubuntu: apt install python3-venv" >&2; exit 1; }
	@echo "Making $(VENV)"
	@"$(PYTHON)" -m venv $(VENV)

$(VENV)/.stamp-env: pyproject.toml constraints.txt | $(BIN)/pip
	@echo "Installing clast into $(VENV)"
	@$(PIP) install --quiet --no-compile -c constraints.txt -e '.[plot]'
	@touch $@

$(VENV)/.stamp-env-test: pyproject.toml constraints.txt | $(BIN)/pip
	@echo "Installing clast with its tests and checks into $(VENV)"
	@$(PIP) install --quiet -c constraints.txt -e '.[dev]'
	@touch $@ $(VENV)/.stamp-env

$(VENV)/.stamp-env-docs: pyproject.toml constraints.txt | $(BIN)/pip
	@echo "Installing clast with what builds its documentation into $(VENV)"
	@$(PIP) install --quiet -c constraints.txt -e '.[plot,docs]'
	@touch $@ $(VENV)/.stamp-env

env: $(VENV)/.stamp-env

env-test: $(VENV)/.stamp-env-test

env-docs: $(VENV)/.stamp-env-docs

# --- trying --------------------------------------------------------------------------------

demo: env
	@mkdir -p build
	@echo "Running cases/incline.toml (the first run compiles for some seconds)"
	@$(BIN)/clast run cases/incline.toml -o build/incline.vtkhdf
	@echo "Wrote build/incline.vtkhdf (opens in ParaView)"
	@echo "Comparing with the closed-form answer"
	@$(BIN)/clast verify incline --quick
	@$(BIN)/clast plot build/incline.vtkhdf -o build/incline.png
	@echo "Wrote build/incline.png"

paper: env
	@echo "Running the paper's studies (some minutes)"
	@$(BIN)/python -m clast.studies.paper cases/paper docs/paper.md
	@echo "Wrote docs/paper.md"

verify: env
	@echo "Running all verification problems (some minutes)"
	@$(BIN)/clast verify --report build/verification; code=$$?; \
	    mkdir -p docs/images/verification; \
	    cp build/verification/verification.md docs/verification.md; \
	    cp build/verification/images/verification/*.png docs/images/verification/; exit $$code
	@echo "Wrote docs/verification.md"

docs: env-docs
	@$(BIN)/zensical build --clean --strict
	@echo "Wrote build/site; open build/site/index.html, or make docs-serve to search in it"

# browsers keep the search of a page that was opened from the disk from its index
docs-serve: docs
	@echo "Open http://127.0.0.1:$(PORT); Ctrl-C ends it"
	@$(BIN)/python -m http.server $(PORT) --bind 127.0.0.1 --directory build/site

reference: env
	@$(BIN)/python tools/case_reference.py
	@echo "Wrote docs/reference/case-file.md"

# --- testing and checking ------------------------------------------------------------------

test: env-test
	@$(BIN)/python -m pytest -n $(WORKERS) --durations=10 $(PYTEST_ARGS)

test-fast: env-test
	@$(BIN)/python -m pytest -n $(WORKERS) -m "not slow" $(PYTEST_ARGS)

format: env-test
	@$(BIN)/ruff check --fix --select I .
	@$(BIN)/ruff format .

lint: env-test
	@$(BIN)/ruff format --check .
	@$(BIN)/ruff check .

types: env-test
	@$(BIN)/mypy

layers: env-test
	@$(BIN)/lint-imports --no-logo

check: lint types layers

build: env-test
	@$(PIP) wheel --quiet --no-deps --wheel-dir dist .
	@echo "Wrote the wheel to dist"

# --- cleaning ------------------------------------------------------------------------------

clean:
	@rm -rf build dist .pytest_cache .mypy_cache .ruff_cache .import_linter_cache .hypothesis
	@find . -name $(VENV) -prune -o -name __pycache__ -type d -prune -exec rm -rf {} +

distclean: clean
	@rm -rf $(VENV)
