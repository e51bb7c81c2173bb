# make study    install what is missing, build, run studies/first.json, print its table, draw its charts
# make test     the quick tier of the tests and of the reference cases (what CI runs)
# make test-all the quick tier, the long ones, every reference case, the Python readers, and the reports in a browser
# make contact-matrix  the paper's capsule with contact over meshes, loads and seeds (four minutes)
# make torture  kills, signals, full disks, damaged and mutated files, little memory: 20 minutes, one table
# make paper    the studies of the paper's cases (an hour), their tables and pictures in results/paper/published
# make pareto   work-precision diagrams: studies/pareto.json (three quarters of an hour on two cores) and the scenes with an
#               exact answer, their tables and pictures in results/pareto/published
# make stability  where each method fails: studies/stability.json (a quarter of an hour on two cores), its maps and pictures in results/stability/published
# make validate every reference case, with its error and its tolerance: twenty minutes on one core
# make browser  reports of ten small studies, used in headless Chromium: a minute
# make bench    what billow costs on this machine, a few minutes
# make slurm    a study on a Slurm cluster of two nodes on this machine, with accidents, with the program of make dist (root only)
# make dist     a self-contained program with licences, completions and man page, as an archive in target/dist
# make wheel    a Python wheel with that program and the module `billow`, in target/dist
# make scale    what the commands cost with 100,000 finished piston jobs: a quarter of an hour, one table (SCALE="--jobs 1000")
# make layers   which folder imports which: none from above, no circle
# make check    formatting, lints, layers of the folders, avoided words, docs
# make fresh-check  both README commands in a bare Debian 12 root (root only)

SHELL := /bin/bash
.SHELLFLAGS := -eu -o pipefail -c

# One profile and one feature set for everything, so that every dependency is compiled once.
CARGO := cargo
FLAGS := --release --workspace --locked
BILLOW := $${CARGO_TARGET_DIR:-target}/release/billow
CHECKS := $${CARGO_TARGET_DIR:-target}/release/billow-checks

PACKAGES := libhdf5-dev pkg-config
DIST_PACKAGES := g++ binutils git python3 python3-venv
READER_PACKAGES := python3 python3-venv
BROWSER_PACKAGES := chromium python3
SLURM_PACKAGES := slurmctld slurmd slurm-client munge procps python3

.PHONY: dist wheel study paper pareto stability validate test test-all test-long torture contact-matrix readers browser build program bench scale layers check deps dist-deps reader-deps browser-deps slurm slurm-deps fresh-check

study: program
	$(BILLOW) run studies/first.json
	$(BILLOW) table studies/first.json
	$(BILLOW) chart studies/first.json

paper: program
	studies/publish_paper.sh $(BILLOW)

pareto: build
	studies/publish_pareto.sh $(BILLOW) $(CHECKS)

validate: build
	$(CHECKS) validate

stability: build
	$(CHECKS) stability studies/stability.json --results results/stability/published > /dev/null

test: deps
	$(CARGO) test $(FLAGS)
	$(CHECKS) validate --quick

test-all: test test-long readers browser slurm wheel

# Tests marked `#[ignore]` are the long tier; so are the cases `validate --quick` leaves out.
test-long: deps reader-deps
	$(CARGO) test $(FLAGS) -- --ignored
	$(CHECKS) validate
	tests/matrix/contact.py results/contact-matrix --billow $(BILLOW) --subdivisions 5 --seeds 1

# Runs it has finished are not run again.
contact-matrix: program reader-deps
	tests/matrix/contact.py results/contact-matrix --billow $(BILLOW)

# Its options, as in: make torture TORTURE="--only kill9,signals --trials 0.1 --seed 7"
torture: deps
	$(CARGO) test --release --locked -p billow-study --test torture -- $(TORTURE)

# Opens two small studies, fresh, with h5py, xarray, pandas, pyarrow and vtk; reads decks for other codes; uses the Python
# module and the notebook.
readers: program reader-deps
	results=$$(mktemp -d); trap 'rm -rf "$$results"' EXIT; \
	for study in piston film; do \
	    $(BILLOW) run tests/readers/$$study.json --results "$$results/$$study" --quiet > /dev/null; \
	    $(BILLOW) export "$$results/$$study" --out "$$results/$$study.nc" > /dev/null; \
	    tests/readers/check.sh "$$results/$$study" "$$results/$$study.nc"; \
	done; \
	$(BILLOW) run tests/readers/deck.json --results "$$results/deck" --quiet > /dev/null; \
	tests/readers/check.sh --deck $(BILLOW) "$$results/deck"
	BILLOW_PROGRAM=$(BILLOW) tests/readers/check.sh --module docs/first_study.ipynb

# The Python package with the program of `make dist`, checked in an environment of its own.
wheel: dist
	.ci/wheel.sh

browser: program browser-deps
	python3 tests/report/browser.py $(BILLOW)

build: deps
	$(CARGO) build $(FLAGS)

# The program alone, without its checks.
program: deps
	$(CARGO) build --release --locked -p billow-study

# With the program of `make dist`, as on nodes without libhdf5. Says so where it cannot run: exit code 77 of the script.
slurm: dist slurm-deps
	tests/slurm/run.sh "$$(ls -t "$${CARGO_TARGET_DIR:-target}"/dist/billow-*.tar.gz | head -1)" || [ $$? -eq 77 ]

bench: build
	$(CHECKS) bench

# For machines without libhdf5. It is compiled in a folder of its own and checked by tests/dist/check.sh.
dist: deps dist-deps
	.ci/dist.sh

scale: program
	python3 tests/scale/scale.py --billow $(BILLOW) $(SCALE)

# Which room imports which, and that none imports from above.
layers: deps
	$(CARGO) test $(FLAGS) --test repository layers -- --nocapture

check: deps
	$(CARGO) fmt --check
	$(CARGO) clippy $(FLAGS) --all-targets -- -D warnings
	$(CARGO) test $(FLAGS) --test repository
	RUSTDOCFLAGS="-D warnings" $(CARGO) doc $(FLAGS) --no-deps
	if command -v cargo-deny > /dev/null; then cargo deny check; fi

deps:
	@.ci/install.sh $(PACKAGES)

slurm-deps:
	@[ "$$(id -u)" -ne 0 ] || .ci/install.sh $(SLURM_PACKAGES) || echo "no packages of Slurm"

dist-deps:
	@.ci/install.sh $(DIST_PACKAGES)

reader-deps:
	@.ci/install.sh $(READER_PACKAGES)

browser-deps:
	@.ci/install.sh $(BROWSER_PACKAGES)

fresh-check:
	.ci/fresh-check.sh
