// Nanoseconds per call of what a path does at each vertex beside tracing rays.
#include "sampling/discrete.h"
#include "sampling/random.h"
#include "shading/material.h"

#include <benchmark/benchmark.h>

namespace ql {
namespace {

constexpr size_t kInputs = 1024;

struct Inputs {
    std::vector<V3f> wo, wi;
    std::vector<RandomFloats> u;
    Inputs() {
        for (size_t i = 0; i < kInputs; ++i) {
            u.push_back(CounterRandom(1, i).block(0));
            wo.push_back(square_to_cosine_hemisphere({u[i][0], u[i][1]}));
            wi.push_back(square_to_cosine_hemisphere({u[i][2], u[i][3]}));
        }
    }
};

Bsdf coated() {
    Bsdf b;
    b.lobes = kLobeDiffuse | kLobeMicrofacet;
    b.diffuse = V3f(0.5f);
    b.alpha = 0.25f;
    return b;
}

Bsdf lambert() {
    Bsdf b;
    b.diffuse = V3f(0.5f);
    return b;
}

template<uint32_t Lobes, Bsdf (*Make)()>
void sample(benchmark::State& state) {
    const Bsdf bsdf = Make();
    const Inputs in;
    size_t i = 0;
    for (auto _ : state) {
        benchmark::DoNotOptimize(
            sample_bsdf<Lobes>(bsdf, in.wo[i], in.u[i][0], {in.u[i][1], in.u[i][2]}));
        i = (i + 1) % kInputs;
    }
}

template<uint32_t Lobes, Bsdf (*Make)()>
void value_and_pdf(benchmark::State& state) {
    const Bsdf bsdf = Make();
    const Inputs in;
    size_t i = 0;
    for (auto _ : state) {
        benchmark::DoNotOptimize(value_and_pdf_bsdf<Lobes>(bsdf, in.wo[i], in.wi[i]));
        i = (i + 1) % kInputs;
    }
}

constexpr uint32_t kOpaque = kLobeDiffuse | kLobeMicrofacet;

BENCHMARK_TEMPLATE(sample, kLobeDiffuse, lambert);
BENCHMARK_TEMPLATE(sample, kOpaque, lambert);
BENCHMARK_TEMPLATE(sample, kOpaque, coated);
BENCHMARK_TEMPLATE(sample, kAllLobes, lambert);
BENCHMARK_TEMPLATE(sample, kAllLobes, coated);
BENCHMARK_TEMPLATE(value_and_pdf, kLobeDiffuse, lambert);
BENCHMARK_TEMPLATE(value_and_pdf, kOpaque, coated);
BENCHMARK_TEMPLATE(value_and_pdf, kAllLobes, lambert);
BENCHMARK_TEMPLATE(value_and_pdf, kAllLobes, coated);

void philox_block(benchmark::State& state) {
    uint32_t i = 0;
    for (auto _ : state)
        benchmark::DoNotOptimize(PixelRandom(i++, 3).block(5));
}
BENCHMARK(philox_block);

void frame(benchmark::State& state) {
    const Inputs in;
    size_t i = 0;
    for (auto _ : state) {
        benchmark::DoNotOptimize(frame_from_normal(in.wo[i]).world_from_local(in.wi[i]));
        i = (i + 1) % kInputs;
    }
}
BENCHMARK(frame);

void alias_table(benchmark::State& state) {
    const AliasTable table(std::vector<double>(1000, 1.0));
    const Inputs in;
    size_t i = 0;
    for (auto _ : state) {
        benchmark::DoNotOptimize(table.sample(in.u[i][0]));
        i = (i + 1) % kInputs;
    }
}
BENCHMARK(alias_table);

template<bool Textured>
void material(benchmark::State& state) {
    Material m;
    m.metallic = 0;
    if (Textured) m.base_color_texture.texture = 0;
    m.base_color_texture.transfer = Transfer::srgb;
    std::vector<Texture> textures(1);
    textures[0].width = textures[0].height = 256;
    textures[0].texels.assign(256 * 256 * 4, 128);
    const Inputs in;
    size_t i = 0;
    for (auto _ : state) {
        SurfaceInput input;
        input.uv[0] = {in.u[i][0], in.u[i][1]};
        benchmark::DoNotOptimize(bsdf_at(textures, m, input));
        i = (i + 1) % kInputs;
    }
}
BENCHMARK_TEMPLATE(material, false);
BENCHMARK_TEMPLATE(material, true);

} // namespace
} // namespace ql
