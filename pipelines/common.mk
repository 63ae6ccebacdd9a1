# What the pipelines share; a pipeline includes it first. COMMON is the folder of the pipelines.

COMMON := $(dir $(lastword $(MAKEFILE_LIST)))

BIN ?= build/bin

export OMPI_ALLOW_RUN_AS_ROOT := 1
export OMPI_ALLOW_RUN_AS_ROOT_CONFIRM := 1

.DELETE_ON_ERROR:
.SECONDARY:
.SECONDEXPANSION:
.SUFFIXES:
.PHONY: FORCE

quoted = '$(subst ','\'',$1)'
# Not empty in a dry run.
dry := $(findstring n,$(firstword -$(MAKEFLAGS)))

# $(call one_path_each,NAME...): an error where a variable is not one path.
one_path_each = $(foreach name,$1,$(if $(filter-out 1,$(words $($(name)))),$(error $(name) must be one path, without spaces)))

# $(eval $(call text_file,FILE,VARIABLE)): a file that holds the value of a variable, written only when that has changed.
# What depends on the file is made again then.
define text_file
ifneq ($$(wildcard $1)=$$(file <$1),$1=$$($2))
$1: FORCE
endif
$1:
	@mkdir -p $$(@D)
	@printf '%s\n' $$(call quoted,$$($2)) > $$@
endef
# $(call files_of_text,NAME...): the variable NAME in $(OUT)/NAME.
files_of_text = $(foreach name,$1,$(eval $(call text_file,$(OUT)/$(name),$(name))))

# Tools as they describe themselves in BIN/tools.json: words measure/NAME, threads/NAME; read when first needed.
described = $(eval described := $$(shell $(COMMON)described.py $(BIN)))$(if $(filter 0,$(.SHELLSTATUS)),,$(error the tools are not known))$(described)
measures_of_bin = $(patsubst measure/%,%,$(filter measure/%,$(described)))
# $(call threads_of,TOOL): --threads, if the tool takes it and THREADS is given.
threads_of = $(if $(THREADS),$(if $(filter threads/$1,$(described)),--threads $(THREADS)))
