# The first command on a fresh clone may be any of these; the first one installs into .venv.

MISSION ?= missions/figure_eight_spheres.toml
# The commit that golden and benchmark-check compare with, and the flights of golden (default: all).
BASE ?= HEAD~1
# The OpenBLAS kernels of test-numerics, and the tests that it runs.
KERNELS ?= Sandybridge Nehalem
NUMERICS = $(shell grep -rl pytest.mark.numerics tests --include=test_*.py)
VENV := .venv
INSTALLED := $(VENV)/installed
COMPILED := $(VENV)/compiled
PACKAGES := gcs idc_controller vehicle_sim

# One BLAS thread: small matrices are no faster with more, and sums repeat.
export OPENBLAS_NUM_THREADS := 1
# Compiled modules are kept: the tests start many programs.
unexport PYTHONDONTWRITEBYTECODE

.PHONY: help install fly test test-fast test-long test-lowest test-numerics release golden golden-renew page
.PHONY: claims claims-all claims-write fault-tables anew benchmark benchmark-campaign benchmark-check benchmark-view
.PHONY: benchmark-flood process-faults link-margin docs pictures clean

help:
	@echo "make fly          fly $(MISSION) with a simulated swarm (MISSION=... for another one)"
	@echo "make test         ruff, mypy and the tests, without further seeds"
	@echo "make test-fast    ruff, mypy and the tests that need no flight"
	@echo "make test-long    the same cases with further seeds and sizes, and longer missions"
	@echo "make test-lowest  some tests and a flight with the lowest versions that pyproject.toml allows"
	@echo "make release      build sdist and wheel into dist/; install the wheel elsewhere, fly there, run another project's tests;"
	@echo "                  test-lowest"
	@echo "make test-numerics  tests of linear algebra and a flight with other OpenBLAS kernels (KERNELS='$(KERNELS)')"
	@echo "make golden       compare short flights, to the byte, with those of the commit BASE ($(BASE)) and with checksums"
	@echo "make golden-renew write the checksums anew"
	@echo "make claims       compare the figures of README.md and docs/ with docs/claims.toml; make test does so, too"
	@echo "make claims-all   run the commands behind them that take minutes, where not run at this commit (ONLY='NAME ...')"
	@echo "make claims-write put the values into the documents"
	@echo "make fault-tables fly and write the tables of detection and of false alarms (about 22 min of CPU)"
	@echo "make benchmark    the speed of flights relative to gym-pybullet-drones; adds to the history"
	@echo "make benchmark-check  compare the CPU cost of flights with that of the commit BASE ($(BASE))"
	@echo "make benchmark-campaign  throughput of parallel flights against a single one's"
	@echo "make benchmark-view   CPU cost of a flight with its live view against that without"
	@echo "make benchmark-flood  a vehicle's telemetry while another vehicle's port is flooded"
	@echo "make link-margin  fly over latency and loss, and write the tables and the picture of docs/link-margin.md (about 5 min of CPU)"
	@echo "make process-faults   flights in real time of which a process is killed or suspended"
	@echo "make docs         write docs/settings.md, failsafes.md, autopilots.md, services.md and NOTICE from what they are about"
	@echo "make pictures     fly, film and photograph the pictures of README.md (needs Chromium; about 6 min of CPU)"
	@echo "make page         bundle the scripts of the report page anew (needs node and npm)"
	@echo "make install      only install, into $(VENV)"
	@echo "make clean        remove $(VENV) and the caches"

fly: $(COMPILED)
	$(VENV)/bin/gcs fly $(MISSION)

test: $(COMPILED)
	$(VENV)/bin/ruff check
	$(VENV)/bin/ruff format --check
	$(VENV)/bin/mypy
	$(VENV)/bin/python -m pytest --numprocesses auto --dist loadfile -m "not long" --durations 25

test-fast: $(COMPILED)
	$(VENV)/bin/ruff check
	$(VENV)/bin/ruff format --check
	$(VENV)/bin/mypy
	$(VENV)/bin/python -m pytest --numprocesses auto --dist loadfile -m "not slow and not long" --durations 15

test-long: $(COMPILED)
	$(VENV)/bin/python -m pytest --numprocesses auto --dist load -m long --durations 25

# The package as a wheel with the lowest versions that pyproject.toml allows.
test-lowest: $(INSTALLED)
	tests/packaging/wheel $(VENV)/bin/python lowest

# Of the last commit, whose version has a dated entry in the changelog.
release: $(INSTALLED)
	$(VENV)/bin/python -m pytest -n 0 tests/project/test_packaging.py
	tests/packaging/wheel $(VENV)/bin/python
	tests/packaging/wheel $(VENV)/bin/python lowest

# Any that the processor has; those that sum as the pinned ones do, such as Zen, prove nothing.
test-numerics: $(COMPILED)
	@for kernels in $(KERNELS); do \
		echo "OpenBLAS kernels $$kernels, numpy without AVX2"; \
		COOPLIFT_KERNELS=unpinned OPENBLAS_CORETYPE=$$kernels NPY_DISABLE_CPU_FEATURES="X86_V3 AVX2 FMA3" \
			$(VENV)/bin/python -m pytest --numprocesses auto --dist loadfile -m numerics $(NUMERICS) || exit 1; \
	done

golden: $(COMPILED)
	$(VENV)/bin/python tests/golden/golden.py --base $(BASE) $(FLIGHTS)

golden-renew: $(COMPILED)
	$(VENV)/bin/python tests/golden/golden.py --renew

claims: $(COMPILED)
	$(VENV)/bin/python tests/claims/claims.py

# What was interrupted goes on when started again.
claims-all: $(COMPILED)
	$(VENV)/bin/python tests/claims/claims.py --all $(ONLY)

claims-write: $(COMPILED)
	$(VENV)/bin/python tests/claims/claims.py --write

fault-tables: $(COMPILED)
	$(VENV)/bin/python tests/pages/fault_tables_page.py docs/faults.md missions/detection.toml missions/false_alarms.toml

# OPTIONS: --quick, --long, --rounds N. ANCHOR_PYTHON: a Python with gym-pybullet-drones, else an equal loop is flown.
benchmark: $(COMPILED)
	$(VENV)/bin/python tests/benchmarks/benchmark.py $(OPTIONS)

benchmark-campaign: $(COMPILED)
	$(VENV)/bin/python tests/benchmarks/campaign.py

benchmark-view: $(COMPILED)
	$(VENV)/bin/python tests/benchmarks/view.py

# OPTIONS: --rate N, --seconds S, the names of floods.
benchmark-flood: $(COMPILED)
	$(VENV)/bin/python tests/benchmarks/flood.py $(OPTIONS)

# OPTIONS: --speed X, --seed S, the names of faults.
process-faults: $(COMPILED)
	$(VENV)/bin/python tests/benchmarks/process_faults.py $(OPTIONS)

benchmark-check: $(COMPILED)
	$(VENV)/bin/python tests/benchmarks/check.py --base $(BASE)

link-margin: $(COMPILED)
	$(VENV)/bin/python tests/pages/link_margin_page.py docs/link-margin.md

docs: $(INSTALLED)
	$(VENV)/bin/python tests/pages/settings_page.py > docs/settings.md
	$(VENV)/bin/python tests/pages/failsafes_page.py > docs/failsafes.md
	$(VENV)/bin/python tests/pages/autopilots_page.py > docs/autopilots.md
	$(VENV)/bin/python tests/pages/kinds_page.py docs/faults.md
	$(VENV)/bin/python tests/pages/links_page.py docs/links.md
	$(VENV)/bin/python -m vehicle_sim.mavlink.services_page > docs/services.md
	$(VENV)/bin/python tests/packaging/notice.py > NOTICE

PICTURES := build/pictures
FILM := $(VENV)/bin/gcs film --speed 4 --size 476x268 --fps 6
pictures: $(COMPILED)
	rm -rf $(PICTURES)
	$(VENV)/bin/gcs fly missions/figure_eight_spheres.toml --seed 5001 --run-dir $(PICTURES)/spheres
	$(FILM) $(PICTURES)/spheres --from 11 --to 71 --out docs/two_spheres.webp
	$(VENV)/bin/gcs fly missions/pole_course.toml --run-dir $(PICTURES)/poles
	$(FILM) $(PICTURES)/poles --from 10 --to 72 --out docs/pole_course.webp
	$(VENV)/bin/python tests/packaging/screenshots.py $(PICTURES)/spheres $(PICTURES) docs

# Needs node and npm, which neither the installation nor a flight does.
page:
	tests/packaging/page/bundle

install: $(COMPILED)

# A PYTHON that is named is the one, or none is: another .venv than its own is made anew.
PYTHONS := $(or $(PYTHON),python3.11 python3 python3.12 python3.13 python)
USABLE := import sys, venv, ensurepip; sys.version_info >= (3, 11) or sys.exit(1); print(sys.base_prefix, sys.version)
HAS_WHEELS := import sys; sys.exit(sys.version_info >= (3, 12))
ifdef PYTHON
NAMED := $(shell $(PYTHON) -c '$(USABLE)' 2>/dev/null)
ifeq ($(NAMED),)
$(error PYTHON=$(PYTHON) is no Python 3.11 or newer with venv)
endif
ifneq ($(NAMED),$(shell $(VENV)/bin/python -c '$(USABLE)' 2>/dev/null))
ANEW := anew
endif
endif

# Without build isolation nothing is fetched that constraints.txt and mavproxy.txt do not name.
$(INSTALLED): pyproject.toml constraints.txt tests/packaging/mavproxy.txt $(ANEW)
	@for python in $(PYTHONS); do \
		if $$python -c '$(USABLE)' >/dev/null 2>&1; then \
			echo "Installing into $(VENV) with $$($$python --version) (once, two to three minutes)"; \
			exec $$python -m venv --clear $(VENV); \
		fi; \
	done; \
	echo "cooplift needs Python 3.11 or newer; found: $$(python3 --version 2>&1 || echo none)." >&2; \
	echo "Install python3.11, or name one: make PYTHON=/path/to/python3.11" >&2; \
	exit 1
	@$(VENV)/bin/python -c '$(HAS_WHEELS)' || { command -v $${CXX:-c++} >/dev/null || { \
		echo "pybullet has no wheel for this Python, and there is no C++ compiler: install g++, or make PYTHON=python3.11" >&2; \
		exit 1; }; \
		echo "pybullet has no wheel for this Python: compiling it, some twelve minutes of CPU; pip keeps the wheel"; }
	@$(VENV)/bin/python -m pip install --quiet --disable-pip-version-check --require-hashes -r constraints.txt
	@$(VENV)/bin/python -m pip install --quiet --disable-pip-version-check --require-hashes --no-deps \
		-r tests/packaging/mavproxy.txt
	@$(VENV)/bin/python -m pip install --quiet --disable-pip-version-check --no-build-isolation --no-deps -e .
	@touch $@

# Compiles the kernels that any change of the sources has changed.
$(COMPILED): $(INSTALLED) $(shell find $(PACKAGES) -name '*.py')
	@$(VENV)/bin/python -m vehicle_sim.app.compile_kernels
	@touch $@

anew:

clean:
	rm -rf $(VENV) build dist *.egg-info .mypy_cache .pytest_cache .ruff_cache .hypothesis
	find $(PACKAGES) tests -name __pycache__ -prune -exec rm -rf {} +
