# Every command that a person or CI runs. Targets set up what they need: `make test` works in a fresh clone.

PYTHON ?= python3
ARGS ?=
BIN := .venv/bin
export VIRTUAL_ENV := $(CURDIR)/.venv
export PIP_DISABLE_PIP_VERSION_CHECK := 1
export PIP_QUIET := 1
PIP := $(BIN)/python -m pip install

# The core and the bindings; a change to any of them builds the extension module anew. Python files need no build.
RUST := $(shell find crates -name '*.rs' -path '*/src/*') $(shell find crates -name Cargo.toml) \
	Cargo.toml $(wildcard Cargo.lock)

.DEFAULT_GOAL := help
.DELETE_ON_ERROR:
.PHONY: help setup demo test test-rust test-python check fmt lint-rust lint-python docs site bench speed speed-space accuracy campaign-plane parts campaign-space campaign-no-normals bench-peers campaign-plan promises promises-space planning-figures campaign-loop campaign-loop-space experiment-planners view-speed tune-figures rig-figures table-no-normals experiments wheel clean

help: ## list the targets
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "  make %-15s %s\n", $$1, $$2 }' $(MAKEFILE_LIST)

setup: .venv/.built ## make .venv, build palpate and install it there

demo: .venv/.built ## hide a bundled part, find it by touch; leaves pictures and a page in palpate-demo/
	$(BIN)/palpate demo $(ARGS)

test: test-rust test-python ## all tests

test-rust: | .venv/.cargo
	cargo test --release --quiet

test-python: .venv/.built .venv/.test .venv/.chromium
	$(BIN)/python -m pytest --quiet $(ARGS)

check: lint-rust lint-python site ## formatting, lints, types, stubs and documentation

lint-rust: export PYO3_PYTHON := $(CURDIR)/$(BIN)/python
lint-rust: export RUSTDOCFLAGS := -D warnings
lint-rust: | .venv/.tools .venv/.cargo
	cargo fmt --all --check
	cargo clippy --quiet --workspace --all-targets -- -D warnings
	cargo doc --quiet --package palpate --no-deps

lint-python: .venv/.built .venv/.test .venv/.dev
	$(BIN)/ruff check --quiet
	$(BIN)/ruff format --quiet --check
	$(BIN)/mypy
	MYPYPATH=python $(BIN)/python -m mypy.stubtest palpate._core

fmt: .venv/.dev ## format all sources
	cargo fmt --all
	$(BIN)/ruff check --quiet --fix-only --select I
	$(BIN)/ruff format --quiet

bench: | .venv/.cargo ## time the core on one core of this machine
	cargo bench --quiet --bench recognition -- $(ARGS)

# What the examples of the core print is kept in target/figures; the pages are written from it.
FIGURE = mkdir -p target/figures && cargo run --quiet --release --example $(1) > target/figures/$(1).json && \
	$(BIN)/python -m palpate.experiments.$(1) target/figures/$(1).json $(2)

speed: .venv/.built ## measure times and memory; writes docs/speed.md and its pictures anew (some minutes)
	$(call FIGURE,speed,docs/speed.md)
	$(call FIGURE,explosion,docs/speed.md)

speed-space: parts ## the same for solids: one part, libraries, growth; in docs/speed.md
	$(BIN)/python -m palpate.experiments.solid_speed --parts $(PARTS) --page docs/speed.md

accuracy: .venv/.built ## measure bounds against dense sampling; writes docs/accuracy.md anew
	$(call FIGURE,tightness,docs/accuracy.md)
	$(call FIGURE,tightness_space,docs/accuracy.md)
	$(call FIGURE,thesis_bounds,docs/accuracy.md)
	$(call FIGURE,thesis_bounds_space,docs/accuracy.md)

campaign-plane: .venv/.built .venv/.cluster ## 100,000 random planar problems: is anything true lost? resumes where it was stopped
	$(BIN)/python -m palpate.experiments.campaign_plane $(ARGS)

PARTS := target/parts

parts: .venv/.built .venv/.parts ## parts out of public packages, 120 of each, in target/parts; a source that is missing is skipped
	-$(BIN)/python -m palpate.experiments.public_parts --folder $(PARTS)

CAMPAIGN_SPACE := -m palpate.experiments.campaign_space --parts $(PARTS) --page docs/campaign-space.md

campaign-space: parts .venv/.cluster ## 10,000 random problems of space, on real parts too: is anything true lost? writes docs/campaign-space.md; resumes
	$(BIN)/python $(CAMPAIGN_SPACE) $(ARGS)

campaign-no-normals: parts .venv/.cluster ## 1,000 of these without normals, in docs/campaign-space.md too; resumes
	$(BIN)/python $(CAMPAIGN_SPACE) --family no-normals --problems 1000 $(ARGS)

# One thread, so that times are comparable.
bench-peers: export OMP_NUM_THREADS := 1
bench-peers: export OPENBLAS_NUM_THREADS := 1
bench-peers: parts .venv-peers/.installed ## other ways to find a part by the same contacts; writes docs/tables/peers.md; resumes
	PYTHONPATH=python .venv-peers/bin/python -m palpate.experiments.peers --parts $(PARTS) --page docs/tables/peers.md $(ARGS)

campaign-plan: | .venv/.cargo ## 1,000 planning problems, 200,000 random lines each: is any better than complete? resumes
	cargo run --quiet --release --example campaign_plan -- $(or $(ARGS),1000 200000)

promises: | .venv/.cargo ## 1,000,000 simulated readings: is any promise of a path broken?
	mkdir -p target/figures
	cargo run --quiet --release --example promises -- $(ARGS) > target/figures/promises.json

promises-space: | .venv/.cargo ## 200,000 of solids, at balls and points (some minutes)
	mkdir -p target/figures
	cargo run --quiet --release --example promises -- $(or $(ARGS),200000) space > target/figures/promises_space.json

planning-figures: .venv/.built promises promises-space ## measure planning; writes docs/planning-figures.md anew (some minutes)
	cargo run --quiet --release --example touches > target/figures/touches.json
	cargo run --quiet --release --example plan_speed > target/figures/plan_speed.json
	$(BIN)/python -m palpate.experiments.planning target/figures docs/planning-figures.md

campaign-loop: .venv/.built .venv/.cluster ## 10,000 closed loops: is a truth lost? writes docs/closed-loop.md; ARGS="--cluster local:2"; resumes
	$(BIN)/python -m palpate.experiments.campaign_loop --page docs/closed-loop.md $(ARGS)

experiment-planners: parts .venv/.cluster ## all planners of space on 210 problems, beside random lines; writes docs/planners-space.md; resumes
	$(BIN)/python -m palpate.experiments.space_planners --parts $(PARTS) --page docs/planners-space.md $(ARGS)

campaign-loop-space: .venv/.built .venv/.cluster ## 1,000 closed loops over solids, in docs/closed-loop.md; on real parts too if `make parts` was run; resumes
	$(BIN)/python -m palpate.experiments.campaign_loop_space --parts $(PARTS) --page docs/closed-loop.md $(ARGS)

view-speed: .venv/.built .venv/.test .venv/.chromium ## from click to picture in the viewer; in docs/viewer.md
	$(BIN)/python -m palpate.experiments.view_speed --page docs/viewer.md

tune-figures: .venv/.built ## parameters for the bundled sets of models, in docs/closed-loop.md (some minutes)
	$(BIN)/python -m palpate.experiments.tune_page docs/closed-loop.md $(ARGS)

table-no-normals: .venv/.built ## contacts without normals: hypotheses and times, in docs/tables/no-normals.md
	$(BIN)/python -m palpate.experiments.no_normals $(ARGS)

rig-figures: .venv/.built .venv/.sim ## the simulated rig: its sensor, its control, 219 closed loops; writes docs/rig.md; resumes
	for name in sensor control drill solids; do $(BIN)/palpate experiment rig-$$name --out target/rig $(ARGS) || exit 1; done
	$(BIN)/python -m palpate.experiments.rig_page target/rig docs/rig.md

experiments: .venv/.built ## the thesis's tables and figures; an HTML page, and docs/experiments.md anew (minutes)
	rm -rf target/experiments
	$(BIN)/palpate experiment all --out target/experiments $(ARGS)
	$(BIN)/python -m palpate.experiments.thesis target/experiments docs/experiments.md

docs: site ## the reference of the core in target/doc; the book in site/
	RUSTDOCFLAGS="-D warnings" cargo doc --quiet --package palpate --no-deps

site: .venv/.built .venv/.docs ## the book in site/; a broken link or name is an error
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --quiet --strict

wheel: .venv/.tools .venv/.cargo ## a wheel in target/wheels
	$(BIN)/maturin build --release --quiet

clean: ## remove what was built, .venv and .venv-peers included
	rm -rf .venv .venv-peers target site
	rm -f python/palpate/_core.*.so python/palpate/_core.so

# Stamps: each is touched when its step is done, and is older than what would make the step necessary again.

.venv/.tools:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 10))' || \
		{ echo "palpate needs Python 3.10 or newer: install it, or say which with make PYTHON=python3.12" >&2; exit 1; }
	@echo "making .venv"
	@$(PYTHON) -m venv .venv || \
		{ echo "python3 can't make virtual environments: install its venv package (Debian: python3-venv)" >&2; exit 1; }
	@$(PIP) 'maturin>=1.9,<2'
	@touch $@

.venv/.cargo: | .venv/.tools
	@command -v cargo >/dev/null || \
		{ echo "palpate needs Rust 1.88 or newer and cargo is missing: install it with rustup, then run make again" >&2; exit 1; }
	@touch $@

.venv/.built: pyproject.toml $(RUST) | .venv/.tools .venv/.cargo
	@echo "building palpate (a few minutes the first time)"
	@$(BIN)/maturin develop --release --quiet
	@touch $@

# palpate itself is installed by now, so that these add only what its extras name.
.venv/.test .venv/.dev .venv/.docs .venv/.cluster .venv/.parts .venv/.sim: .venv/.%: pyproject.toml | .venv/.built
	@echo "installing what $* needs"
	@$(PIP) 'palpate[$*]'
	@touch $@

# Without a browser the tests of the viewer in one are skipped, and say so.
.venv/.chromium: | .venv/.tools
	@command -v chromium >/dev/null || { command -v apt-get >/dev/null && echo "installing chromium" && \
		apt-get update -qq && DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends chromium >/dev/null; } || \
		echo "chromium can't be installed here: tests of the viewer in a browser are skipped (Debian: apt-get install chromium)" >&2
	@touch $@

# Apart from .venv: Open3D brings a plugin of pytest that current ones can't load. palpate is taken from this folder.
.venv-peers/.installed: pyproject.toml | .venv/.built
	@echo "making .venv-peers with Open3D, OpenCV and small_gicp (2 GB)"
	@$(PYTHON) -m venv .venv-peers
	@$(BIN)/python -c 'from importlib.metadata import requires; \
		print(*(one.partition(";")[0] for one in requires("palpate") if "extra" not in one or "peers" in one), sep="\n")' \
		> .venv-peers/requirements.txt
	@.venv-peers/bin/python -m pip install --requirement .venv-peers/requirements.txt
	@.venv-peers/bin/python -c 'import open3d' || \
		{ echo "Open3D can't be loaded; if libusb is what it lacks: install libusb-1.0 (Debian: libusb-1.0-0), then run make again" >&2; exit 1; }
	@touch $@
