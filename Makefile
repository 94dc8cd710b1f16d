# Every command of the project stands here once; pre-commit and CI call these targets.
# `make help` lists them. Needs Python >= 3.11, a C++20 compiler (g++ >= 11 or clang++ >= 14) and make.

PYTHON  ?= python3
VENV    ?= .venv
WORKERS ?= auto
BUILD   ?= build
FUZZ_SECONDS ?= 600
ifeq ($(origin CXX),default)
  CXX := $(firstword $(foreach name,c++ g++ clang++,$(shell command -v $(name))))
endif
export CXX
# For which instruction sets kernels are compiled: native (the best one that this machine has), all, or a list.
export MICROFACET_INSTRUCTION_SETS ?= native

MAKEFLAGS += --no-print-directory
SHELL     := /bin/bash
.SHELLFLAGS := -eu -o pipefail -c
.DELETE_ON_ERROR:
.DEFAULT_GOAL := help

BIN := $(VENV)/bin
PIP := $(BIN)/python -m pip --disable-pip-version-check --quiet
export PATH := $(CURDIR)/$(BIN):$(PATH)

CORE     := $(shell find include bindings -type f 2>/dev/null) CMakeLists.txt pyproject.toml
PACKAGE  := $(CORE) $(wildcard README.md) $(shell find src -type f -not -name "*.so" -not -name "*.pyc")
INSTALLED := $(VENV)/.package-$(MICROFACET_INSTRUCTION_SETS)
CXX_CODE := $(shell grep -rL --include='*.[ch]pp' 'do not edit by hand' include bindings src tests/cpp examples)  # generated files aside
CXX_BUILD := $(BUILD)/$(notdir $(CXX))
CXX_TESTS := cmake -S . -G Ninja -DMICROFACET_BUILD_TESTS=ON

##@ Use

report: $(INSTALLED)  ## the report of all families and of a measured terrain; its last line is the path
	$(BIN)/microfacet report --terrain --output report.html

install: $(INSTALLED)  ## the package, its command and its report in a virtual environment, .venv

wheel: $(VENV)/.build  ## a wheel for other machines too, with kernels for all instruction sets, in dist/
	$(call build,all,wheel --no-build-isolation --no-deps --wheel-dir dist --config-settings=install.strip=true .)

##@ Develop

test: $(INSTALLED) $(VENV)/.test test-cpp  ## C++ tests (CTest), then Python tests (pytest)
	$(BIN)/python -m pytest -n $(WORKERS) tests

test-cpp: $(VENV)/.build  ## the C++ tests alone (CXX chooses the compiler, here and below)
	$(CXX_TESTS) -B "$(CXX_BUILD)"
	cmake --build "$(CXX_BUILD)"
	ctest --test-dir "$(CXX_BUILD)" --output-on-failure

export-tools: $(VENV)/.export  ## what compiles and runs exported text, as far as Python's registry has it (0.5 GB)

headers: $(VENV)/.build  ## each header compiles alone, with warnings as errors
	$(CXX_TESTS) -B "$(CXX_BUILD)"
	cmake --build "$(CXX_BUILD)" --target headers_alone

sanitize: $(VENV)/.build  ## the C++ tests under the address and undefined-behaviour sanitizers
	$(CXX_TESTS) -B "$(CXX_BUILD)-sanitize" -DMICROFACET_SANITIZE=ON
	cmake --build "$(CXX_BUILD)-sanitize"
	ctest --test-dir "$(CXX_BUILD)-sanitize" --output-on-failure

fuzz: $(VENV)/.build  ## each fuzzing harness for FUZZ_SECONDS (600); CXX=clang++ brings libFuzzer
	$(CXX_TESTS) -B "$(CXX_BUILD)-sanitize" -DMICROFACET_SANITIZE=ON
	cmake --build "$(CXX_BUILD)-sanitize" --target fuzz
	for harness in "$(CXX_BUILD)"-sanitize/tests/cpp/fuzz_{bsdf,families,smith,tables}; do \
	  mkdir -p "$$harness.corpus"; \
	  "$$harness" -runs=-1 -max_total_time=$(FUZZ_SECONDS) -max_len=512 -timeout=60 "$$harness.corpus"; done

lint: $(INSTALLED) $(VENV)/.lint  ## ruff, mypy --strict, clang-format: report only
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy --strict src/microfacet
	$(BIN)/clang-format --dry-run -Werror $(CXX_CODE)

format: $(VENV)/.lint  ## ruff and clang-format: mend what they can
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .
	$(BIN)/clang-format -i $(CXX_CODE)

##@ Measure

bench: $(INSTALLED) $(VENV)/.bench  ## speed beside copy, exp, SciPy, Mitsuba; writes docs/performance.md (ARGS=--help)
	$(BIN)/python -m benchmarks run $(ARGS)

bench-check: $(INSTALLED)  ## no kernel has become half as fast as benchmarks/thresholds.toml says it was
	$(BIN)/python -m benchmarks check $(ARGS)

docs-accuracy: $(INSTALLED) $(VENV)/.test  ## measure the accuracy again and write docs/accuracy.md
	$(BIN)/python tools/measure_accuracy.py

docs-formulas:  ## write the formulas of the report into docs/family
	$(PYTHON) tools/write_formulas.py

docs-sampling: $(INSTALLED) $(VENV)/.test  ## test every sampler of the full grid and write docs/sampling_tests.md (half an hour)
	$(BIN)/python tools/measure_sampling.py $(ARGS)

docs-furnace: $(INSTALLED) $(VENV)/.test  ## measure every white furnace and write docs/furnace.md (an hour)
	$(BIN)/python tools/measure_furnace.py $(ARGS)

fit-coverage: $(INSTALLED) $(VENV)/.test  ## fit known slopes 200 times each and write docs/fitting_tests.md (some minutes)
	$(BIN)/python tools/measure_fits.py $(ARGS)

map-coverage: $(INSTALLED) $(VENV)/.test  ## fit synthetic maps 60 times each and write docs/fitting_coverage.md (some minutes)
	$(BIN)/python tools/measure_coverage.py $(ARGS)

bench-materials: $(INSTALLED) $(VENV)/.bench  ## materials beside Mitsuba's, and walks per second
	$(BIN)/python -m benchmarks materials $(ARGS)

bench-mitsuba: $(INSTALLED) $(VENV)/.bench  ## pictures by the Mitsuba plugins beside Mitsuba's own (some minutes)
	$(BIN)/python -m benchmarks mitsuba $(ARGS)

docs-mitsuba: $(INSTALLED) $(VENV)/.test  ## test the samplers of the Mitsuba plugins and write docs/mitsuba_tests.md (half an hour)
	$(BIN)/python tools/measure_mitsuba.py $(ARGS)

docs-export: $(INSTALLED) $(VENV)/.test  ## run exported functions everywhere and write the tables of docs/export.md (minutes)
	$(BIN)/python tools/measure_export.py $(ARGS)

docs-traced: $(INSTALLED) $(VENV)/.bench  ## trace explicit surfaces, compare with the walk, write docs/traced_surface.md
	$(BIN)/python tools/trace_surface.py $(ARGS)

bench-fit: $(INSTALLED) $(VENV)/.bench  ## the fit beside the same likelihoods in SciPy (some minutes)
	$(BIN)/python -m benchmarks.fitting $(ARGS)

##@ Other

clean:  ## remove all that make made
	rm -rf "$(VENV)" "$(BUILD)" report.html .mypy_cache .ruff_cache .pytest_cache .hypothesis
	find . -name __pycache__ -type d -prune -exec rm -rf {} +

help:  ## this list
	@awk 'BEGIN {FS = ":.*## "} /^##@/ {printf "\n%s\n", substr($$0, 5)} \
	  /^[a-z-]+:.*## / {printf "  make %-14s %s\n", $$1, $$2}' $(firstword $(MAKEFILE_LIST))

# A list of requirements in pyproject.toml, by its keys, as a file for pip.
requirements = <($(BIN)/python -c 'import functools, sys, tomllib; print(*functools.reduce(dict.get, \
sys.argv[1:], tomllib.load(open("pyproject.toml", "rb"))), sep="\n")' $(1))

# pip's own words are many and kept in a file; shown are what is built, how far the compiler is, and a failure's end.
define build
	@echo "Building microfacet with $$CXX; all messages are in $(VENV)/build.log"; \
	MICROFACET_INSTRUCTION_SETS=$(1) $(BIN)/python -m pip --disable-pip-version-check --verbose $(2) 2>&1 | \
	tee "$(VENV)/build.log" | grep --line-buffered -oE 'microfacet: building .*|\[[0-9]+/[0-9]+\] (Build|Link)ing .*' || \
	{ tail -n 40 "$(VENV)/build.log" >&2; exit 1; }; echo "Built in $$SECONDS s"
endef

# The virtual environment. Each stamp file is newer than what it was made from, so a second call does nothing.

$(VENV)/.venv:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "microfacet needs Python 3.11 or newer; \
	$(PYTHON) is " + sys.version.split()[0] + ". Choose another: make PYTHON=python3.11")'
	@$(PYTHON) -m venv "$(VENV)" || { rm -rf "$(VENV)"; echo "$(PYTHON) cannot make a virtual environment: its module \
	ensurepip is missing. Install it (Debian: apt install python3-venv), or choose another: make PYTHON=..." >&2; exit 1; }
	$(PIP) install --upgrade 'pip>=25.1'
	@touch $@

$(VENV)/.build: pyproject.toml | $(VENV)/.venv
	$(PIP) install cmake ninja -r $(call requirements,build-system requires)
	@touch $@

$(INSTALLED): $(PACKAGE) | $(VENV)/.build
	@command -v "$${CXX:-none}" >/dev/null || { echo "microfacet needs a C++20 compiler: \
	install g++ (11 or newer) or clang++ (14 or newer)" >&2; exit 1; }
	$(call build,$(MICROFACET_INSTRUCTION_SETS),install --no-build-isolation ".[report]")
	@touch $@

$(VENV)/.test: pyproject.toml | $(VENV)/.venv
	$(PIP) install --group test -r $(call requirements,project optional-dependencies surface)
	@touch $@

$(VENV)/.export: pyproject.toml | $(VENV)/.venv
	$(PIP) install --group export
	$(PIP) install --no-deps slangtorch
	@touch $@

$(VENV)/.bench: pyproject.toml | $(VENV)/.venv
	$(PIP) install --group bench
	@touch $@

$(VENV)/.lint: pyproject.toml | $(VENV)/.venv
	$(PIP) install --group lint
	@touch $@

.PHONY: report install wheel test test-cpp export-tools sanitize fuzz headers lint format bench bench-check docs-accuracy docs-formulas docs-sampling \
  docs-furnace docs-export docs-traced bench-materials fit-coverage map-coverage bench-fit clean help
