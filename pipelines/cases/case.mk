# What the cases share: samples come to rest, are pressed and measured; expected.toml says which figures are wanted, and so
# what is made of each run. A case's Makefile adds how its samples come about. Run it as
#
#   make -f pipelines/cases/NAME/Makefile [-j 2] [SIZE=small|full] [PACKINGS="1 2 3"] [OUT=out/cases/NAME] [BIN=build/bin] [NP=1]
#        [figures | check | picture | record]
#
#   figures   OUT/figures.csv: mean and spread over the packings, beside the reference (the default)
#   check     the same, and an error where one is outside what expected.toml allows
#   picture   OUT/picture.png
#   record    both, kept in the case's folder as the figures to expect (of SIZE=full)
#
# OUT/RUN-PACKING holds sample.h5, scene.toml, relaxed.h5, run.h5 and the measures of one run. A run that was interrupted
# resumes from its checkpoint. HERE is the case's folder, set before this file is included.

CASES := $(dir $(patsubst %/,%,$(HERE)))
CASE := $(notdir $(patsubst %/,%,$(HERE)))
include $(CASES)../common.mk

SIZE ?= small
PACKINGS ?= $(if $(filter full,$(SIZE)),1 2 3,1)
OUT ?= out/cases/$(CASE)
NP ?= 1
THREADS ?=
MPIRUN ?= mpirun --oversubscribe --bind-to none

.PHONY: figures check picture record
figures: $(OUT)/figures.csv

$(call one_path_each,OUT BIN)
ifeq ($(filter small full,$(SIZE)),)
$(error SIZE is '$(SIZE)'; it can be small or full)
endif

threads := $(if $(THREADS),--threads $(THREADS))
parallel := $(if $(filter-out 1,$(NP)),$(MPIRUN) -n $(NP) )
# Of RUN-PACKING, the stem of a file: the run and the packing.
packing = $(lastword $(subst -, ,$1))
run = $(patsubst %-$(call packing,$1),%,$1)
# A part of a name, as the 2nd of brick_2000_0.70.
part = $(word $1,$(subst _, ,$2))

# ---- the chain -------------------------------------------------------------------------------------------------------
# brick_PARTICLES_DENSITY-PACKING
$(OUT)/bricks/brick_%.h5: | $(BIN)/packgen
	@mkdir -p $(@D)
	$(BIN)/packgen $@ --particles $(call part,1,$(call run,$*)) --density $(call part,2,$(call run,$*)) \
	    --random-seed $(call packing,$*) $(threads) --quiet

$(OUT)/%/relaxed.h5: $(OUT)/%/sample.h5 $(OUT)/%/scene.toml | $(BIN)/relax
	$(parallel)$(BIN)/relax $^ $@ --json $(@:.h5=.json) --quiet

# A summary comes with what it is of.
$(OUT)/%/sample.json: $(OUT)/%/sample.h5 ;
$(OUT)/%/relaxed.json: $(OUT)/%/relaxed.h5 ;

# What a checkpoint was made from, so that it serves nothing else.
$(OUT)/%/run.h5 $(OUT)/%/run.json &: $(OUT)/%/relaxed.h5 $(OUT)/%/scene.toml | $(BIN)/solve
	@sha256sum $^ | cmp -s - $(@D)/run.inputs || rm -f $(addprefix $(@D)/,run.h5 run.h5.partial run.h5.checkpoint run.json)
	@test -e $(@D)/run.json || rm -f $(@D)/run.h5
	@sha256sum $^ > $(@D)/run.inputs
	@test ! -e $(@D)/run.h5 || touch $(@D)/run.h5 $(@D)/run.json
	test -e $(@D)/run.h5 || $(parallel)$(BIN)/solve $^ $(@D)/run.h5 --resume --json $(@D)/run.json --quiet

# ---- measures: NAME.csv and NAME.json by every measure of that name, with NAME.options of the case ----------------------------
shape_factor.outputs = --means $(@D)/shape_factor_means.csv
define measure
$$(OUT)/%/$1.csv $$(OUT)/%/$1.json &: $$(OUT)/%/run.h5 | $$(BIN)/$1
	$$(BIN)/$1 $$< $$(@D)/$1.csv $$($1.options) $$($1.outputs) $$(call threads_of,$1) --json $$(@D)/$1.json --quiet
endef
$(foreach name,$(measures_of_bin),$(eval $(call measure,$(name))))
$(OUT)/%/shape_factor_means.csv: $(OUT)/%/shape_factor.csv ;

# ---- figures and picture ----------------------------------------------------------------------------------------------
expected := $(HERE)expected.toml
figure_files := $(shell $(CASES)figures.py $(expected) $(OUT) $(SIZE) $(PACKINGS) --files)
ifneq ($(.SHELLSTATUS),0)
$(error the figures to make are not known)
endif
wanted.figures := $(SIZE) $(PACKINGS)
$(eval $(call text_file,$(OUT)/figures.parameters,wanted.figures))

$(OUT)/figures.csv: $(CASES)figures.py $(expected) $(figure_files) $(OUT)/figures.parameters
	$< $(expected) $(OUT) $(SIZE) $(PACKINGS)

check: $(OUT)/figures.csv
	$(CASES)figures.py $(expected) $(OUT) $(SIZE) $(PACKINGS) --check

picture: $(OUT)/picture.png
panel_files := $(shell $(CASES)picture.py $(expected) $(OUT) $(SIZE) $(PACKINGS) --files)
$(OUT)/picture.png: $(CASES)picture.py $(expected) $(figure_files) $(panel_files) $(OUT)/figures.parameters
	$< $(expected) $(OUT) $(SIZE) $(PACKINGS)

record: $(OUT)/figures.csv $(OUT)/picture.png
	$(if $(filter full,$(SIZE)),,$(error record keeps the figures of SIZE=full))
	cp $^ $(HERE)
