// glTF scenes, .gltf and .glb: loaded, posed, and rendered in 2 x 2 pixels by every renderer.
#include "fuzz.h"

#include "linespace/inject.h"
#include "linespace/sample.h"
#include "render/path_tracer.h"
#include "rsm/render.h"
#include "sampling/seeds.h"
#include "scene/features.h"
#include "scene/gltf_load.h"
#include "scene/scene_hash.h"

namespace {

using namespace ql;

constexpr int kSide = 2;
constexpr uint64_t kMaxTriangles = 4096; // more take too long for what they show

GltfLoadConfig load_config() {
    GltfLoadConfig config;
    config.max_file_bytes = 1 << 20;
    config.max_elements = 1 << 16;
    config.max_texture_pixels = 1 << 14;
    return config;
}

struct Stage {
    const PosedScene& posed;
    const PixelCamera& camera;
    const NextFrame& next;
    const Workers& workers;
    Array2D<uint32_t> seeds = fresh_seeds(1, 0, kSide, kSide);
};

void trace_paths(const Stage& s) {
    RenderConfig config;
    config.spp = 2;
    config.path.max_depth = 6;
    config.path.sky = V3f(0.5f);
    config.aovs = parse_aovs("all");
    Progress quiet;
    const FrameResult result =
        render_frame(s.posed, s.camera, s.seeds, config, &s.next, s.workers, quiet);
    fuzz::check_picture(result.image, "paths");
}

void render_maps(const Stage& s) {
    RsmConfig config;
    config.map.size = 8;
    config.gather.samples = 4;
    config.compensate = Compensate::yes;
    Progress quiet;
    RsmRenderer renderer(s.posed, s.camera, kSide, kSide, config, s.workers, quiet);
    renderer.prepare_pass();
    renderer.render_pass();
    fuzz::check_picture(renderer.image(), "maps");
}

void render_linespace(const Stage& s) {
    InjectConfig config;
    config.grid.voxels = {2, 2, 2};
    config.patches = 2;
    config.photons = {0, 64};
    InjectReport report;
    Progress quiet;
    const LightCache cache = inject(s.posed, 1, config, s.workers, quiet, report);
    const ReadTable table(cache, s.posed.world().space, s.posed.lights(), {1}, s.workers);
    SampleConfig sample;
    sample.read.max_depth = cache.header.max_depth;
    fuzz::check_picture(
        sample_frame(s.posed, s.camera, table, nullptr, nullptr, s.seeds, sample, s.workers, quiet)
            .image,
        "Linespace");
}

void render(const std::string& path) {
    static const Workers workers(1);
    const LoadedScene loaded = load_gltf({path}, load_config(), workers);
    const Scene& scene = loaded.scene;
    const SceneFeatures features = required_features(scene);
    (void)feature_line(features);
    (void)scene_hash(scene);
    if (features.triangles + features.spheres + features.cones > kMaxTriangles) return;
    const RenderSpace space = render_space_of(scene, workers);
    const ChosenCamera chosen = choose_camera(scene, space, {});
    const double time = 0.5;
    const PosedScene posed(scene, space, time, workers);
    const PixelCamera camera = pixel_camera(chosen, scene, space, time, kSide, kSide);
    const NextFrame next{pixel_camera(chosen, scene, space, 2 * time, kSide, kSide),
                         world_from_nodes(scene, 2 * time)};
    const Stage stage{posed, camera, next, workers};
    fuzz::refuse_or([&] { trace_paths(stage); });
    fuzz::refuse_or([&] { render_maps(stage); });
    fuzz::refuse_or([&] { render_linespace(stage); });
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    const std::string& path = fuzz::scratch_file({data, size});
    fuzz::refuse_or([&] { render(path); });
    return 0;
}
