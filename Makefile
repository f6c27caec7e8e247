# slidepipe: `make help` lists the targets. Python 3.11 or newer, git and make are all that a machine needs.
PYTHON ?= $(shell command -v python3.11 || command -v python3)
VENV   := .venv
BIN    := $(VENV)/bin
STAMP  := $(VENV)/.installed
DEV    := $(VENV)/.installed-dev
BENCH  := $(VENV)/.installed-bench
DOCS   := $(VENV)/.installed-docs

PEERS  := tests/lab/natnet/test_natnet_peers.py tests/artifacts/test_recording_peers.py

.DEFAULT_GOAL := help
.PHONY: help demo docs figures browser test check check-peers bench real-data recorded clean

help:  ## list the targets
	@awk -F ':.*## ' '/^[a-z-]+:.*## / {printf "  make %-11s %s\n", $$1, $$2}' $(MAKEFILE_LIST)

$(BIN)/python:
	$(PYTHON) -m venv $(VENV)

$(STAMP): pyproject.toml | $(BIN)/python
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable .
	@touch $@

$(DEV): pyproject.toml | $(BIN)/python
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[dev]'
	@touch $@ $(STAMP)

$(BENCH): pyproject.toml | $(BIN)/python
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[bench]'
	@touch $@ $(STAMP)

$(DOCS): pyproject.toml | $(BIN)/python
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[docs]'
	@touch $@ $(STAMP)

demo: $(STAMP)  ## install, then plan, execute, estimate and iterate a regrasp on the simulated lab
	$(BIN)/slidepipe run experiments/regrasp.yaml

docs: $(DOCS)  ## make the documentation with its reference as pages for a browser: build/docs/index.html
	$(BIN)/python docs/build.py

figures: $(STAMP)  ## draw the paper's figures into figures/, and its numbers beside ours into docs/paper.md
	$(BIN)/slidepipe figures --table docs/paper.md

test: $(DEV)  ## install, then run the tests: on two cores, then alone those that keep time with a laboratory
	$(BIN)/python -m pytest -m 'not realtime' -n 2 --dist loadfile
	$(BIN)/python -m pytest -m realtime tests

check: $(DEV)  ## lint, types and layers
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

check-peers: $(DEV)  ## install NatNet clients and MCAP readers that others wrote, and test against them
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[dev,peers]'
	if command -v npm > /dev/null; then \
	  npm install --silent --ignore-scripts --no-fund --no-audit --prefix build/peers @mcap/core@2 @mcap/support@1 \
	    || echo "npm cannot install @mcap/core: its test is skipped"; fi
	$(BIN)/python -m pytest -rs $(PEERS)

browser:  ## install the browser that the report's page is tested in (Debian, as root); its tests skip without one
	command -v chromium chromedriver >/dev/null || \
	  (apt-get update -qq && apt-get install -y -qq --no-install-recommends chromium chromium-driver >/dev/null)

bench: $(BENCH)  ## install the peers, then measure speed and accuracy against them
	@command -v cyclictest >/dev/null || (apt-get update -qq && apt-get install -y -qq --no-install-recommends rt-tests) >/dev/null 2>&1 \
	  || echo "bench: cyclictest is missing and cannot be installed here: apt-get install rt-tests"
	for benchmark in benchmarks/*.py; do echo "== $$benchmark"; $(BIN)/python $$benchmark || exit 1; done

real-data: $(STAMP)  ## judge the estimators on public recordings, and write docs/real-data.md again
	$(BIN)/python benchmarks/real_data.py --page docs/real-data.md

recorded: $(STAMP)  ## record the trials under data/recorded again
	$(BIN)/python data/recorded/make.py

clean:  ## remove the environment and everything that tools wrote (not the runs)
	rm -rf $(VENV) .mypy_cache .ruff_cache .pytest_cache .hypothesis .import_linter_cache build *.egg-info
