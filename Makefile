# SPDX-License-Identifier: BSD-3-Clause
# The two commands of the README and their parts. Each target does the set-up it needs and can be run again.
SHELL := bash
.SHELLFLAGS := -eu -o pipefail -c
.DEFAULT_GOAL := help

APT_PACKAGES := build-essential cmake ninja-build git pkg-config python3-venv python3-dev \
  libfmt-dev libeigen3-dev libcli11-dev libtomlplusplus-dev nlohmann-json3-dev \
  libhdf5-dev libboost-dev libssl-dev libgtest-dev libgmock-dev
MPI_PACKAGES := libopenmpi-dev openmpi-bin
SLURM_PACKAGES := slurm-wlm munge
LINT_PACKAGES := clang-format-14 clang-tidy-14
SANITIZER_PACKAGES := clang-14 libclang-rt-14-dev
PACKAGING_PACKAGES := dpkg-dev lintian file
TRIAL_PACKAGES := debootstrap
EMULATOR_PACKAGES := qemu-user
FUZZ_SECONDS ?= 60
COVERAGE_PACKAGES := gcovr
BROWSER_PACKAGES := chromium chromium-driver fonts-dejavu-core
PAPER := papers/kammer2012
RESULTS ?= results
EXPERIMENT ?=
VENV := .venv
PYTHON := $(VENV)/bin/python
PIP_INSTALL := $(PYTHON) -m pip install --quiet --disable-pip-version-check -r /dev/stdin
# Of CMakePresets.json: release, or mpi, whose program several processes can share and which runs alone as well.
PRESET ?= release
BUILD := build/$(PRESET)
PROGRAM := $(BUILD)/slipfront
# Whether warnings are errors: ON in continuous integration, whose compilers are known.
WERROR ?= OFF

.PHONY: help setup program build build-mpi module stubs wheel wheel-trial test test-slow test-mpi examples site site-links reproduce sensitivity quick regularised convergence interface-step open-choices andrews1976 bases sweep slurm-trial slurm-mpi-trial reference contact-algorithms bench docs format format-check lint verify verification-pages tidy hostile report-trial fuzz deep-check fuzz-cases sanitize coverage clean

help:  ## list the targets
	@grep -hE '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed -E 's/:[^#]*## */\t/' | expand -t 16

setup: packages $(VENV)/.installed  ## install the Debian packages that are missing and make the project's own venv

.PHONY: packages
packages:
	@scripts/install-packages $(APT_PACKAGES) $(if $(filter mpi,$(PRESET)),$(MPI_PACKAGES))

$(VENV)/.installed: pyproject.toml | packages
	@echo "== Python environment $(VENV)"
	python3 -m venv $(VENV)
	$(PYTHON) scripts/python-requirements.py test build sweep fit | $(PIP_INSTALL)
	@touch $@

$(VENV)/.installed-browser: $(VENV)/.installed
	$(PYTHON) scripts/python-requirements.py browser | $(PIP_INSTALL)
	@touch $@

$(VENV)/.installed-lint: $(VENV)/.installed
	$(PYTHON) scripts/python-requirements.py lint | $(PIP_INSTALL)
	@touch $@

# The Python module stays configured once it is, unless the environment that it is built with has gone.
CONFIGURE = cmake --preset $(PRESET) -D SLIPFRONT_WERROR=$(WERROR) $(if $(wildcard $(VENV)/.installed),,-D SLIPFRONT_PYTHON=OFF)

program: packages  ## build the program alone: build/release/slipfront
	@echo "== Building $(PROGRAM)"
	$(CONFIGURE)
	cmake --build --preset $(PRESET) --target slipfront

# What the targets below need, the downloads beside the compilation.
.PHONY: ready ready-to-test
ready: packages
	@$(MAKE) --no-print-directory -j2 program $(VENV)/.installed

ready-to-test: packages
	@$(MAKE) --no-print-directory -j2 build $(VENV)/.installed
	@$(MAKE) --no-print-directory module

build: packages  ## build the program and all tests
	@echo "== Building everything"
	$(CONFIGURE)
	cmake --build --preset $(PRESET)

build-mpi: packages  ## the program whose runs several processes of MPI can share: build/mpi/slipfront
	@scripts/install-packages $(MPI_PACKAGES)
	@echo "== Building build/mpi/slipfront"
	cmake --preset mpi -D SLIPFRONT_WERROR=$(WERROR)
	cmake --build --preset mpi --target slipfront

module: program $(VENV)/.installed  ## build the Python module as well: python/slipfront/_core
	cmake --preset $(PRESET) -D SLIPFRONT_PYTHON=ON -D Python_EXECUTABLE=$(abspath $(PYTHON))
	cmake --build --preset $(PRESET) --target slipfront_core

stubs: module  ## renew the types of the module, python/slipfront/_core.pyi
	PYTHONPATH=python $(PYTHON) -m nanobind.stubgen -q -m slipfront._core -o python/slipfront/_core.pyi

# A wheel has all libraries within but those of C and C++, which auditwheel names.
$(VENV)/.installed-wheel: $(VENV)/.installed
	$(PYTHON) scripts/python-requirements.py wheel | $(PIP_INSTALL)
	@touch $@

build/static/lib/libhdf5.a: scripts/build-static-libraries | packages
	@echo "== Building libraries into build/static"
	scripts/build-static-libraries build/static

wheel: $(VENV)/.installed-wheel build/static/lib/libhdf5.a  ## the Python package for any x86-64 processor, with all that it needs, build/slipfront-*.whl
	rm -rf build/slipfront-*.whl build/unrepaired
	$(PYTHON) -m pip wheel --quiet --no-deps --no-build-isolation -w build/unrepaired \
	  -C build-dir=build/static/wheel \
	  -C cmake.define.CMAKE_PREFIX_PATH=$(CURDIR)/build/static -C cmake.define.HDF5_USE_STATIC_LIBRARIES=ON \
	  -C cmake.define.OPENSSL_USE_STATIC_LIBS=ON -C cmake.define.SLIPFRONT_LICENCES=$(CURDIR)/build/static/licences \
	  -C cmake.define.CMAKE_CXX_STANDARD_LIBRARIES=$(CURDIR)/build/static/lib/libz.a .
	PATH=$(CURDIR)/$(VENV)/bin:$$PATH $(VENV)/bin/auditwheel repair --wheel-dir build build/unrepaired/*.whl

wheel-trial: wheel program  ## try it in an empty environment, and on an old processor that is emulated
	@scripts/install-packages $(EMULATOR_PACKAGES)
	rm -rf build/wheel-trial
	scripts/try-wheel build/slipfront-*.whl build/wheel-trial $(PROGRAM)

test: ready-to-test  ## the tests, C++ and Python
	@scripts/run-tests $(BUILD) $(PYTHON)

test-slow: ready-to-test  ## the tests in Python that take longest: trials, tutorial, examples, notebooks
	@scripts/run-tests $(BUILD) $(PYTHON) slow

test-mpi: build-mpi $(VENV)/.installed  ## what processes share: as one process, with 2 and 3 of them
	SLIPFRONT_MPI=$(abspath build/mpi/slipfront) $(PYTHON) -m pytest -q --numprocesses="$$(nproc)" --dist=worksteal tests/mpi

# The paper's runs and figures; the argument adds options.
define REPRODUCE
@echo "== Running the paper's cases into $(RESULTS)"
PYTHONPATH=python $(PYTHON) $(PAPER)/reproduce.py -o $(RESULTS) --overwrite $(if $(EXPERIMENT),--experiment $(EXPERIMENT)) $(if $(wildcard $(RESULTS)-open-choices/checksums.sha256),--open-choices $(RESULTS)-open-choices) $(1)
@echo "== Drawing the figures"
PYTHONPATH=python $(PYTHON) $(PAPER)/draw.py $(RESULTS)
endef

reproduce: ready module  ## everything behind the paper: runs, scorecard, figures, into results/
	$(call REPRODUCE)

sensitivity: ready module  ## the same, and how far each figure of the scorecard moves with mesh and step
	$(call REPRODUCE,--sensitivity)

quick: ready module  ## the same in a second, on a coarse mesh, into results-quick/
	PYTHONPATH=python $(PYTHON) $(PAPER)/reproduce.py --quick -o $(RESULTS)-quick --overwrite
	PYTHONPATH=python $(PYTHON) $(PAPER)/draw.py $(RESULTS)-quick

verify: ready-to-test  ## problems with known answers, with their pictures, and the energy balance over a million steps
	$(BUILD)/slipfront-verify -o $(RESULTS)-verify
	PYTHONPATH=python $(PYTHON) verification/figures.py $(RESULTS)-verify $(RESULTS)-verify/figures
	$(BUILD)/test_motion --gtest_also_run_disabled_tests --gtest_filter='*Million*'

verification-pages: verify  ## renew the numbers and pictures of verification
	PYTHONPATH=python $(PYTHON) verification/pages.py $(RESULTS)-verify verification
	cp $(RESULTS)-verify/figures/*.png verification/figures/

bench: program  ## node updates per second against the machine's bandwidth
	$(PROGRAM) bench

contact-algorithms: ready module  ## the paper's events with each contact algorithm: renews papers/kammer2012/contact-algorithms.md
	PYTHONPATH=python $(PYTHON) $(PAPER)/contact_algorithms.py

regularised: ready module  ## the same events with friction that has a length scale, into results-regularised/
	PYTHONPATH=python $(PYTHON) $(PAPER)/reproduce.py --regularised -o $(RESULTS)-regularised --overwrite
	PYTHONPATH=python $(PYTHON) $(PAPER)/draw.py $(RESULTS)-regularised
	cp $(RESULTS)-regularised/figures/studies.png docs/figures/regularised_studies.png

# An event's studies, without and with a length scale in the friction, and their figures.
define CONVERGENCE
$(PROGRAM) study convergence $(PAPER)/$(1).toml -o $(RESULTS)-convergence/plain/$(1) --overwrite $(2)
$(PROGRAM) study convergence $(PAPER)/$(1).toml -o $(RESULTS)-convergence/regularised/$(1) --overwrite $(2) $(DELAYED) \
  --set 'title="$(1), mu_k = 0.6, strength relaxed over 0.5 us"'
PYTHONPATH=python $(PYTHON) -m slipfront.figures $(RESULTS)-convergence/plain/$(1)
PYTHONPATH=python $(PYTHON) -m slipfront.figures $(RESULTS)-convergence/regularised/$(1)
endef
DELAYED := --set friction.regularisation=strength --set friction.relaxation_time_s=0.5e-6
FINE := --element-sizes 1.3333333333333333e-3,6.6666666666666667e-4,3.3333333333333333e-4,1.6666666666666667e-4

convergence: ready  ## front speeds over mesh, step and damping, into results-convergence/ and docs/figures
	$(call CONVERGENCE,spontaneous,$(FINE))
	$(call CONVERGENCE,left)
	$(call CONVERGENCE,right)
	cp $(RESULTS)-convergence/plain/spontaneous/figures/convergence.png docs/figures/convergence_plain.png
	cp $(RESULTS)-convergence/regularised/spontaneous/figures/convergence.png docs/figures/convergence_regularised.png

interface-step: ready  ## error of front speeds against the cost of sub-cycling, into results-interface-step/ and docs/figures
	for event in left spontaneous right; do $(PROGRAM) study interface-step $(PAPER)/$$event.toml -o $(RESULTS)-interface-step/$$event --overwrite; done
	PYTHONPATH=python $(PYTHON) -m slipfront.figures.interface_step docs/figures/interface_step.png $(RESULTS)-interface-step/{left,spontaneous,right}

open-choices: ready module  ## what the paper leaves open, varied: renews papers/kammer2012/open-choices.md and its figure
	PYTHONPATH=python $(PYTHON) $(PAPER)/open_choices.py -o $(RESULTS)-open-choices --overwrite
	PYTHONPATH=python $(PYTHON) $(PAPER)/open_choices_page.py $(RESULTS)-open-choices

andrews1976: ready module  ## when ruptures pass c_S, after Andrews: renews papers/andrews1976/transition.png
	PYTHONPATH=python $(PYTHON) papers/andrews1976/claims.py papers/andrews1976

bases: ready module  ## the paper's events on deformable bases: renews papers/kammer2012/bases.md and its figure
	PYTHONPATH=python $(PYTHON) $(PAPER)/bases.py -o $(RESULTS)-bases --overwrite
	PYTHONPATH=python $(PYTHON) $(PAPER)/bases_page.py $(RESULTS)-bases

sweep: ready  ## 400 runs over the friction law's parameters, and their map, into results-sweep/ and docs/figures
	$(PROGRAM) sweep examples/sweeps/mu_k_alpha.toml -o $(RESULTS)-sweep
	PYTHONPATH=python $(PYTHON) -m slipfront.sweep.maps docs/figures/sweep_mu_k_alpha.png $(RESULTS)-sweep

slurm-trial: ready  ## sweeps by job arrays and workers of a Slurm cluster of this machine alone; as root
	@scripts/install-packages $(SLURM_PACKAGES)
	$(PYTHON) scripts/python-requirements.py sweep cluster | $(PIP_INSTALL)
	scripts/slurm-trial $(PROGRAM) $(PYTHON)

slurm-mpi-trial: build-mpi  ## runs that several processes share as jobs of such a cluster, over a limit of time; as root
	@scripts/install-packages $(SLURM_PACKAGES)
	scripts/slurm-mpi-trial build/mpi/slipfront

reference: ready  ## problems that other codes have solved, on several meshes each, into results-reference/
	$(PYTHON) scripts/compare-reference.py a --program $(PROGRAM) --results $(RESULTS)-reference
	$(PYTHON) scripts/compare-reference.py f --program $(PROGRAM) --results $(RESULTS)-reference
	$(PYTHON) scripts/compare-reference.py r --program $(PROGRAM) --results $(RESULTS)-reference
	$(PYTHON) scripts/compare-reference.py t --program $(PROGRAM) --results $(RESULTS)-reference
	$(PYTHON) scripts/compare-tpv205.py --program $(PROGRAM) --results $(RESULTS)-reference

.PHONY: laboratory
laboratory: ready module  ## records beside runs: renews pictures of docs/recorder-to-gamma.md, table and picture of docs/gauges.md
	PYTHONPATH=python $(PYTHON) scripts/laboratory.py --program $(abspath $(PROGRAM))
	PYTHONPATH=python SLIPFRONT_PROGRAM=$(abspath $(PROGRAM)) $(PYTHON) scripts/gauge-table.py build/gauge-table

.PHONY: fit-twins fit-references
fit-twins: ready module  ## fits to forty records whose truth is known, table of docs/fit.md: three quarters of an hour
	PYTHONPATH=python SLIPFRONT_PROGRAM=$(abspath $(PROGRAM)) $(PYTHON) scripts/fit-twins.py

fit-references: ready module  ## fits to other codes' solutions, whose values are known, table of docs/fit.md
	PYTHONPATH=python SLIPFRONT_PROGRAM=$(abspath $(PROGRAM)) $(PYTHON) scripts/fit-references.py

examples: ready  ## the worked cases of examples/, into results-examples/, and their pictures in docs/figures
	PYTHONPATH=python $(PYTHON) scripts/run-examples.py $(PROGRAM) $(RESULTS)-examples docs/figures

$(VENV)/.installed-docs: $(VENV)/.installed
	$(PYTHON) scripts/python-requirements.py docs | $(PIP_INSTALL)
	@touch $@

# `make docs` renews pages of the sources; this makes a site of them.
SPHINX = $(VENV)/bin/sphinx-build -c docs -q -W --keep-going
site: module $(VENV)/.installed-docs  ## the documentation as a site, build/site/index.html; any warning fails
	$(SPHINX) -b html . build/site
	@echo "site: build/site/index.html"

site-links: module $(VENV)/.installed-docs  ## fail where a link of the documentation to elsewhere leads nowhere; needs the network
	$(SPHINX) -b linkcheck . build/site-links

docs: module sensitivity convergence  ## renew the pages and figures of docs/ that the program writes
	$(PROGRAM) keys > docs/case-reference.md
	PYTHONPATH=python $(PYTHON) $(PAPER)/scorecard_page.py $(RESULTS)
	PYTHONPATH=python $(PYTHON) $(PAPER)/energy_criterion.py $(RESULTS)
	PYTHONPATH=python $(PYTHON) $(PAPER)/fracture.py
	PYTHONPATH=python $(PYTHON) $(PAPER)/sequences.py
	cp $(RESULTS)/figures/fig3_three_events.png $(RESULTS)/figures/fig6_energy.png $(PAPER)/figures/
	cp $(RESULTS)/figures/energy_balance.png docs/figures/

SOURCES = $(shell git ls-files '*.cpp' '*.hpp')

lint-packages:
	@scripts/install-packages $(LINT_PACKAGES)

.PHONY: lint-packages
format: lint-packages $(VENV)/.installed-lint  ## format all C++ and Python sources
	@clang-format-14 -i $(SOURCES)
	$(VENV)/bin/ruff format --quiet

format-check: lint-packages  ## fail where a C++ source is not formatted
	@clang-format-14 --dry-run --Werror $(SOURCES)

lint: $(VENV)/.installed-lint  ## fail where Python is not formatted, or ruff or mypy finds anything
	$(VENV)/bin/ruff format --check
	$(VENV)/bin/ruff check
	$(VENV)/bin/mypy

# In a folder of its own: clang cannot read what gcc has precompiled.
tidy: packages lint-packages $(VENV)/.installed  ## clang-tidy over the program's sources, or MODULES=motion alone
	@cmake --preset release -B build/tidy -D SLIPFRONT_TOGETHER=OFF -D SLIPFRONT_PYTHON=ON \
	  -D Python_EXECUTABLE=$(abspath $(PYTHON))
	@cmake --build build/tidy --target slipfront_version
	@scripts/tidy build/tidy $(MODULES)

hostile: ready-to-test  ## runs that are killed, damaged, signalled, or fail at any call: results are right or refused
	PYTHONPATH=tests $(PYTHON) -m hostile $(PROGRAM)

report-trial: ready $(VENV)/.installed-browser  ## pages of `slipfront report` in a real browser, with screenshots in results-browser/
	@scripts/install-packages $(BROWSER_PACKAGES)
	SLIPFRONT=$(CURDIR)/$(PROGRAM) SLIPFRONT_SCREENSHOTS=$(RESULTS)-browser $(PYTHON) -m pytest -q tests/browser

sanitize: packages  ## the C++ tests and coarse runs under the address, undefined-behaviour and thread sanitizers
	@scripts/install-packages $(SANITIZER_PACKAGES)
	cmake --preset asan
	cmake --build --preset asan
	cmake --preset tsan
	cmake --build --preset tsan
	@scripts/run-sanitizers build/asan build/tsan

fuzz: packages  ## files that are made up, for every reader of files, FUZZ_SECONDS each
	@scripts/install-packages $(SANITIZER_PACKAGES)
	cmake --preset asan
	cmake --build --preset asan --target fuzzers
	@scripts/run-fuzzers build/asan $(FUZZ_SECONDS)

# The state of the sources is a sum of all that clang compiles.
SOURCES_SUM = git ls-files -z -- '*.cpp' '*.hpp' '*.in' '*CMakeLists.txt' .clang-tidy | xargs -0 sha256sum | sha256sum | cut -c1-64
deep-check:  ## tidy, sanitize and fuzz, unless these sources have passed them: .ci/checked, which this renews
	@if [ "$$($(SOURCES_SUM))" = "$$(cat .ci/checked)" ]; then echo "deep-check: these sources have passed"; else \
	  $(MAKE) --no-print-directory tidy sanitize fuzz FUZZ_SECONDS=10 && $(SOURCES_SUM) > .ci/checked; fi

fuzz-cases: ready  ## random cases of all keys for validate, info, fracture and run; SEED=, CASES= to repeat some
	$(PYTHON) tests/fuzz/cases.py $(PROGRAM) --keep build/fuzz-cases $(if $(SEED),--seed $(SEED)) $(if $(CASES),--cases $(CASES))

coverage: packages  ## lines of the numerical core that the C++ tests run: table, and page build/coverage/index.html
	@scripts/install-packages $(COVERAGE_PACKAGES)
	cmake --preset coverage
	cmake --build --preset coverage
	@scripts/run-coverage build/coverage

package: packages  ## the program and libslipfront for any x86-64 processor, to be installed: build/package
	cmake --preset package
	cmake --build --preset package

install-trial: package  ## install it into build/install-trial and use program and library from there
	@scripts/install-trial build/package build/install-trial

.PHONY: package install-trial deb deb-trial debian-trial bare-wheel-trial source-archive
deb: package  ## a Debian package: build/package/slipfront_VERSION_amd64.deb, looked over by lintian
	@scripts/install-packages $(PACKAGING_PACKAGES)
	cd build/package && rm -f slipfront_*.deb && cpack -G DEB
	lintian --fail-on error,warning build/package/slipfront_*.deb

deb-trial: deb  ## install, run and remove it on a bare Debian 12; as root
	@scripts/install-packages $(TRIAL_PACKAGES)
	@scripts/deb-trial build/package/slipfront_*.deb build/debian-trial

DEBIAN ?= trixie
bare-wheel-trial: wheel  ## install and use it on a bare Debian of this release, without any library; as root
	@scripts/install-packages $(TRIAL_PACKAGES)
	@scripts/bare-wheel-trial "$$(. /etc/os-release; echo $$VERSION_CODENAME)" build/debian-trial build/slipfront-*.whl

debian-trial: packages  ## program and tests of the last commit on a bare Debian 13, or DEBIAN=bookworm; as root
	@scripts/install-packages $(TRIAL_PACKAGES)
	@scripts/debian-trial $(DEBIAN) build/debian-trial

VERSION = $(shell sed -nE 's/^project.slipfront VERSION ([0-9.]+).*/\1/p' CMakeLists.txt)

source-archive:  ## the sources of the last commit: build/slipfront-VERSION.tar.gz
	@mkdir -p build
	git archive --format=tar.gz --prefix=slipfront-$(VERSION)/ -o build/slipfront-$(VERSION).tar.gz HEAD

clean:  ## remove build, venv and results
	rm -rf build .cache $(VENV) $(RESULTS) $(RESULTS)-*
