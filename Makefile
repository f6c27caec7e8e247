# slidepipe: `make help` lists the targets. Python 3.11 or newer, git and make are all that a machine needs.
PYTHON ?= $(shell command -v python3.11 || command -v python3)
VENV   := .venv
BIN    := $(VENV)/bin
STAMP  := $(VENV)/.installed
DEV    := $(VENV)/.installed-dev

.DEFAULT_GOAL := help
.PHONY: help demo figures browser test check bench recorded clean

help:  ## list the targets
	@awk -F ':.*## ' '/^[a-z-]+:.*## / {printf "  make %-10s %s\n", $$1, $$2}' $(MAKEFILE_LIST)

$(BIN)/python:
	$(PYTHON) -m venv $(VENV)

$(STAMP): pyproject.toml | $(BIN)/python
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable .
	@touch $@

$(DEV): pyproject.toml | $(BIN)/python
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[dev]'
	@touch $@ $(STAMP)

demo: $(STAMP)  ## install, then plan, execute, estimate and iterate a regrasp on the simulated lab
	$(BIN)/slidepipe run experiments/regrasp.yaml

figures: $(STAMP)  ## draw the paper's figures into figures/, and its numbers beside ours into docs/paper.md
	$(BIN)/slidepipe figures --table docs/paper.md

test: $(DEV)  ## install, then run the tests
	$(BIN)/python -m pytest

check: $(DEV)  ## lint, types and layers
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

browser:  ## install the browser that the report's page is tested in (Debian, as root); its tests skip without one
	command -v chromium chromedriver >/dev/null || \
	  (apt-get update -qq && apt-get install -y -qq --no-install-recommends chromium chromium-driver >/dev/null)

bench: $(STAMP)  ## measure speed and accuracy against scipy and MuJoCo
	for benchmark in benchmarks/*.py; do echo "== $$benchmark"; $(BIN)/python $$benchmark || exit 1; done

recorded: $(STAMP)  ## record the trials under data/recorded again
	$(BIN)/python data/recorded/make.py

clean:  ## remove the environment and everything that tools wrote (not the runs)
	rm -rf $(VENV) .mypy_cache .ruff_cache .pytest_cache .hypothesis .import_linter_cache build *.egg-info
