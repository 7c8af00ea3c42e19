// Masks, retarget textures and the passes between frames, at the sizes that are quoted.
#include "bluenoise/permute.h"
#include "bluenoise/retarget_solve.h"
#include "sampling/random.h"

#include <benchmark/benchmark.h>

namespace {

using namespace ql;

Mask blue_mask(int side) {
    MaskConfig config;
    config.width = config.height = side;
    Progress progress;
    Mask mask{mask_ranks(config, progress), uint32_t(side * side), ""};
    mask.hash = mask_hash(mask.values);
    return mask;
}

RetargetTexture retarget_texture(const Mask& mask, const Imath::V2i& motion) {
    RetargetConfig config;
    config.step = lattice_step(mask.values.width(), mask.values.height());
    config.motion = motion;
    return exact_retarget_texture(mask, config);
}

void mask(benchmark::State& state) {
    for (auto _ : state)
        benchmark::DoNotOptimize(blue_mask(int(state.range(0))));
}
BENCHMARK(mask)->Arg(64)->Arg(256)->Arg(1024)->Unit(benchmark::kMillisecond);

void exact_retarget_texture(benchmark::State& state) {
    const Mask tile = blue_mask(int(state.range(0)));
    for (auto _ : state)
        benchmark::DoNotOptimize(retarget_texture(tile, {0, 0}));
}
BENCHMARK(exact_retarget_texture)->Arg(64)->Arg(128)->Unit(benchmark::kMillisecond);

struct FullHd {
    Mask tile = blue_mask(64);
    PermuteConfig config;
    Array2D<float> intensity{1920, 1080};
    MotionPlanes motion{Array2D<float>(1920, 1080), Array2D<float>(1920, 1080)};
    Workers workers;

    FullHd() {
        config.offsets = mask_offsets(OffsetKind::lattice, 64, 64);
        for (uint32_t i = 0; i < intensity.size(); ++i) {
            intensity[i] = unit_float(hash32(1, i, 0, 0));
            motion.x[i] = float(i % 1920) / 640 - 1.5f;
        }
    }
};

void sort(benchmark::State& state) {
    FullHd hd;
    hd.config.block_px = int(state.range(0));
    const Permuter permuter(hd.tile, {}, hd.config, 1920, 1080);
    Array2D<uint32_t> seeds = permuter.fresh_seeds(0);
    int64_t frame = 0;
    for (auto _ : state)
        permuter.sort(seeds, frame++, {&hd.intensity, nullptr, {}}, hd.workers);
}
BENCHMARK(sort)->Arg(4)->Arg(8)->Arg(16)->Unit(benchmark::kMillisecond)->UseRealTime();

void sort_similar_surfaces(benchmark::State& state) {
    FullHd hd;
    const Permuter permuter(hd.tile, {}, hd.config, 1920, 1080);
    Array2D<uint32_t> seeds = permuter.fresh_seeds(0);
    Array2D<uint32_t> surfaces(1920, 1080);
    for (uint32_t i = 0; i < surfaces.size(); ++i)
        surfaces[i] = i % 1920 / 100;
    int64_t frame = 0;
    for (auto _ : state)
        permuter.sort(seeds, frame++, {&hd.intensity, nullptr, surfaces}, hd.workers);
}
BENCHMARK(sort_similar_surfaces)->Unit(benchmark::kMillisecond)->UseRealTime();

void retarget(benchmark::State& state) {
    FullHd hd;
    hd.config.reproject = ReprojectMode(state.range(0));
    std::vector<RetargetTexture> textures;
    for (int mx = -2; mx <= 2; ++mx)
        textures.push_back(retarget_texture(hd.tile, {mx, 0}));
    const Permuter permuter(hd.tile, textures, hd.config, 1920, 1080);
    Array2D<uint32_t> seeds = permuter.fresh_seeds(0);
    int64_t frame = 0;
    for (auto _ : state)
        seeds = permuter.retargeted(seeds, frame++, {&hd.intensity, &hd.motion, {}}, hd.workers);
}
BENCHMARK(retarget)
    ->ArgName("off_image_tile")
    ->Arg(0)
    ->Arg(1)
    ->Arg(2)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

} // namespace
