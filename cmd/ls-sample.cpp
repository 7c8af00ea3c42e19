// ls-sample: an image of a glTF scene whose indirect light is read from a Linespace cache.
#include "cli/blur_option.h"
#include "cli/choice.h"
#include "cli/path_options.h"
#include "cli/render_output.h"
#include "cli/scene_options.h"
#include "cli/tool.h"
#include "linespace/cache_file.h"
#include "linespace/sample.h"
#include "render/path_tracer.h"
#include "sampling/seeds.h"
#include "scene/scene_hash.h"

#include <algorithm>
#include <memory>
#include <optional>

namespace {

using namespace ql;

constexpr double kDefaultSmoothing = 1000;

struct Options {
    cli::SceneOptions scene;
    SampleConfig sample;
    std::optional<double> smoothing; // none: kDefaultSmoothing where the cache has groups
    std::optional<BlurRadius> blur;  // none: that of the cache
    int max_depth = 0;               // 0: that of the cache
    bool any_scene = false;
    bool strict = false;
    bool use_candidates = false;
    std::string cache;
    cli::RenderOutput output;
    uint64_t seed = 0;
};

void declare_reading(cli::Tool& tool, Options& o) {
    ReadConfig& read = o.sample.read;
    tool.app.add_option("--cache", o.cache, "Cache of this scene, from ls-inject")
        ->type_name("CACHE")
        ->required();
    tool.app.add_flag("--any-scene", o.any_scene, "Take a cache that was made for another scene");
    tool.app
        .add_option("--max-depth", o.max_depth,
                    "Scatterings between light and camera, both parts of the path together; the "
                    "default is that of the cache, which is also the most")
        ->check(CLI::Range(1, kMaxJoinedDepth))
        ->default_str("");
    tool.app
        .add_option("--reads", read.reads,
                    "Directions in which the cache is read where a path first meets it")
        ->check(CLI::Range(1, 1024));
    tool.app
        .add_option_function<std::string>(
            "--blur", [&o](const std::string& text) { o.blur = cli::parse_blur(text); },
            "Radius of the disc on which look-ups are moved, in metres or in voxels (0.25vox); the "
            "default is that of the cache")
        ->type_name("R|Xvox")
        ->default_str("");
    tool.app
        .add_option("--shaft-jitter", read.shaft_jitter,
                    "Width, in patches, in which look-ups are moved on the voxel's faces")
        ->check(CLI::Range(0.0, 4.0));
    tool.app
        .add_option(
            "--smoothing", o.smoothing,
            "Photons per shaft at which a shaft and those around it have equal weight; 0: each by "
            "itself; needs a cache of the estimator energy")
        ->check(CLI::Range(0.0, 1e9))
        ->default_str("1000");
    tool.app
        .add_option_function<std::vector<float>>(
            "--glossy",
            [&read](const std::vector<float>& n) {
                if (!(n[0] >= 0) || !(n[1] >= n[0]))
                    throw usage_error("--glossy: {} {}, expected 0 <= N1 <= N2", n[0], n[1]);
                read.glossy = {n[0], n[1]};
            },
            "Phong lobes of exponents below N1 read the cache, from N2 on they are traced, in "
            "between by chance")
        ->expected(2)
        ->type_name("N1 N2")
        ->default_str("0 0");
    cli::add_choice<Fallback>(
        tool, "--fallback", read.fallback, {{"never", Fallback::never}, {"trace", Fallback::trace}},
        "Where no light came by a shaft: never, it is dark; trace: trace on (caches of the "
        "estimators count-text and count-listing only)");
    cli::add_choice<bool>(
        tool, "--occlusion", o.use_candidates, {{"bvh", false}, {"candidates", true}},
        "What a read asks whether its ray leaves the voxel: bvh, the scene's tree; "
        "candidates, lists of the primitives in each shaft");
}

void declare(cli::Tool& tool, Options& o) {
    cli::add_scene_options(tool, o.scene);
    declare_reading(tool, o);
    cli::add_render_output(tool, o.output, "Image, .exr or .png");
    tool.app.add_option("--spp", o.sample.spp, "Samples per pixel")->check(CLI::Range(1, 1 << 24));
    cli::add_path_options(tool, o.sample.read.roulette_depth, o.sample.read.all_lights);
    tool.app
        .add_option_function<std::string>(
            "--layers",
            [&o](const std::string& names) { o.sample.layers = parse_read_layers(names); },
            "More channels: direct, indirect, cached, caustic, variance, all")
        ->type_name("NAMES");
    tool.add_seed(o.seed);
    tool.app.add_flag("--strict", o.strict, "Samples that are not finite are an error");
}

void check_cache(const Options& o, const CacheHeader& header, const Scene& scene) {
    const uint64_t hash = scene_hash(scene);
    if (header.scene_hash != hash && !o.any_scene)
        throw input_error("{}: made for another scene ({:016x}, expected {:016x}); --any-scene "
                          "takes it all the same",
                          o.cache, header.scene_hash, hash);
    if (o.max_depth > header.max_depth)
        throw usage_error("--max-depth {}: {} holds light for paths of at most {} scatterings",
                          o.max_depth, o.cache, header.max_depth);
    if (o.smoothing && *o.smoothing > 0 && header.estimator != Estimator::energy)
        throw usage_error("--smoothing needs a cache of the estimator energy; {} has {}", o.cache,
                          name_of(header.estimator));
    if (o.sample.read.fallback == Fallback::trace && header.estimator == Estimator::energy)
        throw usage_error("--fallback trace: with the estimator energy, shafts without light are "
                          "part of the mean; tracing there would count light twice");
}

// The scene and its cache, ready to be asked.
struct Prepared {
    std::unique_ptr<PosedScene> posed;
    std::unique_ptr<ReadTable> table;
    std::unique_ptr<OpenSides> sides;            // none: all are open
    std::unique_ptr<ShaftCandidates> candidates; // none: the scene's tree is asked
    uint64_t photons = 0;
};

LightCache read_fitting_cache(const Options& o, const Scene& scene, cli::Session& session) {
    const auto timer = session.phase("load");
    session.stats().input.push_back(o.cache);
    LightCache cache = read_cache(o.cache);
    check_cache(o, cache.header, scene);
    if (cache.header.estimator != Estimator::energy)
        session.warn(fmt::format("{}: of the estimator {}, which is not radiometric", o.cache,
                                 name_of(cache.header.estimator)));
    return cache;
}

Prepared prepared(Options& o, const cli::OpenScene& open, cli::Session& session) {
    const LightCache cache = read_fitting_cache(o, open.scene, session);
    o.sample.read.max_depth = o.max_depth > 0 ? o.max_depth : cache.header.max_depth;
    o.sample.blur_metres = o.blur ? blur_metres(*o.blur, cache.header.cell) : cache.header.blur;
    if (o.use_candidates && (o.sample.blur_metres > 0 || o.sample.read.shaft_jitter > 0))
        throw usage_error("--occlusion candidates knows shafts as they are, without --blur "
                          "and --shaft-jitter");
    Prepared p;
    p.photons = cache.header.photon_count();
    {
        const auto timer = session.phase("build");
        p.posed = std::make_unique<PosedScene>(open.scene, open.space, 0, session.workers());
        if (cache.header.estimator == Estimator::energy)
            p.sides = std::make_unique<OpenSides>(p.posed->rays(), LightEmission(p.posed->lights()),
                                                  session.workers());
        const ReadTableConfig config{o.smoothing.value_or(kDefaultSmoothing)};
        p.table = std::make_unique<ReadTable>(cache, open.space, p.posed->lights(), config,
                                              session.workers());
    }
    if (o.use_candidates) {
        const auto timer = session.phase("candidates");
        p.candidates =
            std::make_unique<ShaftCandidates>(p.posed->world(), *p.table, session.workers());
    }
    return p;
}

void report(const SampleResult& result, const Prepared& p, cli::Session& session) {
    const ReadCounts& counts = result.counts;
    session.stats().rays = {{"camera", counts.rays.camera},
                            {"indirect", counts.rays.indirect},
                            {"shadow", counts.rays.shadow}};
    session.stats().result = {{"reads", counts.reads},
                              {"near_hits", counts.near_hits},
                              {"dark_reads", counts.dark},
                              {"table_memory_bytes", p.table->memory_bytes()}};
    if (p.candidates) {
        session.stats().result["candidates"] = p.candidates->size();
        session.stats().result["candidates_memory_bytes"] = p.candidates->memory_bytes();
    }
    if (result.discarded_samples > 0)
        session.warn(fmt::format("{} samples were not finite and have been left out",
                                 result.discarded_samples));
}

void run(Options& o, cli::Session& session) {
    file_format(o.output.path, o.output.format);
    if ((o.sample.layers & kLayerVariance) && o.sample.spp < 2)
        throw usage_error("--layers variance needs --spp 2 or more");
    const cli::OpenScene open = cli::open_scene(session, o.scene, cli::LightNeed::required);
    const Prepared p = prepared(o, open, session);
    const auto [width, height] = o.scene.size;
    const PixelCamera camera = pixel_camera(open.camera, open.scene, open.space, 0, width, height);
    SampleResult result;
    {
        const auto timer = session.phase("render");
        result = sample_frame(*p.posed, camera, *p.table, p.candidates.get(), p.sides.get(),
                              fresh_seeds(o.seed, 0, width, height), o.sample, session.workers(),
                              session.progress());
    }
    session.stats().discarded_samples = result.discarded_samples;
    if (o.strict && result.discarded_samples > 0)
        throw input_error("{}: {} samples are not finite", o.scene.paths.front(),
                          result.discarded_samples);
    Metadata& header = result.image.metadata;
    header = camera_metadata(camera);
    header["ql:spp"] = o.sample.spp;
    header["ql:max_depth"] = o.sample.read.max_depth;
    header["ql:seed"] = std::to_string(o.seed);
    header["ql:photons"] = std::to_string(p.photons);
    session.write_image(o.output.path, result.image, cli::image_config(session, o.output));
    report(result, p, session);
}

} // namespace

int main(int argc, char** argv) {
    cli::Tool tool({"ls-sample", "Renders a glTF scene with the light of a Linespace cache.",
                    "ls-sample scene.gltf --cache cache.exr --size 640x480 --spp 16 -o image.exr"});
    Options options;
    declare(tool, options);
    return tool.main(argc, argv, [&](cli::Session& session) { run(options, session); });
}
