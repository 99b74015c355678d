# Building, trying and checking clast. `make` alone lists the targets.
#
#   PYTHON       the interpreter the environment is made from (3.11 or newer)
#   WORKERS      processes for the tests
#   PORT         port on which docs-serve shows the documentation site
#   SINCE        branch or commit since which test-changed looks for changes
#   BENCH_ARGS   arguments of benchmarks.bench, for example BENCH_ARGS="slope --size 100"
#   EXTRAS       extras of clast that tests are run with; CI adds those that one test needs
#   PYTEST_ARGS  further arguments for pytest, for example PYTEST_ARGS="-k incline"

PYTHON ?= python3
WORKERS ?= 2
EXTRAS ?= dev
PYTEST_ARGS ?=
BENCH_ARGS ?= wall heap --size 1000
SINCE ?= main
PORT ?= 8000

VENV := .venv
BIN := $(VENV)/bin
PIP := $(BIN)/python -m pip --disable-pip-version-check

.DEFAULT_GOAL := help
.NOTPARALLEL:
.PHONY: help env env-test env-docs digits bench sizes english demo paper verify performance docs docs-serve reference warm test test-system test-long test-changed test-ci test-release compile-cost mutations format lint types layers check build clean distclean

help:
	@echo "make env        make .venv, install clast in it and compile its kernels"
	@echo "make warm       compile the kernels, by all cores, as far as they are not on disk"
	@echo "make demo       run, verify and draw the block on an incline"
	@echo "make paper      repeat the paper's studies, into docs/paper.md (some minutes)"
	@echo "make verify     run all verification problems and write docs/verification.md (minutes)"
	@echo "make performance  time whole scenes, walls and heaps, and write docs/performance.md (hours)"
	@echo "make docs       build the documentation site into build/site"
	@echo "make docs-serve builds it and shows it on http://127.0.0.1:8000"
	@echo "make reference  write the references of case file, with its schema, and result file"
	@echo "make test       run the core tests: each formula, kernel and refusal (minutes)"
	@echo "make test-system, test-long   run whole runs; killed runs, threads, cold caches"
	@echo "make test-changed   run core tests of what changed since main, and of what uses it"
	@echo "make test-ci    run what CI runs; make test-release runs every test there is"
	@echo "make digits     write hashes of short runs; once they are there, compare (minutes)"
	@echo "make bench      time a wall and a heap of 1,000 blocks (BENCH_ARGS for others)"
	@echo "make sizes      hold lines by folder against their budget; make english counts words"
	@echo "make compile-cost   list the kernels anew, and what each costs to compile (minutes)"
	@echo "make mutations  look whether core tests see a wrong sign (an hour)"
	@echo "make format     format the code and sort its imports"
	@echo "make lint       check format and style (ruff)"
	@echo "make types      check types (mypy)"
	@echo "make layers     check that imports point downwards (import-linter)"
	@echo "make check      lint, types, layers and sizes"
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
	@$(PIP) install --quiet --no-compile -c constraints.txt -e '.[$(EXTRAS)]'
	@touch $@ $(VENV)/.stamp-env

$(VENV)/.stamp-env-docs: pyproject.toml constraints.txt | $(BIN)/pip
	@echo "Installing clast with what builds its documentation into $(VENV)"
	@$(PIP) install --quiet --no-compile -c constraints.txt -e '.[plot,docs]'
	@touch $@ $(VENV)/.stamp-env

# Compiled once by as many processes as there are cores; a stamp is as old as the kernels' files.
# Python's own bytecode is kept on this occasion, whatever the environment says of other runs.
KERNELS := $(shell find src/clast -name '*.py' -not -path '*/cli/*' -not -path '*/verification/*')

$(VENV)/.stamp-warm: $(VENV)/.stamp-env $(KERNELS)
	@env -u PYTHONDONTWRITEBYTECODE $(BIN)/clast warmup
	@touch $@

env: $(VENV)/.stamp-env $(VENV)/.stamp-warm

warm: $(VENV)/.stamp-warm

env-test: $(VENV)/.stamp-env-test

env-docs: $(VENV)/.stamp-env-docs

# --- trying --------------------------------------------------------------------------------

demo: $(VENV)/.stamp-env
	@mkdir -p build
	@env -u PYTHONDONTWRITEBYTECODE $(BIN)/clast warmup --first
	@rm -f build/incline.toml
	@$(BIN)/clast new build/incline
	@$(BIN)/clast run build/incline.toml -o build/incline.vtkhdf
	@echo "Wrote build/incline.vtkhdf (opens in ParaView)"
	@$(BIN)/clast plot build/incline.vtkhdf -o build/incline.png
	@echo "Wrote build/incline.png"
	@echo "Compiling what other cases need (this may be interrupted)"
	@$(MAKE) --no-print-directory warm
	@echo "Comparing with the closed-form answer"
	@$(BIN)/clast verify incline --quick

paper: env
	@echo "Running the paper's studies (some minutes)"
	@$(BIN)/python -m benchmarks.paper cases/paper docs/paper.md
	@echo "Wrote docs/paper.md"

verify: env
	@echo "Running all verification problems (some minutes)"
	@$(BIN)/clast verify --report build/verification; code=$$?; \
	    mkdir -p docs/images/verification; \
	    cp build/verification/verification.md docs/verification.md; \
	    cp build/verification/images/verification/*.png docs/images/verification/; exit $$code
	@echo "Wrote docs/verification.md"

# on a machine with nothing else to do; programs that are not installed are left out
performance: env
	@$(PIP) install --quiet -c constraints.txt pymunk pyb2d3 || \
	    echo "Chipmunk and Box2D could not be installed: clast alone"
	@mkdir -p build
	@$(BIN)/python -m benchmarks.bench wall stack heap slope whole \
	    --size 100,1000 --output build/bench.json
	@$(BIN)/python -m benchmarks.peers
	@$(BIN)/python -m benchmarks.peers --page
	@echo "Wrote docs/performance.md"

docs: env-docs
	@$(BIN)/zensical build --clean --strict
	@echo "Wrote build/site; open build/site/index.html, or make docs-serve"

docs-serve: docs
	@echo "Open http://127.0.0.1:$(PORT); Ctrl-C ends it"
	@$(BIN)/python -m http.server $(PORT) --bind 127.0.0.1 --directory build/site

reference: env
	@$(BIN)/python tools/case_reference.py
	@$(BIN)/python tools/result_reference.py
	@$(BIN)/python tools/script_stub.py
	@echo "Wrote docs/reference/case-file.md and docs/reference/result-file.md, src/clast/case/script.pyi"

# --- testing and checking ------------------------------------------------------------------

# Which tests belong to which tier, and which begin: tests/scenes/tiers.py.  A file goes to one
# process, which makes the fixtures of a module once.  Bytecode is kept, since installation leaves
# it to those that import: all of it would take as long as half of the installation.
IN_TURN := -n $(WORKERS) --dist loadfile --no-loadscope-reorder --longest-first
PYTEST := env -u PYTHONDONTWRITEBYTECODE $(BIN)/python -m pytest $(IN_TURN)

test: env-test
	@$(PYTEST) -m core $(PYTEST_ARGS)

test-system: env-test
	@$(PYTEST) -m system $(PYTEST_ARGS)

test-long: env-test
	@$(PYTEST) -m long $(PYTEST_ARGS)

test-changed: env-test
	@$(BIN)/python tools/changed_tests.py $(SINCE) -- $(IN_TURN) $(PYTEST_ARGS)

# what .ci/run does: every tier, of the long one a tenth; one closing line for all.  A machine that
# others share must not fail by time: make test looks at the second of core tests
test-ci: env-test
	@$(PYTEST) --no-core-limit --long-one-in 10 --durations=10 $(PYTEST_ARGS)

test-release: env-test
	@$(PYTEST) --undrawn --durations=20 $(PYTEST_ARGS)

# written once, before a change, then compared; make clean forgets them
digits: env
	@if [ -f build/digits.json ]; then $(BIN)/python tools/digits.py --against; \
	    else $(BIN)/python tools/digits.py --write; fi

bench: env
	@$(BIN)/python -m benchmarks.bench $(BENCH_ARGS)

sizes:
	@$(PYTHON) tools/sizes.py

english:
	@$(PYTHON) tools/english.py --list

compile-cost: $(VENV)/.stamp-env
	@$(BIN)/python -m tools.compile_cost --write
	@$(BIN)/python -m tools.compile_cost

mutations: env-test
	@$(BIN)/python tools/mutations.py

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

check: lint types layers sizes

build: env-test
	@$(PIP) wheel --quiet --no-deps --wheel-dir dist .
	@echo "Wrote the wheel to dist"

# --- cleaning ------------------------------------------------------------------------------

clean:
	@rm -rf build dist .pytest_cache .mypy_cache .ruff_cache .import_linter_cache .hypothesis
	@find . -name $(VENV) -prune -o -name __pycache__ -type d -prune -exec rm -rf {} +

distclean: clean
	@rm -rf $(VENV)
