// What the specialised kernels buy: the same work done by the kernel that a scene requires and by
// the general one, which it gets by materials that nothing uses.
//     kernel_bench [RUNS]    9 unless given
// Work of each tool, on one thread: bn-render and ls-sample 256 x 256 pixels at 4 samples and depth
// 5, ls-inject the tracing of 40,000 photons. Kernels take turns; medians of processor time; the
// ratio to the general kernel (all lobes) is what counts, on a busy machine that of the fastest
// runs. Rays are counted: they should be the same in all.
#include "linespace/inject.h"
#include "linespace/sample.h"
#include "reference/scene_builder.h"
#include "sampling/seeds.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <memory>

namespace {

using namespace ql;
using namespace ql::reference;

constexpr int kSide = 256, kSpp = 4;
constexpr uint64_t kPhotons = 40000;

const Workers kOne(1);

// A scene ready for all tools.
struct Stage {
    Scene scene;
    RenderSpace space;
    PosedScene posed;
    PixelCamera camera;
    explicit Stage(Scene s)
        : scene(std::move(s)), space(render_space_of(scene, kOne)), posed(scene, space, 0, kOne),
          camera(camera_of(cornell_view(kSide), scene, space)) {}
};

// Does a tool's work once; returns the number of its rays.
using Work = std::function<uint64_t()>;

Work path_tracing(const Stage& stage) {
    return [&stage] {
        RenderConfig config;
        config.spp = kSpp;
        Progress progress;
        const RayCounts rays =
            render_frame(stage.posed, stage.camera, fresh_seeds(0, 0, kSide, kSide), config,
                         nullptr, kOne, progress)
                .rays;
        return rays.camera + rays.indirect + rays.shadow;
    };
}

// As ls-inject sets it up.
PhotonContext photon_context(const Stage& stage, const LightEmission& emission,
                             const OpenSides& sides) {
    const InjectConfig config;
    PhotonContext context{stage.posed.rays(),
                          emission,
                          grid_over(stage.posed.world(), config.grid),
                          config.patches,
                          config.normal_classes,
                          config.estimator,
                          config.max_depth - 1,
                          config.branches,
                          config.seed,
                          1 / stage.space.scale,
                          {},
                          nullptr,
                          {}};
    for (const Material& material : stage.scene.materials)
        context.takes_light.push_back(takes_light(material));
    context.sides = &sides;
    return context;
}

Work photon_tracing(const Stage& stage) {
    struct State {
        LightEmission emission;
        OpenSides sides;
        PhotonContext context;
        explicit State(const Stage& s)
            : emission(s.posed.lights()), sides(s.posed.rays(), emission, kOne),
              context(photon_context(s, emission, sides)) {}
    };
    return [&stage, state = std::make_shared<State>(stage)] {
        std::vector<Deposit> deposits;
        PhotonCounts counts;
        photon_tracer_for(stage.scene)(state->context, 0, kPhotons, deposits, counts);
        return counts.rays;
    };
}

Work cache_reading(const Stage& stage) {
    struct State {
        OpenSides sides;
        std::unique_ptr<ReadTable> table;
        explicit State(const Stage& s)
            : sides(s.posed.rays(), LightEmission(s.posed.lights()), kOne) {
            InjectConfig config;
            config.photons = {0, kPhotons};
            InjectReport report;
            Progress progress;
            const LightCache cache = inject(s.posed, 1, config, kOne, progress, report);
            table = std::make_unique<ReadTable>(cache, s.space, s.posed.lights(),
                                                ReadTableConfig{1000}, kOne);
        }
    };
    return [&stage, state = std::make_shared<State>(stage)] {
        SampleConfig config;
        config.spp = kSpp;
        Progress progress;
        const RayCounts rays =
            sample_frame(stage.posed, stage.camera, *state->table, nullptr, &state->sides,
                         fresh_seeds(0, 0, kSide, kSide), config, kOne, progress)
                .counts.rays;
        return rays.camera + rays.indirect + rays.shadow;
    };
}

struct Tool {
    const char* name;
    Work (*work)(const Stage& stage);
};

constexpr Tool kTools[] = {
    {"bn-render", path_tracing}, {"ls-inject", photon_tracing}, {"ls-sample", cache_reading}};

struct Variant {
    std::string kernel;
    std::unique_ptr<Stage> stage;
    Work work;
    uint64_t rays = 0;
    std::vector<double> seconds = {};
};

std::vector<Variant> variants_of(const Tool& tool, const Scene& needed) {
    std::vector<Variant> variants;
    Scene general = needed;
    general.materials.push_back(glass(1.5f));
    for (const Scene& scene : {needed, general}) {
        const std::string kernel = choose_kernel(scene).name;
        auto stage = std::make_unique<Stage>(scene);
        Work work = tool.work(*stage);
        variants.push_back({kernel, std::move(stage), std::move(work)});
    }
    return variants;
}

double processor_seconds() {
    return double(std::clock()) / CLOCKS_PER_SEC;
}

void measure(const Tool& tool, const char* name, const Scene& needed, int runs) {
    std::vector<Variant> variants = variants_of(tool, needed);
    for (int run = -1; run < runs; ++run) // the first is for the caches
        for (Variant& variant : variants) {
            const double start = processor_seconds();
            variant.rays = variant.work();
            if (run >= 0) variant.seconds.push_back(processor_seconds() - start);
        }
    for (Variant& variant : variants)
        std::sort(variant.seconds.begin(), variant.seconds.end());
    const Variant& general = variants.back();
    const size_t middle = size_t(runs) / 2;
    fmt::print("{}: {}\n", tool.name, name);
    for (const Variant& variant : variants)
        fmt::print("  {:<40} {:6.3f} s  {:6.3f} to {:6.3f}  ratio {:5.3f}  fastest {:5.3f}  "
                   "rays {:+d}\n",
                   variant.kernel, variant.seconds[middle], variant.seconds.front(),
                   variant.seconds.back(), variant.seconds[middle] / general.seconds[middle],
                   variant.seconds.front() / general.seconds.front(),
                   int64_t(variant.rays) - int64_t(general.rays));
    std::fflush(stdout);
}

} // namespace

int main(int argc, char** argv) {
    const int runs = argc > 1 ? std::max(1, std::atoi(argv[1])) : 9;
    const Scene box = cornell(lambert(V3f(0.7f)), emitter(V3f(12)));
    for (const Tool& tool : kTools)
        measure(tool, "diffuse", box, runs);
}
