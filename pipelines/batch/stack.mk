# One stack of a batch: the chain with the variables that the stack brings itself.
here := $(dir $(lastword $(MAKEFILE_LIST)))
ifneq ($(OWN),)
include $(OWN)
endif
include $(here)../chain.mk
