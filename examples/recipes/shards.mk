# A Linespace cache by shards: make -f shards.mk -j"$(nproc)" SCENE=FILE
#   check     compares the cache with that of one run over all photons
.DELETE_ON_ERROR:
.SECONDARY:

QL_BIN ?= $(dir $(lastword $(MAKEFILE_LIST)))../../build/release/bin
SCENE ?= $(dir $(lastword $(MAKEFILE_LIST)))../scenes/cornell_point.gltf
OUT ?= out
PHOTONS ?= 4000000
SHARDS ?= 8
# What all shards must agree in.
OPTIONS ?= --voxels 25x25x25

shards := $(shell seq 0 $$(($(SHARDS) - 1)))
first = $$(($(1) * $(PHOTONS) / $(SHARDS)))

all: $(OUT)/cache.exr
check: $(OUT)/cache.exr $(OUT)/whole.exr
	cmp $^
.PHONY: all check

$(OUT):
	mkdir -p $@
# Changes when one of these does, and all that follows from it is made anew.
SETTINGS = $(SCENE) $(PHOTONS) $(SHARDS) $(OPTIONS)
$(OUT)/settings: FORCE | $(OUT)
	@echo '$(SETTINGS)' | cmp -s - $@ || echo '$(SETTINGS)' >$@
FORCE:
# One thread each: make runs as many at a time as there are cores.
$(OUT)/shard-%.exr: $(SCENE) $(OUT)/settings
	$(QL_BIN)/ls-inject $< $(OPTIONS) --photons $(call first,$*):$(call first,($* + 1)) -j 1 -o $@
$(OUT)/cache.exr: $(shards:%=$(OUT)/shard-%.exr)
	$(QL_BIN)/ls-merge $^ -o $@
$(OUT)/whole.exr: $(SCENE) $(OUT)/settings
	$(QL_BIN)/ls-inject $< $(OPTIONS) --photons $(PHOTONS) -o $@
