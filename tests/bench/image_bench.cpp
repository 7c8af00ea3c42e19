// Speed of the passes over whole images: reading and writing, error figures, spectra.
#include "image/image_file.h"
#include "metrics/error.h"
#include "metrics/mask_quality.h"
#include "metrics/spectrum.h"

#include <benchmark/benchmark.h>

#include <filesystem>
#include <random>

namespace ql {
namespace {

Array2D<float> noise(int width, int height) {
    Array2D<float> image(width, height);
    std::mt19937 random(1);
    std::uniform_real_distribution<float> uniform;
    for (float& value : image.values())
        value = uniform(random);
    return image;
}

Image color_image(int width, int height) {
    Image image(width, height);
    for (const char* name : {"R", "G", "B"})
        image.plane(name) = noise(width, height);
    return image;
}

void set_pixels(benchmark::State& state, int64_t pixels) {
    state.counters["Mpixel/s"] =
        benchmark::Counter(double(pixels * state.iterations()) * 1e-6, benchmark::Counter::kIsRate);
}

// The limit of every pass: read two planes and write one.
void copy_in_memory(benchmark::State& state) {
    const auto a = noise(1920, 1080), b = noise(1920, 1080);
    Array2D<float> difference(1920, 1080);
    for (auto _ : state) {
        for (size_t i = 0; i < a.size(); ++i)
            difference[i] = a[i] - b[i];
        benchmark::DoNotOptimize(difference.values().data());
    }
    set_pixels(state, 1920 * 1080);
}
BENCHMARK(copy_in_memory)->Unit(benchmark::kMillisecond);

void write_exr(benchmark::State& state) {
    const Image image = color_image(1920, 1080);
    set_image_threads(int(state.range(0)));
    for (auto _ : state)
        write_image("/dev/null", image, {.format = FileFormat::exr});
    set_pixels(state, 1920 * 1080);
}
BENCHMARK(write_exr)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();

void read_exr(benchmark::State& state) {
    const std::string path = std::filesystem::temp_directory_path() / "quietlight_bench.exr";
    write_image(path, color_image(1920, 1080));
    set_image_threads(int(state.range(0)));
    for (auto _ : state)
        benchmark::DoNotOptimize(read_image(path));
    std::filesystem::remove(path);
    set_pixels(state, 1920 * 1080);
}
BENCHMARK(read_exr)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();

void error_figures_of_three_channels(benchmark::State& state) {
    const Workers workers(int(state.range(0)));
    const Image image = color_image(1920, 1080);
    const auto reference = noise(1920, 1080);
    std::vector<ChannelPair> pairs;
    for (const auto& plane : image.planes)
        pairs.push_back({&plane.pixels, &reference});
    for (auto _ : state)
        benchmark::DoNotOptimize(error_figures(pairs, {}, workers));
    set_pixels(state, 1920 * 1080);
}
BENCHMARK(error_figures_of_three_channels)
    ->Arg(1)
    ->Arg(2)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

void spectrum(benchmark::State& state) {
    const Workers workers(int(state.range(2)));
    const auto image = noise(int(state.range(0)), int(state.range(1)));
    for (auto _ : state)
        benchmark::DoNotOptimize(mean_spectrum(std::span(&image, 1), Window::none, workers));
    set_pixels(state, int64_t(image.size()));
}
BENCHMARK(spectrum)
    ->Args({1024, 1024, 1})
    ->Args({1024, 1024, 2})
    ->Args({1920, 1080, 2})
    ->Args({1021, 1021, 2})
    ->Args({2039, 2039, 2})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

void heaviside_table_of_a_mask(benchmark::State& state) {
    const Workers workers(2);
    const auto ranks = rank_values(noise(int(state.range(0)), int(state.range(0))));
    for (auto _ : state)
        benchmark::DoNotOptimize(heaviside_table(ranks, workers));
}
BENCHMARK(heaviside_table_of_a_mask)
    ->Arg(128)
    ->Arg(512)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

} // namespace
} // namespace ql
