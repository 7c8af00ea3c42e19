# The figures and table 2 of Nilles 2017, section 7, from the tools; the page is thesis.md.
#
#   make -f thesis.mk quick     small images, few samples and photons: about a minute
#   make -f thesis.mk full      Cornell box at 1/16 of the thesis's pixels, Sponza at 1/36
#   make -f thesis.mk full CORNELL_SIZE=1080x1080 SPONZA_SIZE=1920x1080 PHOTONS=1e9 SPONZA_PHOTONS=3e9 LISTING_PHOTONS=1e9
#
# Variables: QL_BIN (folder of the tools; else those on PATH), SPONZA (glTF in metres; without that
# file what needs it is left out), OUT (folder of the results), RUN (put before every tool, such as
# "nice -n 10"), THREADS (of every tool), and the sizes and counts below.
.DELETE_ON_ERROR:
.SECONDARY:

QL_BIN ?= ../../build/release/bin
export PATH := $(abspath $(QL_BIN)):$(PATH)
SPONZA ?= ../../../shared/data/scenes/sponza/sponza.glb
OUT ?= out/thesis
RUN ?=
THREADS ?= 1
# The thesis: 1080x1080 and 1000 samples, 1920x1080 and 100 samples, 10^9 photons a light.
CORNELL_SIZE ?= 270x270
CORNELL_SPP ?= 1000
CORNELL_VOXELS ?= 50x50x50
SPONZA_SIZE ?= 320x180
SPONZA_SPP ?= 100
SPONZA_VOXELS ?= 68x28x42
PHOTONS ?= 20e6
SPONZA_PHOTONS ?= 20e6
LISTING_PHOTONS ?= 20e6
# Of the scenes whose lobes read the cache.
GLOSSY_VOXELS ?= $(CORNELL_VOXELS)
# Four vertices between light and camera.
DEPTH ?= 4
# Of the images enlarged in close-ups.
ZOOM ?= 4
# Table 2: samples of a timed run, and runs of which the median is taken.
SPEED_SPP ?= 64
SPEED_PHOTONS ?= 1e6
RUNS ?= 5
# Caustics against path tracing: radius of the lamp in metres, runs each with a seed of its own.
LAMP ?= 0.01
CHECK_VOXELS ?= 16x16x16
CHECK_PHOTONS ?= 4e6
CHECK_SPP ?= 4096
CHECK_SEEDS ?= 1 2 3 4
# Figure 17: directions drawn from each lobe.
LOBE_SAMPLES ?= 20000
# Estimators, bias and noise.
SQUARE ?= 128x128
SQUARE_SPP ?= 256
REFERENCE_SPP ?= 4096
ESTIMATOR_VOXELS ?= 12 25
ESTIMATOR_PHOTONS ?= 1e6
BIAS_VOXELS ?= 6 12 25 50
BIAS_PATCHES ?= 1 2 4 8
BIAS_PHOTONS ?= 2e6
NOISE_VOXELS ?= 12x12x12
NOISE_PHOTONS ?= 1e4 1e5 1e6 1e7
NOISE_SPP ?= 1024

COMMON = -q -j $(THREADS)
INJECT = $(RUN) ls-inject $(COMMON) --max-depth $(DEPTH)
SAMPLE = $(RUN) ls-sample $(COMMON)
PATHS = $(RUN) bn-render $(COMMON) --max-depth $(DEPTH) --seed 4711
SCENES = ../scenes
MATERIALS = point phong mirror glass
VIEWS ?= nave lion arcade
SPONZA_PARTS = $(SPONZA) $(SCENES)/sponza_lights.gltf
HAVE_SPONZA := $(wildcard $(SPONZA))

FIGURES = figure_12a.png figure_13.png figure_13.csv figure_14a.png figure_14a.csv figure_15.png figure_15.csv \
	figure_16.png figure_16.csv figure_17.csv figure_17.svg figure_17.png figure_18.png caustics.png \
	caustics.csv caustics_summary.csv table_2.csv sizes.csv estimators.csv bias.csv bias.svg bias.png noise.csv noise_slope.csv \
	noise.svg noise.png $(if $(HAVE_SPONZA),figure_12b.png figure_14b.png)

all: full
full: $(FIGURES:%=$(OUT)/%)
quick:
	$(MAKE) -f thesis.mk full OUT=$(OUT)/quick SPONZA= CORNELL_SIZE=72x72 CORNELL_SPP=16 CORNELL_VOXELS=8x8x8 \
		PHOTONS=2e4 LISTING_PHOTONS=5e4 LOBE_SAMPLES=2000 SPEED_SPP=4 SPEED_PHOTONS=1e4 RUNS=1 CHECK_VOXELS=5x5x5 \
		CHECK_PHOTONS=2e4 CHECK_SPP=16 CHECK_DEPTHS=2 CHECK_SEEDS="1 2" SQUARE=32x32 SQUARE_SPP=16 REFERENCE_SPP=128 \
		ESTIMATOR_VOXELS=4 ESTIMATOR_PHOTONS=1e4 BIAS_VOXELS="3 6" BIAS_PATCHES=4 BIAS_PHOTONS=1e4 \
		NOISE_VOXELS=4x4x4 NOISE_PHOTONS="1e3 1e4" NOISE_SPP=16
clean:
	rm -rf $(OUT)
.PHONY: all full quick clean

$(OUT):
	mkdir -p $@

# --- Scenes ---------------------------------------------------------------------------------------
# large-*: ten times as large, as in the thesis, whose estimators depend on the unit of length.
$(OUT)/large-%.gltf: $(SCENES)/cornell_%.gltf variant | $(OUT)
	./variant $< --scale 10 >$@
$(OUT)/lamp-%.gltf: $(SCENES)/cornell_%.gltf variant | $(OUT)
	./variant $< --lamp $(LAMP) >$@
$(OUT)/phong-%.gltf: $(SCENES)/cornell_phong.gltf variant | $(OUT)
	./variant $< --exponent $* >$@
$(OUT)/lights-%.gltf: $(SCENES)/cornell_point.gltf variant | $(OUT)
	./variant $< --scale 10 --lights $* >$@

# --- Caches ---------------------------------------------------------------------------------------
# energy: ours; listing: the thesis's listing 10. Beside each a .json with its times and sizes.
$(OUT)/energy-%.cache.exr $(OUT)/energy-%.json: $(SCENES)/cornell_%.gltf | $(OUT)
	$(INJECT) $< --voxels $(CORNELL_VOXELS) --photons $(PHOTONS) --stats $(OUT)/energy-$*.json -o $(OUT)/energy-$*.cache.exr
$(OUT)/energy-phong_%.cache.exr $(OUT)/energy-phong_%.json: $(OUT)/phong-%.gltf
	$(INJECT) $< --voxels $(GLOSSY_VOXELS) --photons $(PHOTONS) --stats $(OUT)/energy-phong_$*.json \
		-o $(OUT)/energy-phong_$*.cache.exr
$(OUT)/energy-lamp_%.cache.exr: $(OUT)/lamp-%.gltf
	$(INJECT) $< --voxels $(CORNELL_VOXELS) --photons $(PHOTONS) -o $@
$(OUT)/listing-%.cache.exr $(OUT)/listing-%.json: $(OUT)/large-%.gltf
	$(INJECT) $< --voxels $(CORNELL_VOXELS) --photons $(LISTING_PHOTONS) --estimator count-listing \
		--stats $(OUT)/listing-$*.json -o $(OUT)/listing-$*.cache.exr
SPONZA_INJECT = $(INJECT) $(SPONZA_PARTS) --voxels $(SPONZA_VOXELS)
$(OUT)/energy-sponza.cache.exr $(OUT)/energy-sponza.json &: $(SPONZA_PARTS) | $(OUT)
	$(SPONZA_INJECT) --photons $(SPONZA_PHOTONS) --stats $(OUT)/energy-sponza.json -o $(OUT)/energy-sponza.cache.exr
$(OUT)/listing-sponza.cache.exr $(OUT)/listing-sponza.json &: $(SPONZA_PARTS) | $(OUT)
	$(SPONZA_INJECT) --photons $(LISTING_PHOTONS) --estimator count-listing --stats $(OUT)/listing-sponza.json \
		-o $(OUT)/listing-sponza.cache.exr

# --- Images ---------------------------------------------------------------------------------------
# path: path tracing; cache: ours as it comes; listing, fallback: the thesis's, with its blur, and
# with path tracing where a shaft is empty.
CORNELL = --size $(CORNELL_SIZE) --spp $(CORNELL_SPP)
SPONZA_VIEW = --size $(SPONZA_SIZE) --spp $(SPONZA_SPP) --all-lights
LISTING = --blur $(BLUR)
FALLBACK = --blur $(BLUR) --fallback trace
BLUR = 0.07
BLUR_SPONZA = 0.15
PATH_LAYERS = --aov direct,indirect,variance
CACHE_LAYERS = --layers direct,indirect,caustic,variance
$(OUT)/path-%.exr: $(SCENES)/cornell_%.gltf | $(OUT)
	$(PATHS) $< $(CORNELL) $(PATH_LAYERS) -o $@
$(OUT)/path-phong_%.exr: $(OUT)/phong-%.gltf
	$(PATHS) $< $(CORNELL) $(PATH_LAYERS) -o $@
$(OUT)/path-lamp_%.exr: $(OUT)/lamp-%.gltf
	$(PATHS) $< $(CORNELL) $(PATH_LAYERS) -o $@
$(OUT)/cache-%.exr: $(SCENES)/cornell_%.gltf $(OUT)/energy-%.cache.exr
	$(SAMPLE) $< --cache $(OUT)/energy-$*.cache.exr $(CORNELL) $(CACHE_LAYERS) -o $@
$(OUT)/cache-lamp_%.exr: $(OUT)/lamp-%.gltf $(OUT)/energy-lamp_%.cache.exr
	$(SAMPLE) $< --cache $(OUT)/energy-lamp_$*.cache.exr $(CORNELL) $(CACHE_LAYERS) -o $@
$(OUT)/cache-phong_%.exr: $(OUT)/phong-%.gltf $(OUT)/energy-phong_%.cache.exr
	$(SAMPLE) $< --cache $(OUT)/energy-phong_$*.cache.exr $(CORNELL) $(CACHE_LAYERS) -o $@
$(OUT)/listing-%.exr: $(OUT)/large-%.gltf $(OUT)/listing-%.cache.exr
	$(SAMPLE) $< --cache $(OUT)/listing-$*.cache.exr $(CORNELL) $(LISTING) $(CACHE_LAYERS) -o $@
$(OUT)/fallback-%.exr: $(OUT)/large-%.gltf $(OUT)/listing-%.cache.exr
	$(SAMPLE) $< --cache $(OUT)/listing-$*.cache.exr $(CORNELL) $(FALLBACK) $(CACHE_LAYERS) -o $@
# view-*: the same in Sponza.
$(VIEWS:%=$(OUT)/view-path-%.exr): $(OUT)/view-path-%.exr: $(SPONZA_PARTS) | $(OUT)
	$(PATHS) $(SPONZA_PARTS) --camera $* $(SPONZA_VIEW) $(PATH_LAYERS) -o $@
$(VIEWS:%=$(OUT)/view-cache-%.exr): $(OUT)/view-cache-%.exr: $(OUT)/energy-sponza.cache.exr
	$(SAMPLE) $(SPONZA_PARTS) --camera $* --cache $< $(SPONZA_VIEW) $(CACHE_LAYERS) -o $@
$(VIEWS:%=$(OUT)/view-listing-%.exr) $(VIEWS:%=$(OUT)/view-fallback-%.exr): BLUR = $(BLUR_SPONZA)
$(VIEWS:%=$(OUT)/view-listing-%.exr): $(OUT)/view-listing-%.exr: $(OUT)/listing-sponza.cache.exr
	$(SAMPLE) $(SPONZA_PARTS) --camera $* --cache $< $(SPONZA_VIEW) $(LISTING) $(CACHE_LAYERS) -o $@
$(VIEWS:%=$(OUT)/view-fallback-%.exr): $(OUT)/view-fallback-%.exr: $(OUT)/listing-sponza.cache.exr
	$(SAMPLE) $(SPONZA_PARTS) --camera $* --cache $< $(SPONZA_VIEW) $(FALLBACK) $(CACHE_LAYERS) -o $@

# --- Figures 12 and 13 ----------------------------------------------------------------------------
CORNELL_GAIN = 2
SPONZA_GAIN = 4
$(OUT)/figure_12a.png: sheet $(foreach k,cache path,$(MATERIALS:%=$(OUT)/$(k)-%.exr))
	./sheet $@ 4x2 --gain $(CORNELL_GAIN) $(filter %.exr,$^)
$(OUT)/figure_12b.png: sheet $(foreach k,cache path,$(VIEWS:%=$(OUT)/view-$(k)-%.exr))
	./sheet $@ $(words $(VIEWS))x2 --gain $(SPONZA_GAIN) $(filter %.exr,$^)
$(OUT)/error-%.png: $(OUT)/cache-%.exr $(OUT)/path-%.exr
	img-diff -q $^ --heatmap $@ >$(OUT)/error-$*.txt
$(VIEWS:%=$(OUT)/view-error-%.png): $(OUT)/view-error-%.png: $(OUT)/view-cache-%.exr $(OUT)/view-path-%.exr
	img-diff -q $^ --heatmap $@ >$(OUT)/view-error-$*.txt
$(OUT)/figure_13.png: sheet $(MATERIALS:%=$(OUT)/error-%.png)
	./sheet $@ 4x1 $(filter %.png,$^)
CORNELL_PAIRS = $(foreach m,$(MATERIALS),$(OUT)/cache-$(m).exr $(OUT)/path-$(m).exr)
SPONZA_PAIRS = $(if $(HAVE_SPONZA),$(foreach v,$(VIEWS),$(OUT)/view-cache-$(v).exr $(OUT)/view-path-$(v).exr))
$(OUT)/figure_13.csv: figures $(CORNELL_PAIRS) $(SPONZA_PAIRS)
	(./figures header scene $(foreach m,$(MATERIALS),&& ./figures "cornell $(m)" $(OUT)/cache-$(m).exr $(OUT)/path-$(m).exr) \
		$(if $(HAVE_SPONZA),$(foreach v,$(VIEWS),&& ./figures "sponza $(v)" $(OUT)/view-cache-$(v).exr \
		$(OUT)/view-path-$(v).exr))) >$@

# --- Figures 14, 15, 16, 18: close-ups ------------------------------------------------------------
# Rectangles in percent of the image.
EDGE = 46,72,34,24
WINDOW = 49,12,17,24
BACK_BLOCK = 24,40,30,48
BACK_WALL = 35,22,40,20
RIGHT_SIDE = 30,42,24,46
crop = --crop $$(./window $(CORNELL_SIZE) $(1))
$(OUT)/figure_14a.png: sheet window $(foreach k,path cache listing fallback,$(OUT)/$(k)-point.exr)
	./sheet $@ 4x1 --gain $(CORNELL_GAIN) $(call crop,$(EDGE)) --zoom $(ZOOM) $(filter %.exr,$^)
$(OUT)/figure_14a.csv: figures window $(foreach k,path cache listing fallback,$(OUT)/$(k)-point.exr)
	(./figures header method $(foreach k,cache listing fallback,\
		&& ./figures $(k) $(OUT)/$(k)-point.exr $(OUT)/path-point.exr $(call crop,$(EDGE)))) >$@
$(OUT)/figure_14b.png: sheet window $(foreach k,path cache listing fallback,$(OUT)/view-$(k)-arcade.exr)
	./sheet $@ 4x1 --gain $(SPONZA_GAIN) --crop $$(./window $(SPONZA_SIZE) $(WINDOW)) --zoom $(ZOOM) $(filter %.exr,$^)
$(OUT)/figure_15.png: sheet window $(OUT)/path-phong.exr $(OUT)/cache-phong.exr
	./sheet $@ 2x1 --gain $(CORNELL_GAIN) $(call crop,$(BACK_BLOCK)) --zoom $(ZOOM) $(filter %.exr,$^)
# Variance of the mean there, cache over path tracing: mean_ratio.
$(OUT)/figure_15.csv: window $(OUT)/cache-phong.exr $(OUT)/path-phong.exr
	img-diff -q --layer variance $(call crop,$(BACK_BLOCK)) $(filter %.exr,$^) --csv >$@
# glossy: the block reads the cache, too, by the shafts around that of the direction.
EXPONENTS = 2 5 10
$(OUT)/glossy-%.exr: $(OUT)/phong-%.gltf $(OUT)/energy-phong_%.cache.exr
	$(SAMPLE) $< --cache $(OUT)/energy-phong_$*.cache.exr --glossy 1000 1000 --smoothing 1 $(CORNELL) $(CACHE_LAYERS) -o $@
GLOSSY = glossy- cache-phong_ path-phong_
$(OUT)/figure_16.png: sheet window $(foreach k,$(GLOSSY),$(EXPONENTS:%=$(OUT)/$(k)%.exr))
	./sheet $@ 3x3 --gain $(CORNELL_GAIN) $(call crop,$(BACK_BLOCK)) --zoom $(ZOOM) $(filter %.exr,$^)
$(OUT)/figure_16.csv: figures window $(foreach k,$(GLOSSY),$(EXPONENTS:%=$(OUT)/$(k)%.exr))
	(./figures header exponent,lobe $(foreach n,$(EXPONENTS),\
		&& ./figures $(n),read $(OUT)/glossy-$(n).exr $(OUT)/path-phong_$(n).exr $(call crop,$(BACK_BLOCK)) \
		&& ./figures $(n),traced $(OUT)/cache-phong_$(n).exr $(OUT)/path-phong_$(n).exr $(call crop,$(BACK_BLOCK)))) >$@
$(OUT)/figure_17.csv: lobes | $(OUT)
	./lobes 4 $(LOBE_SAMPLES) $(EXPONENTS) 40 >$@
$(OUT)/figure_17.svg: lobes.gp $(OUT)/figure_17.csv
	gnuplot -e "table='$(OUT)/figure_17.csv'; set terminal svg size 900,420; set output '$@'" $<
$(OUT)/figure_17.png: lobes.gp $(OUT)/figure_17.csv
	gnuplot -e "table='$(OUT)/figure_17.csv'; set terminal pngcairo size 900,420; set output '$@'" $<
# Rows: single shafts as they are, with the disc of the thesis, and as it comes; then the thesis's
# estimator without and with the disc.
GRIDS = plain blurred default listing_plain listing_blurred
GRID_plain = --smoothing 0
GRID_blurred = --smoothing 0 --blur 0.007
$(OUT)/grid-plain.exr $(OUT)/grid-blurred.exr: $(OUT)/grid-%.exr: $(OUT)/energy-point.cache.exr
	$(SAMPLE) $(SCENES)/cornell_point.gltf --cache $< $(GRID_$*) $(CORNELL) $(CACHE_LAYERS) -o $@
$(OUT)/grid-default.exr: $(OUT)/cache-point.exr
	ln -f $< $@
$(OUT)/grid-listing_plain.exr: $(OUT)/large-point.gltf $(OUT)/listing-point.cache.exr
	$(SAMPLE) $< --cache $(OUT)/listing-point.cache.exr $(CORNELL) $(CACHE_LAYERS) -o $@
$(OUT)/grid-listing_blurred.exr: $(OUT)/listing-point.exr
	ln -f $< $@
grid_row = ./sheet $(OUT)/grid-$(1)-$(2).png 5x1 --layer indirect --gain 6 $(3) $(GRIDS:%=$(OUT)/grid-%.exr)
$(OUT)/figure_18.png: sheet window $(GRIDS:%=$(OUT)/grid-%.exr)
	$(call grid_row,whole,1)
	$(call grid_row,wall,2,$(call crop,$(BACK_WALL)) --zoom 2)
	$(call grid_row,side,3,$(call crop,$(RIGHT_SIDE)) --zoom 4)
	oiiotool $(OUT)/grid-whole-1.png $(OUT)/grid-wall-2.png $(OUT)/grid-side-3.png --mosaic:pad=2:fit=1 1x3 -d uint8 -o $@

# --- Caustics -------------------------------------------------------------------------------------
# A view of nothing but the part of the ceiling on which the top of the back block throws the light,
# from right above that block. Path tracing finds the caustic of a small lamp, not of a point light.
CEILING = --look-from 0.42,0.345,0.40 --look-at 0.42,0.5488,0.42 --fov 40 --size 32x32 --spp $(CHECK_SPP)
BLOCKS = mirror glass
# At depth 2 the caustic is all that the lamp adds; at more it lights other surfaces in turn.
CHECK_DEPTHS ?= 2 4
LIGHT_lamp = $(OUT)/lamp-%.gltf
LIGHT_point = $(SCENES)/cornell_%.gltf
# Rules for one light, depth and seed.
define check_rules
$(OUT)/check-path-$(1)-%-$(2)-$(3).exr: $(LIGHT_$(1)) | $(OUT)
	$(RUN) bn-render $(COMMON) $$< $(CEILING) --max-depth $(2) --aov direct,indirect --seed $(3) -o $$@
$(OUT)/check-$(1)-%-$(2)-$(3).cache.exr: $(LIGHT_$(1)) | $(OUT)
	$(RUN) ls-inject $(COMMON) $$< --max-depth $(2) --voxels $(CHECK_VOXELS) --photons $(CHECK_PHOTONS) --seed $(3) -o $$@
$(OUT)/check-cache-$(1)-%-$(2)-$(3).exr: $(LIGHT_$(1)) $(OUT)/check-$(1)-%-$(2)-$(3).cache.exr
	$(SAMPLE) $$< --cache $(OUT)/check-$(1)-$$*-$(2)-$(3).cache.exr $(CEILING) --layers indirect,caustic --seed $(3) -o $$@
endef
$(foreach l,lamp point,$(foreach d,$(CHECK_DEPTHS),$(foreach s,$(CHECK_SEEDS),$(eval $(call check_rules,$(l),$(d),$(s))))))
CHECKS = path-lamp path-point cache-lamp cache-point
CHECKED = $(foreach c,$(CHECKS),$(foreach b,$(BLOCKS),$(foreach d,$(CHECK_DEPTHS),\
	$(foreach s,$(CHECK_SEEDS),$(c)-$(b)-$(d)-$(s)))))
comma = ,
$(OUT)/caustics.csv: means $(CHECKED:%=$(OUT)/check-%.exr)
	./means $(filter %.exr,$^) >$@
$(OUT)/caustics_summary.csv: ratios $(OUT)/caustics.csv
	./ratios $(OUT)/caustics.csv >$@
# Rows: the blocks. Columns: small lamp, path tracing and cache; point light, path tracing and cache.
SEEN = path-lamp_ cache-lamp_ path- cache-
$(OUT)/caustics.png: sheet window $(foreach b,$(BLOCKS),$(foreach k,$(SEEN),$(OUT)/$(k)$(b).exr))
	./sheet $@ 4x2 --layer indirect --gain 3 $(call crop,0$(comma)0$(comma)100$(comma)40) $(filter %.exr,$^)

# --- Table 2 --------------------------------------------------------------------------------------
export RUNS
SPEED_INJECT = --photons $(SPEED_PHOTONS) --estimator count-listing
SPEED_CORNELL = --size $(CORNELL_SIZE) --spp $(SPEED_SPP)
SPEED_SPONZA = --size $(SPONZA_SIZE) --spp $(SPEED_SPP) --all-lights
NAME_point = cornell diffuse
NAME_phong = cornell phong
NAME_mirror = cornell mirror
NAME_glass = cornell glass
NAME_nave = sponza 1
NAME_lion = sponza 2
NAME_arcade = sponza 3
$(MATERIALS:%=$(OUT)/speed-%.csv): $(OUT)/speed-%.csv: speed ../number $(OUT)/large-%.gltf \
    $(OUT)/energy-%.cache.exr $(OUT)/listing-%.cache.exr
	./speed "$(NAME_$*)" "$(PATHS) $(SCENES)/cornell_$*.gltf $(SPEED_CORNELL)" \
		"$(SAMPLE) $(SCENES)/cornell_$*.gltf --cache $(OUT)/energy-$*.cache.exr $(SPEED_CORNELL)" \
		"$(SAMPLE) $(OUT)/large-$*.gltf --cache $(OUT)/listing-$*.cache.exr $(SPEED_CORNELL) $(LISTING)" \
		"$(SAMPLE) $(OUT)/large-$*.gltf --cache $(OUT)/listing-$*.cache.exr $(SPEED_CORNELL) $(FALLBACK)" \
		"$(INJECT) $(OUT)/large-$*.gltf --voxels $(CORNELL_VOXELS) $(SPEED_INJECT)" >$@
$(VIEWS:%=$(OUT)/speed-%.csv): BLUR = $(BLUR_SPONZA)
$(VIEWS:%=$(OUT)/speed-%.csv): $(OUT)/speed-%.csv: speed ../number $(OUT)/energy-sponza.cache.exr \
    $(OUT)/listing-sponza.cache.exr
	./speed "$(NAME_$*)" "$(PATHS) $(SPONZA_PARTS) --camera $* $(SPEED_SPONZA)" \
		"$(SAMPLE) $(SPONZA_PARTS) --camera $* --cache $(OUT)/energy-sponza.cache.exr $(SPEED_SPONZA)" \
		"$(SAMPLE) $(SPONZA_PARTS) --camera $* --cache $(OUT)/listing-sponza.cache.exr $(SPEED_SPONZA) $(LISTING)" \
		"$(SAMPLE) $(SPONZA_PARTS) --camera $* --cache $(OUT)/listing-sponza.cache.exr $(SPEED_SPONZA) $(FALLBACK)" \
		"$(SPONZA_INJECT) $(SPEED_INJECT)" >$@
TIMED = $(MATERIALS) $(if $(HAVE_SPONZA),$(VIEWS))
$(OUT)/speeds.csv: $(TIMED:%=$(OUT)/speed-%.csv)
	(echo scene,path,cache,listing,fallback,inject && cat $^) >$@
$(OUT)/table_2.csv: compare thesis_table_2.csv $(OUT)/speeds.csv
	./compare $(OUT)/speeds.csv >$@
SIZED = $(foreach s,$(MATERIALS) $(if $(HAVE_SPONZA),sponza),energy-$(s) listing-$(s))
$(OUT)/sizes.csv: size ../number $(SIZED:%=$(OUT)/%.cache.exr) $(SIZED:%=$(OUT)/%.json)
	(./size header estimator,scene $(foreach s,$(SIZED),\
		&& ./size $(subst -,$(comma),$(s)) $(OUT)/$(s).cache.exr $(OUT)/$(s).json 4)) >$@

# --- Estimators, bias and noise -------------------------------------------------------------------
export INJECT SAMPLE
VIEW = --size $(SQUARE) --spp $(SQUARE_SPP)
$(OUT)/reference-%.exr: $(OUT)/lights-%.gltf
	$(PATHS) $< --size $(SQUARE) --spp $(REFERENCE_SPP) --aov direct,indirect -o $@
$(OUT)/reference-point.exr: $(SCENES)/cornell_point.gltf | $(OUT)
	$(PATHS) $< --size $(SQUARE) --spp $(REFERENCE_SPP) --aov direct,indirect -o $@
# One to three lights in a box of 5.5 m, and one in a box of 0.55 m.
LIT = 1 2 3 point
SCENE_1 = $(OUT)/lights-1.gltf
SCENE_2 = $(OUT)/lights-2.gltf
SCENE_3 = $(OUT)/lights-3.gltf
SCENE_point = $(SCENES)/cornell_point.gltf
LABEL_1 = 5.5,1
LABEL_2 = 5.5,2
LABEL_3 = 5.5,3
LABEL_point = 0.55,1
ESTIMATORS = energy count-text count-listing
define estimator_rules
$(OUT)/estimator-$(1)-%.csv: cached figures ../number $(OUT)/reference-$(1).exr
	(true $(foreach e,$(ESTIMATORS),&& ./cached "$(LABEL_$(1)),$(e),$$*" $(OUT)/reference-$(1).exr $(SCENE_$(1)) \
		"--voxels $$*x$$*x$$* --photons $(ESTIMATOR_PHOTONS) --estimator $(e)" "$(VIEW)")) >$$@
endef
$(foreach l,$(LIT),$(eval $(call estimator_rules,$(l))))
$(OUT)/estimators.csv: cached $(foreach l,$(LIT),$(ESTIMATOR_VOXELS:%=$(OUT)/estimator-$(l)-%.csv))
	(./cached header box_m,lights,estimator,voxels && cat $(filter %.csv,$^)) >$@

# Bias falls as voxels and patches grow.
$(OUT)/reference-other.exr: $(SCENE_point) | $(OUT)
	$(RUN) bn-render $(COMMON) --max-depth $(DEPTH) --seed 4712 $< --size $(SQUARE) --spp $(REFERENCE_SPP) \
		--aov direct,indirect -o $@
$(OUT)/bias-%.csv: export SMOOTHINGS = 0 1000
$(OUT)/bias-%.csv: bias ../number $(OUT)/reference-point.exr $(OUT)/reference-other.exr
	(true $(foreach n,$(BIAS_PATCHES),&& ./bias "$*,$(n)" $(OUT)/reference-point.exr $(OUT)/reference-other.exr \
		$(SCENE_point) "--voxels $*x$*x$* --patches $(n) --photons $(BIAS_PHOTONS)" "$(VIEW)")) >$@
$(OUT)/bias.csv: $(BIAS_VOXELS:%=$(OUT)/bias-%.csv)
	(./bias header voxels,patches && cat $^) >$@

# Noise falls as photons grow: two caches of other seeds, read by the very same paths, so that their
# images differ by the light of the photons alone. That light is a mean over independent photons: the
# rms of the difference falls as the root of their number, and is 2^(1/2) times the error of one.
$(OUT)/noise-%-1.cache.exr $(OUT)/noise-%-2.cache.exr: | $(OUT)
	$(INJECT) $(SCENE_point) --voxels $(NOISE_VOXELS) --photons $* --seed 1 -o $(OUT)/noise-$*-1.cache.exr
	$(INJECT) $(SCENE_point) --voxels $(NOISE_VOXELS) --photons $* --seed 2 -o $(OUT)/noise-$*-2.cache.exr
NOISE_VIEW = --size $(SQUARE) --spp $(NOISE_SPP) --layers indirect
$(OUT)/noise-%.csv: noise $(OUT)/noise-%-1.cache.exr $(OUT)/noise-%-2.cache.exr
	(true $(foreach k,0 1000,&& ./noise "$*,$(k)" $(OUT)/noise-$*-1.cache.exr $(OUT)/noise-$*-2.cache.exr \
		$(SCENE_point) $(NOISE_VIEW) --smoothing $(k))) >$@
$(OUT)/noise.csv: $(NOISE_PHOTONS:%=$(OUT)/noise-%.csv)
	(echo photons,smoothing,difference_rms,relmse && cat $^) >$@
$(OUT)/noise_slope.csv: $(OUT)/noise.csv
	awk -F, 'NR > 1 { x = log($$1); y = log($$3); n[$$2]++; sx[$$2] += x; sy[$$2] += y; sxx[$$2] += x * x; \
		sxy[$$2] += x * y } END { print "smoothing,slope"; for (k in n) printf "%s,%.3f\n", k, \
		(n[k] * sxy[k] - sx[k] * sy[k]) / (n[k] * sxx[k] - sx[k] * sx[k]) }' $< >$@

$(OUT)/%.svg: %.gp $(OUT)/%.csv
	gnuplot -e "table='$(OUT)/$*.csv'; set terminal svg size 900,420; set output '$@'" $<
$(OUT)/%.png: %.gp $(OUT)/%.csv
	gnuplot -e "table='$(OUT)/$*.csv'; set terminal pngcairo size 900,420; set output '$@'" $<
