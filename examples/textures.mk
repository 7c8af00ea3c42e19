# The mask that experiments share, and its retarget textures. Set QL_BIN and OUT.
MASK = $(OUT)/mask.exr
MOVES = $(OUT)/retarget.exr
# Moves of 2.2 px in the mean instead of 4.7.
SHORT_MOVES = $(OUT)/short.exr
# Textures for 81 motions: of moves of 4.7 px in the mean, and of 1.6.
MOTIONS = $(OUT)/motions.exr
SHORT_MOTIONS = $(OUT)/short-motions.exr

$(OUT):
	mkdir -p $@
$(MASK): | $(OUT)
	$(QL_BIN)/bn-mask --size 64x64 --sigma 1.2 -o $@
$(MOVES): $(MASK)
	$(QL_BIN)/bn-anneal $< -o $@
$(SHORT_MOVES): $(MASK)
	$(QL_BIN)/bn-anneal $< --move-penalty 0.5 -o $@
$(MOTIONS): $(MASK)
	$(QL_BIN)/bn-anneal $< --motions 4 -o $@
$(SHORT_MOTIONS): $(MASK)
	$(QL_BIN)/bn-anneal $< --motions 4 --move-penalty 1 -o $@
