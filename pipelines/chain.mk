# The chain of one stack, from a segmented tomography to $(OUT)/report.html. Pipelines include it, or run it:
#
#   make -f pipelines/chain.mk VOLUME=stack.tif [VOXEL_SIZE=2.4um [OVERRIDE_VOXEL_SIZE=yes]] OUT=out/stack [BIN=build/bin] [NP=1]
#        [OBJECTS=components | watershed | labels] [sample | relaxed | run | report]
#
# Every file is made by one command from the files that it depends on. Inputs, the executables too, count by their content:
# inputs.py takes their digests while make reads this, and a small file each in $(OUT)/digests is written where one has
# changed. So do the parameters below. What has changed is made again with all that depends on it, the rest is kept.

include $(dir $(lastword $(MAKEFILE_LIST)))common.mk

NP ?= 1
# D of the brick; by default that of the scene's law.
DENSITY ?=
PARTICLES ?= 40000
BRICK_PARTICLES ?= 10000
FILTER ?= level-set
PICTURE_SIZE ?= 960x720
# Processes of one machine that may be busy; the same result on any number of them within the noise of the law.
MPIRUN ?= mpirun --oversubscribe --bind-to none
# Threads of each tool; every core unless given.
THREADS ?=
# One brick may serve many stacks.
BRICK ?= $(OUT)/brick.h5
DIGEST_CACHE ?= $(OUT)/.digests.json

.PHONY: brick sample relaxed run report
report: $(OUT)/report.html
brick: $(BRICK)
sample: $(OUT)/sample.h5
relaxed: $(OUT)/relaxed.h5
run: $(OUT)/run.h5

# ---- what the user gave --------------------------------------------------------------------------------------------
$(call one_path_each,OUT BIN)
ifdef VOLUME
  ifneq ($(words $(VOLUME)),1)
    $(error VOLUME must be one path without spaces; make a link of another name to it)
  endif
  ifeq ($(wildcard $(VOLUME)),)
    $(error VOLUME '$(VOLUME)' does not exist)
  endif
  IMAGE := $(VOLUME)$(if $(DATASET),:$(DATASET))
  IMAGE_STATE := $(OUT)/digests/image
else
  IMAGE_STATE := $(IMAGE)
endif
ifdef SCENE
  ifeq ($(wildcard $(SCENE)),)
    $(error SCENE '$(SCENE)' does not exist)
  endif
  # As the user wrote it: it may name files beside it.
  scene := $(SCENE)
  whole_scene := $(OUT)/digests/scene
  relaxing_scene := $(OUT)/digests/scene_relax
  named_phases := $(OUT)/digests/scene_phases
else
  scene := $(OUT)/scene.toml
  whole_scene := $(scene)
  relaxing_scene := $(scene)
endif

image_options := $(strip $(if $(VOXEL_SIZE),--voxel-size $(VOXEL_SIZE)) \
    $(if $(OVERRIDE_VOXEL_SIZE),--override-voxel-size) $(if $(SLICE_SPACING),--slice-spacing $(SLICE_SPACING)) \
    $(if $(THRESHOLD),--threshold $(THRESHOLD)) $(if $(OTSU),--otsu $(OTSU)) $(if $(RELABEL),--relabel $(RELABEL)) \
    $(if $(ROI),--roi $(ROI)) $(RAW_OPTIONS))

# ---- parameters are files too ----------------------------------------------------------------------------------------
image.parameters := $(strip $(IMAGE) $(image_options))
plan.parameters := $(strip $(image_options) $(if $(SCENE),--scene $(SCENE)) $(if $(LABELS),--labels $(call quoted,$(LABELS))) \
    $(if $(DENSITY),--density $(DENSITY)) $(if $(OBJECTS),--objects $(OBJECTS)) \
    $(if $(PIXELS_PER_SEED),--pixels-per-seed $(PIXELS_PER_SEED),--particles $(PARTICLES)))
separated := $(filter watershed,$(OBJECTS))
sample.parameters := $(strip $(if $(separated),,$(image_options)) --filter $(FILTER))
shape.parameters := $(strip $(SHAPE_OPTIONS))
pictures.parameters := $(strip --size $(PICTURE_SIZE))
$(call files_of_text,image.parameters plan.parameters sample.parameters shape.parameters pictures.parameters)

programs := volume_info plan packgen vol2pack relax solve stress_strain shape_factor volume_change equilibrium mesh_recon render \
    report $(if $(separated),separate_objects) $(PROGRAMS)
digests := $(shell $(COMMON)inputs.py $(if $(dry),,--cache $(DIGEST_CACHE)) $(if $(SCENE),--scene $(SCENE)) \
    $(if $(VOLUME),--image $(VOLUME) --bin $(BIN)) tools=$(BIN)/tools.json $(foreach name,$(programs),$(name)=$(BIN)/$(name)))
ifneq ($(.SHELLSTATUS),0)
$(error the inputs cannot be read)
endif
digest_names := $(foreach word,$(digests),$(firstword $(subst =, ,$(word))))
$(foreach word,$(digests),$(eval digests/$(subst =, := ,$(word))))
$(call files_of_text,$(addprefix digests/,$(digest_names)))

# The brick's are beside it, as several stacks may share it. Without a scene `plan` proposes one of law NORTON.
brick.parameters := --particles $(BRICK_PARTICLES) $(if $(DENSITY),--density $(DENSITY),--law $(or $(digests/law),norton))
brick_state := $(strip $(brick.parameters) $(digests/packgen))
$(eval $(call text_file,$(BRICK).state,brick_state))

parallel = $(if $(filter-out 1,$(NP)),$(MPIRUN) -n $(NP) )
threads := $(if $(THREADS),--threads $(THREADS))
options = $$(cat $(OUT)/options/$1)

# ---- the chain -------------------------------------------------------------------------------------------------------
$(OUT)/image.json: $(OUT)/digests/volume_info $(IMAGE_STATE) $(OUT)/image.parameters
	$(BIN)/volume_info $(IMAGE) $(image_options) $(threads) --json $@

# Options of the other tools that depend on the image; the scene, and those that follow from its load.
plan = $(BIN)/plan $(IMAGE) $(OUT)/scene.toml $(plan.parameters) --options $(OUT)/options $(threads)
$(OUT)/plan.json $(addprefix $(OUT)/options/,vol2pack render inclusions mesh_recon shape_factor $(if $(separated),separate_objects)) &: \
    $(OUT)/digests/plan \
    $(IMAGE_STATE) $(named_phases) $(OUT)/image.parameters $(OUT)/plan.parameters
	$(plan) --write sample --json $(OUT)/plan.json

$(OUT)/scene.toml $(addprefix $(OUT)/options/,press equilibrium) &: $(OUT)/digests/plan \
    $(if $(SCENE),$(whole_scene),$(IMAGE_STATE) $(OUT)/image.parameters) $(OUT)/plan.parameters
	$(plan) --write load --quiet

$(BRICK) $(BRICK:.h5=.json) &: $(BRICK).state
	$(BIN)/packgen $(BRICK) $(brick.parameters) $(threads) --json $(BRICK:.h5=.json)

# With OBJECTS=watershed the sample is made from an image in which touching objects have labels of their own.
$(OUT)/objects.tif $(OUT)/objects.png $(OUT)/objects.json &: $(OUT)/digests/separate_objects $(IMAGE_STATE) \
    $(OUT)/options/separate_objects $(OUT)/image.parameters
	$(BIN)/separate_objects $(IMAGE) $(OUT)/objects.tif $(image_options) $(call options,separate_objects) $(threads) \
	    --picture $(OUT)/objects.png --json $(OUT)/objects.json

$(OUT)/sample.h5 $(OUT)/sample.json &: $(OUT)/digests/vol2pack $(BRICK) $(if $(separated),$(OUT)/objects.tif,$(IMAGE_STATE)) \
    $(OUT)/options/vol2pack $(OUT)/sample.parameters
	$(BIN)/vol2pack $(BRICK) $(if $(separated),$(OUT)/objects.tif,$(IMAGE)) $(OUT)/sample.h5 $(sample.parameters) $(call options,vol2pack) $(threads) \
	    --json $(OUT)/sample.json

$(OUT)/relaxed.h5 $(OUT)/relaxed.json &: $(OUT)/digests/relax $(OUT)/sample.h5 $(relaxing_scene)
	$(parallel)$(BIN)/relax $(OUT)/sample.h5 $(scene) $(OUT)/relaxed.h5 --json $(OUT)/relaxed.json

# A run that was stopped resumes from its checkpoint, unless something that it was made from has changed since.
# run.pid, while it works: SIGUSR1 to that process saves and stops it.
run_inputs := $(OUT)/relaxed.h5 $(scene) $(whole_scene) $(OUT)/digests/solve
$(OUT)/run.h5 $(OUT)/run.json &: $(OUT)/digests/solve $(OUT)/relaxed.h5 $(whole_scene)
	@sha256sum $(run_inputs) > $(OUT)/run.inputs.now
	@cmp -s $(OUT)/run.inputs.now $(OUT)/run.inputs || rm -f $(addprefix $(OUT)/,run.h5 run.h5.partial run.h5.checkpoint run.json)
	@test -e $(OUT)/run.json || rm -f $(OUT)/run.h5
	@mv $(OUT)/run.inputs.now $(OUT)/run.inputs
	@test ! -e $(OUT)/run.h5 || touch $(OUT)/run.h5 $(OUT)/run.json
	test -e $(OUT)/run.h5 || { echo $$$$ > $(OUT)/run.pid; \
	    exec $(parallel)$(BIN)/solve $(OUT)/relaxed.h5 $(scene) $(OUT)/run.h5 --resume --json $(OUT)/run.json; }
	@rm -f $(OUT)/run.pid

# ---- measures --------------------------------------------------------------------------------------------------------
$(OUT)/stress_strain.csv $(OUT)/stress_strain.json &: $(OUT)/digests/stress_strain $(OUT)/run.h5
	$(BIN)/stress_strain $(OUT)/run.h5 $(OUT)/stress_strain.csv --json $(OUT)/stress_strain.json

$(OUT)/shape_factor.csv $(OUT)/shape_factor_means.csv $(OUT)/shape_factor.json &: $(OUT)/digests/shape_factor \
    $(OUT)/run.h5 $(OUT)/options/shape_factor $(OUT)/shape.parameters
	$(BIN)/shape_factor $(OUT)/run.h5 $(OUT)/shape_factor.csv $(call options,shape_factor) $(shape.parameters) \
	    --means $(OUT)/shape_factor_means.csv --json $(OUT)/shape_factor.json

$(OUT)/volume_change.csv $(OUT)/volume_change.json &: $(OUT)/digests/volume_change $(OUT)/run.h5
	$(BIN)/volume_change $(OUT)/run.h5 $(OUT)/volume_change.csv $(threads) --json $(OUT)/volume_change.json

$(OUT)/equilibrium.csv $(OUT)/equilibrium.json &: $(OUT)/digests/equilibrium $(OUT)/run.h5 $(OUT)/options/equilibrium
	$(BIN)/equilibrium $(OUT)/run.h5 $(OUT)/equilibrium.csv $(call options,equilibrium) \
	    --json $(OUT)/equilibrium.json

# ---- shapes and pictures: the first frame is "before", the last one "after" --------------------------------------------
frame_before := 0
frame_after := -1

$(OUT)/mesh_%.stl $(OUT)/mesh_%.json &: $(OUT)/digests/mesh_recon $(OUT)/run.h5 $(OUT)/options/mesh_recon
	$(BIN)/mesh_recon $(OUT)/run.h5 $(OUT)/mesh_$*.stl --frame $(frame_$*) $(call options,mesh_recon) $(threads) \
	    --json $(OUT)/mesh_$*.json

picture_state := $(addprefix $(OUT)/,digests/render run.h5 options/render options/press options/inclusions pictures.parameters)
both_frames := --frames first,last --names before,after
$(OUT)/picture_cut_before.png $(OUT)/picture_cut_after.png $(OUT)/picture_cut.json &: $(picture_state)
	$(BIN)/render $(OUT)/run.h5 $(OUT)/picture_cut.png $(both_frames) --cut auto $(call options,press) \
	    $(call options,render) $(pictures.parameters) $(threads) --json $(OUT)/picture_cut.json

$(OUT)/picture_inclusions_before.png $(OUT)/picture_inclusions_after.png $(OUT)/picture_inclusions.json &: $(picture_state)
	$(BIN)/render $(OUT)/run.h5 $(OUT)/picture_inclusions.png $(both_frames) $(call options,inclusions) \
	    $(call options,render) $(pictures.parameters) $(threads) --json $(OUT)/picture_inclusions.json

$(OUT)/picture_mesh_%.png $(OUT)/picture_mesh_%.json &: $(OUT)/digests/render $(OUT)/mesh_%.stl $(OUT)/run.h5 \
    $(OUT)/pictures.parameters
	$(BIN)/render $(OUT)/mesh_$*.stl $(OUT)/picture_mesh_$*.png --view-of $(OUT)/run.h5 $(pictures.parameters) $(threads) \
	    --json $(OUT)/picture_mesh_$*.json

# ---- the report ------------------------------------------------------------------------------------------------------
STEPS := $(if $(VOLUME),,phantom) image brick sample relaxed run stress_strain shape_factor volume_change equilibrium \
    mesh_before mesh_after picture_cut picture_inclusions picture_mesh_before picture_mesh_after
PICTURES := $(foreach what,cut inclusions mesh,$(OUT)/picture_$(what)_before.png $(OUT)/picture_$(what)_after.png)
TABLES := $(foreach table,stress_strain shape_factor shape_factor_means volume_change equilibrium,$(OUT)/$(table).csv)
summaries := $(patsubst $(OUT)/brick.json,$(BRICK:.h5=.json),$(STEPS:%=$(OUT)/%.json))

# What is not here yet (every other measure, the surfaces of the 3-D view) it makes itself, and keeps in OUT.
$(OUT)/report.html: $(OUT)/digests/report $(OUT)/digests/tools $(OUT)/run.h5 $(OUT)/scene.toml $(summaries) $(PICTURES) $(TABLES)
	$(BIN)/report $(OUT)/run.h5 $@ --with $(OUT) --size $(PICTURE_SIZE) $(threads)
