// How much longer path tracing takes than Embree alone on the very same rays.
//     path_bench [SCENE.gltf ...]    files together make one scene; default: a Cornell box in code
// Renders 512 x 512 pixels, one sample, depth 5, on one thread, records every ray in its order, and
// asks bare Embree the same again. Medians of five; the ratio is what counts.
#include "reference/scene_builder.h"
#include "render/frame_tiles.h"
#include "sampling/seeds.h"
#include "scene/gltf_load.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>

namespace {

using namespace ql;

constexpr int kSide = 512;
constexpr int kRuns = 5;

struct RecordedRay {
    Ray ray;
    bool shadow;
};

struct Recorder {
    std::vector<RecordedRay> rays;
    void on_nearest(const Ray& ray, int) { rays.push_back({ray, false}); }
    void on_shadow(const Ray& ray) { rays.push_back({ray, true}); }
};

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

template<class Work>
double median_seconds(const Work& work) {
    std::vector<double> seconds;
    for (int run = 0; run < kRuns; ++run) {
        const auto start = std::chrono::steady_clock::now();
        work();
        seconds.push_back(seconds_since(start));
    }
    std::sort(seconds.begin(), seconds.end());
    return seconds[kRuns / 2];
}

// In the order in which the renderer goes through pixels: tile by tile.
template<uint32_t Lobes>
void record(const PathContext& context, const PixelCamera& camera, const Array2D<uint32_t>& seeds,
            Recorder& recorder) {
    const PathKernel<Lobes, Recorder> kernel(context, recorder);
    for (int ty = 0; ty < kSide; ty += kTileSize)
        for (int tx = 0; tx < kSide; tx += kTileSize)
            for (int y = ty; y < ty + kTileSize; ++y)
                for (int x = tx; x < tx + kTileSize; ++x) {
                    const PixelRandom random(seeds(x, y), 0);
                    const RandomWords words = random.words(0);
                    const Ray ray = camera.ray(x + double(unit_float(words[0])),
                                               y + double(unit_float(words[1])));
                    kernel.trace(ray, random, words[2], nullptr);
                }
}

void trace_bare(const EmbreeScene& scene, const std::vector<RecordedRay>& rays) {
    Hit hit;
    for (const RecordedRay& r : rays)
        if (r.shadow)
            scene.is_occluded(r.ray, 0);
        else
            scene.intersect(r.ray, 0, hit);
}

void measure(const std::string& name, const Scene& scene, const ChosenCamera& chosen,
             const RenderSpace& space, const Workers& one) {
    Progress progress;
    const PosedScene posed(scene, space, 0, one);
    const PixelCamera camera = pixel_camera(chosen, scene, space, 0, kSide, kSide);
    const Array2D<uint32_t> seeds = fresh_seeds(0, 0, kSide, kSide);
    RenderConfig config;
    FrameResult frame;
    const double render_seconds = median_seconds(
        [&] { frame = render_frame(posed, camera, seeds, config, nullptr, one, progress); });

    const KernelChoice choice = choose_kernel(scene);
    const PathContext context{posed.rays(), posed.lights(), config.path, has_emission(scene)};
    Recorder recorder;
    if (choice.lobes == kLobeDiffuse)
        record<kLobeDiffuse>(context, camera, seeds, recorder);
    else
        record<kAllLobes>(context, camera, seeds, recorder);
    const double bare_seconds = median_seconds([&] { trace_bare(posed.rays(), recorder.rays); });

    const double rays = double(frame.rays.camera + frame.rays.indirect + frame.rays.shadow);
    const double recorded = double(recorder.rays.size());
    fmt::print("{}: kernel {}, {:.0f} rays ({:.0f} recorded)\n", name, choice.name, rays, recorded);
    fmt::print("  render {:.3f} s, {:.2f} Mrays/s; bare Embree {:.3f} s, {:.2f} Mrays/s\n",
               render_seconds, rays / render_seconds * 1e-6, bare_seconds,
               recorded / bare_seconds * 1e-6);
    fmt::print("  render / bare, per ray: {:.2f}\n",
               render_seconds / rays * recorded / bare_seconds);
}

} // namespace

int main(int argc, char** argv) {
    const Workers one(1);
    if (argc > 1) {
        const std::vector<std::string> paths(argv + 1, argv + argc);
        const Scene scene = load_gltf(paths, {}, one).scene;
        const RenderSpace space = render_space_of(scene, one);
        measure(paths.front(), scene, choose_camera(scene, space, {}), space, one);
    } else {
        const Scene scene =
            reference::cornell(reference::lambert(V3f(0.7f)), reference::emitter(V3f(12)));
        const RenderSpace space = render_space_of(scene, one);
        CameraChoice view;
        view.explicit_view = true;
        view.look_from = {0, 0, 1.9};
        view.fov_degrees = 39;
        measure("Cornell box", scene, choose_camera(scene, space, view), space, one);
    }
}
