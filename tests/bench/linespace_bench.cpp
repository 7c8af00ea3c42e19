// Injection and sampling of the Linespace cache, with the path tracer beside them.
#include "linespace/inject.h"
#include "linespace/sample.h"
#include "render/path_tracer.h"
#include "sampling/seeds.h"

#include <benchmark/benchmark.h>

namespace {

using namespace ql;

const Workers kWorkers(0);

struct Bench {
    Scene scene;
    RenderSpace space;
    PosedScene posed;
    explicit Bench(Scene s)
        : scene(std::move(s)), space(render_space_of(scene, kWorkers)),
          posed(scene, space, 0, kWorkers) {}
};

// A closed box of 1 x 1 x 1 with a light in it.
Scene box() {
    Scene scene;
    Material material;
    material.model = MaterialModel::phong;
    material.base_color = V3f(0.7f, 0.6f, 0.5f);
    scene.materials = {material};
    Mesh mesh;
    for (int i = 0; i < 8; ++i)
        mesh.positions.emplace_back(i & 1, i >> 1 & 1, i >> 2);
    mesh.triangles = {{0, 1, 3}, {0, 3, 2}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                      {2, 3, 7}, {2, 7, 6}, {0, 2, 6}, {0, 6, 4}, {1, 3, 7}, {1, 7, 5}};
    scene.meshes = {mesh};
    scene.lights = {Light()};
    scene.nodes.resize(2);
    scene.nodes[0].meshes = {0};
    scene.nodes[1].light = 0;
    scene.nodes[1].translation = {0.5, 0.9, 0.5};
    return scene;
}

const Bench& closed_box() {
    static const Bench bench(box());
    return bench;
}

InjectConfig injection(uint64_t photons) {
    InjectConfig config;
    config.grid.voxels = {25, 25, 25};
    config.photons = {0, photons};
    config.max_depth = 10;
    return config;
}

void inject_photons(benchmark::State& state) {
    const auto photons = uint64_t(state.range(0));
    double vertices = 0, bytes = 0, measure_seconds = 0;
    for (auto _ : state) {
        Progress progress;
        InjectReport report;
        const LightCache cache =
            inject(closed_box().posed, 1, injection(photons), kWorkers, progress, report);
        state.SetIterationTime(report.seconds_tracing);
        vertices += double(report.photons.vertices);
        bytes = double(cache.memory_bytes()) / double(cache.size());
        measure_seconds += report.seconds_measuring;
    }
    state.counters["vertices/s"] = benchmark::Counter(vertices, benchmark::Counter::kIsRate);
    state.counters["bytes/shaft"] = bytes;
    state.counters["measure_s"] = measure_seconds / double(state.iterations());
}
BENCHMARK(inject_photons)->Arg(1000000)->Unit(benchmark::kMillisecond)->UseManualTime();

PixelCamera camera(int pixels) {
    CameraChoice choice;
    choice.explicit_view = true;
    choice.look_from = {0.5, 0.5, 0.95};
    choice.look_at = {0.5, 0.4, 0};
    choice.fov_degrees = 70;
    return pixel_camera(choose_camera(closed_box().scene, closed_box().space, choice),
                        closed_box().scene, closed_box().space, 0, pixels, pixels);
}

void path_trace(benchmark::State& state) {
    RenderConfig config;
    config.path.max_depth = 10;
    config.spp = 8;
    double vertices = 0;
    for (auto _ : state) {
        Progress progress;
        const RayCounts rays =
            render_frame(closed_box().posed, camera(128), fresh_seeds(0, 0, 128, 128), config,
                         nullptr, kWorkers, progress)
                .rays;
        vertices += double(rays.camera + rays.indirect);
    }
    state.counters["vertices/s"] = benchmark::Counter(vertices, benchmark::Counter::kIsRate);
}
BENCHMARK(path_trace)->Unit(benchmark::kMillisecond)->UseRealTime();

void sample_cache(benchmark::State& state) {
    Progress progress;
    InjectReport report;
    static const LightCache cache =
        inject(closed_box().posed, 1, injection(2000000), kWorkers, progress, report);
    const ReadTable table(cache, closed_box().space, closed_box().posed.lights(), {}, kWorkers);
    SampleConfig config;
    config.read.max_depth = 10;
    config.read.reads = int(state.range(0));
    config.spp = 8;
    double samples = 0;
    for (auto _ : state) {
        sample_frame(closed_box().posed, camera(128), table, nullptr, nullptr,
                     fresh_seeds(0, 0, 128, 128), config, kWorkers, progress);
        samples += 128 * 128 * 8;
    }
    state.counters["samples/s"] = benchmark::Counter(samples, benchmark::Counter::kIsRate);
}
BENCHMARK(sample_cache)->Arg(1)->Arg(4)->Unit(benchmark::kMillisecond)->UseRealTime();

} // namespace
