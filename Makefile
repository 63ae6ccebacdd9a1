# The front door of tomodem. `make demo` and `make test` need nothing but git and make on a Debian 12.
#
#   make build                  every tool, in build/bin
#   make demo                   tomography -> simulation -> pictures and a report, in out/demo
#   make demo VOLUME=stack.tif VOXEL_SIZE=2.4um [LABELS="1=matrix,2=inclusion" | THRESHOLD=120]
#   make batch STACKS=folder [SCENE=scene.toml] [VOXEL_SIZE=2.4um] [NP=1]     every stack of a folder, in out/batch (docs/batch.md)
#   make case CASE=two_phases [SIZE=full]       a case of the thesis and its figures, in out/cases/two_phases (docs/cases.md)
#   make test                   every test that CI runs, lint among them
#   make trade                  what accuracy costs: docs/trade.md and the table of `tomodem plan`
#   make physics                long physical checks
#   make bench                  measurements of speed and memory
#   make fuzz SECONDS=3600      the readers of volumes under libFuzzer
#   make lint                   clang-tidy on every source and header
#   make install PREFIX=/usr/local

BUILD := build
PREFIX ?= /usr/local
JOBS ?= $(shell nproc)
OUT ?= out/demo

export OMPI_ALLOW_RUN_AS_ROOT := 1
export OMPI_ALLOW_RUN_AS_ROOT_CONFIRM := 1

.PHONY: build tests benches demo batch case test physics bench trade fuzz lint docs install clean

# Packages are looked at once; after that, only when the list changes. What tests need is in a list of its own.
$(BUILD)/.installed-%: packages/%.txt bootstrap
	./bootstrap $<
	mkdir -p $(BUILD)
	touch $@

# One folder for all: the tools alone at first; `make test` and `make bench` switch theirs on there, and build nothing twice.
configure = cmake --preset release -DCMAKE_INSTALL_PREFIX=$(PREFIX) $1 $(if $(wildcard $(BUILD)/build.ninja),>/dev/null)

build: $(BUILD)/.installed-debian
	$(call configure)
	cmake --build $(BUILD) -j $(JOBS)

tests: $(BUILD)/.installed-debian $(BUILD)/.installed-debian-test
	$(call configure,-DBUILD_TESTING=ON)
	cmake --build $(BUILD) -j $(JOBS) --target all tests

benches: $(BUILD)/.installed-debian $(BUILD)/.installed-debian-test
	$(call configure,-DTOMODEM_BENCH=ON)
	cmake --build $(BUILD) -j $(JOBS) --target all benches

demo: build
	$(MAKE) -f pipelines/demo/Makefile BIN=$(CURDIR)/$(BUILD)/bin OUT=$(OUT)

batch: build
	$(MAKE) -j $(JOBS) -f pipelines/batch/Makefile BIN=$(CURDIR)/$(BUILD)/bin OUT=$(if $(filter file,$(origin OUT)),out/batch,$(OUT))

case: build
	$(if $(wildcard pipelines/cases/$(CASE)/Makefile),,$(error CASE can be $(notdir $(patsubst %/,%,$(dir $(wildcard pipelines/cases/*/Makefile))))))
	$(MAKE) -j $(JOBS) -f pipelines/cases/$(CASE)/Makefile BIN=$(CURDIR)/$(BUILD)/bin \
	    OUT=$(if $(filter file,$(origin OUT)),out/cases/$(CASE),$(OUT)) figures picture

test: tests
	ctest --test-dir $(BUILD) --output-on-failure -j $(JOBS) -LE 'physics|bench'

physics: tests
	ctest --test-dir $(BUILD) --output-on-failure -V -L physics

trade: build
	$(MAKE) -f pipelines/trade/Makefile publish BIN=$(CURDIR)/$(BUILD)/bin OUT=$(if $(filter file,$(origin OUT)),out/trade,$(OUT))

bench: benches
	ctest --test-dir $(BUILD) --output-on-failure -V -L bench

fuzz: $(BUILD)/.installed-debian $(BUILD)/.installed-debian-test
	tests/fuzz/fuzz $(or $(SECONDS),600)

# The ctest `lint` is the same.
lint: $(BUILD)/.installed-debian $(BUILD)/.installed-debian-test
	tests/lint/lint $(BUILD)/lint --jobs $(JOBS)

# The reference of every tool, from its own usage; the cases, from their recorded figures.
docs: build
	docs/make_reference $(BUILD)/bin > docs/reference.md
	pipelines/cases/table.py > docs/cases.md

install: build
	cmake --install $(BUILD)

clean:
	rm -rf $(BUILD) out
