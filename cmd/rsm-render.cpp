// rsm-render: direct light and one diffuse bounce from reflective shadow maps.
#include "bluenoise/mask_file.h"
#include "cli/scene_options.h"
#include "cli/tool.h"
#include "image/frame_range.h"
#include "render/path_tracer.h"
#include "rsm/map_image.h"
#include "rsm/render.h"

#include <charconv>
#include <chrono>
#include <memory>

namespace {

using namespace ql;

constexpr int kUnlimitedPasses = 1 << 24;

struct Clamp {
    enum class Kind { disc, distance, none };
    Kind kind = Kind::disc;
    double distance = 0; // metres
};

struct Options {
    cli::SceneOptions scene;
    RsmConfig rsm;
    Clamp clamp;
    int spp = 4;
    double time_limit_seconds = 0;
    std::string output, map_output, mask_path;
    FileFormat format = FileFormat::by_extension;
    bool half = false;
    float exposure_stops = 0;
    bool strict = false;
    double max_memory_gib = 4;
};

// An option whose values are names.
template<class T>
CLI::Option* add_choice(cli::Tool& tool, const std::string& name, T& value,
                        const std::vector<std::pair<std::string, T>>& choices,
                        const std::string& what) {
    std::vector<std::string> names;
    std::string now;
    for (const auto& [choice, meaning] : choices) {
        names.push_back(choice);
        if (meaning == value) now = choice;
    }
    return tool.app
        .add_option_function<std::string>(
            name,
            [&value, choices](const std::string& text) {
                for (const auto& [choice, meaning] : choices)
                    if (choice == text) value = meaning;
            },
            what)
        ->check(CLI::IsMember(names))
        ->default_str(now);
}

Clamp parse_clamp(const std::string& text) {
    if (text == "disc") return {};
    if (text == "none") return {Clamp::Kind::none, 0};
    const std::string prefix = "distance=";
    if (text.starts_with(prefix)) {
        const auto value = cli::parse_numbers(text.substr(prefix.size()), 1, "--clamp");
        if (value[0] > 0) return {Clamp::Kind::distance, value[0]};
    }
    throw usage_error("--clamp: '{}', expected disc, none, or distance=D with D above 0 metres",
                      text);
}

void declare_map(cli::Tool& tool, Options& o) {
    tool.app.add_option("--rsm-size", o.rsm.map.size, "Texels along a side of a map")
        ->check(CLI::Range(1, 16384));
    add_choice<MapKind>(
        tool, "--map", o.rsm.map.kind,
        {{"equal-area", MapKind::equal_area}, {"perspective", MapKind::perspective}},
        "What texels see of point and spot lights");
    add_choice<TexelPoint>(
        tool, "--texels", o.rsm.map.point,
        {{"centre", TexelPoint::centre}, {"jittered", TexelPoint::jittered}},
        "Where rays go; jittered: anywhere in their texels, afresh for each pass");
    tool.app
        .add_option("--rsm-out", o.map_output, "Write the maps: Z, P, N and flux, one part each")
        ->type_name("FILE");
}

void declare_gather(cli::Tool& tool, Options& o) {
    GatherConfig& g = o.rsm.gather;
    add_choice<Gather>(
        tool, "--gather", g.gather,
        {{"pattern", Gather::pattern}, {"full", Gather::full}, {"importance", Gather::importance}},
        "Which texels light a point");
    tool.app
        .add_option("--samples", g.samples, "Texels for each point and pass; pattern: of each map")
        ->check(CLI::Range(1, 1 << 20));
    tool.app.add_option("--radius", g.radius, "Radius of the pattern in map widths, (0, 2]")
        ->check([](const std::string& text) {
            const double value = std::atof(text.c_str());
            return value > 0 && value <= 2 ? std::string() : "expected a radius in (0, 2]";
        });
    add_choice<PatternWeights>(
        tool, "--weights", g.weights,
        {{"unbiased", PatternWeights::unbiased}, {"thesis", PatternWeights::thesis}},
        "thesis: brightness of Nilles 2017");
    add_choice<MipUse>(tool, "--mips", g.mips, {{"off", MipUse::off}, {"on", MipUse::on}},
                       "Average texels by distance in the pattern");
    add_choice<ShadowTest>(tool, "--shadow-test", g.shadow_test,
                           {{"on", ShadowTest::on}, {"off", ShadowTest::off}},
                           "A ray to each texel, or light through walls");
    tool.app
        .add_option_function<std::string>(
            "--clamp", [&o](const std::string& text) { o.clamp = parse_clamp(text); },
            "Bound of 1/distance^2: disc, distance=METRES or none")
        ->type_name("BOUND")
        ->default_str("disc");
    tool.app.add_flag_callback(
        "--compensate", [&o] { o.rsm.compensate = Compensate::yes; },
        "Bring back by a ray what the bound takes away");
    add_choice<Rotation>(
        tool, "--rotate", o.rsm.rotation,
        {{"none", Rotation::none}, {"white", Rotation::white}, {"blue", Rotation::blue}},
        "How samples differ from pixel to pixel");
    tool.app.add_option("--mask", o.mask_path, "Mask of --rotate blue; one of 64x64 is made else")
        ->type_name("FILE");
}

void declare(cli::Tool& tool, Options& o) {
    cli::add_scene_options(tool, o.scene);
    cli::add_frame_options(tool, o.scene);
    tool.add_output(o.output, "Image, .exr or .png, numbered by %04d");
    tool.add_format(o.format);
    tool.app.add_flag("--half", o.half, "Write 16-bit floats");
    tool.app.add_option("--exposure", o.exposure_stops,
                        "Stops by which PNG pictures are brightened");
    declare_map(tool, o);
    declare_gather(tool, o);
    add_choice<DirectMode>(tool, "--direct", o.rsm.direct,
                           {{"ray", DirectMode::ray}, {"map", DirectMode::map}},
                           "Shadows of direct light");
    tool.app
        .add_option("--interpolate", o.rsm.interpolate,
                    "Gather at every N-th pixel and interpolate where that goes")
        ->check(CLI::Range(1, 16));
    tool.app
        .add_option("--spp", o.spp, "Passes: 1 through the pixel's centre, more anywhere in it")
        ->check(CLI::Range(1, kUnlimitedPasses));
    tool.app
        .add_option("--time-limit", o.time_limit_seconds,
                    "Begin no pass that would end later; without --spp, pass after pass till then")
        ->type_name("SECONDS")
        ->default_str("")
        ->check(CLI::Range(1e-3, 1e9));
    tool.app
        .add_option_function<std::string>(
            "--aov", [&o](const std::string& names) { o.rsm.aovs = parse_aovs(names); },
            "More channels: depth, normal, position, albedo, variance, id")
        ->type_name("NAMES");
    tool.add_seed(o.rsm.seed);
    tool.app.add_flag("--strict", o.strict, "Samples that are not finite are an error");
    tool.app.add_option("--max-memory", o.max_memory_gib, "Stop if the maps would take more GiB")
        ->check(CLI::Range(1e-6, 1e6));
}

bool given(const cli::Tool& tool, const std::string& option) {
    return tool.app.get_option(option)->count() > 0;
}

// Settings that follow from others, and those that would have no effect together.
void settle(const cli::Tool& tool, Options& o) {
    GatherConfig& g = o.rsm.gather;
    const bool thesis = g.weights == PatternWeights::thesis;
    const bool compensates = o.rsm.compensate == Compensate::yes;
    if (thesis && !given(tool, "--gather")) g.gather = Gather::pattern;
    if (thesis && !given(tool, "--mips")) g.mips = MipUse::on;
    if (thesis && !given(tool, "--clamp")) o.clamp = {Clamp::Kind::distance, 1};
    if (compensates && !given(tool, "--texels")) o.rsm.map.point = TexelPoint::jittered;
    if (o.time_limit_seconds > 0 && !given(tool, "--spp")) o.spp = kUnlimitedPasses;
    o.rsm.map.measure = thesis ? FluxMeasure::intensity : FluxMeasure::watts;
    o.rsm.pixel = o.spp == 1 ? PixelPoint::centre : PixelPoint::jittered;

    if (g.gather != Gather::pattern && (thesis || g.mips == MipUse::on))
        throw usage_error("{} is for --gather pattern", thesis ? "--weights thesis" : "--mips on");
    if (g.gather == Gather::full)
        for (const char* option : {"--samples", "--radius", "--rotate"})
            if (given(tool, option))
                throw usage_error("{}: --gather full takes every texel", option);
    if (!o.mask_path.empty() && o.rsm.rotation != Rotation::blue)
        throw usage_error("--mask is for --rotate blue");
    if (compensates && (thesis || g.shadow_test == ShadowTest::off))
        throw usage_error("--compensate needs unbiased weights and the shadow test");
    if (compensates && o.clamp.kind == Clamp::Kind::none)
        throw usage_error("--compensate with --clamp none: nothing is taken away");
    if (o.rsm.aovs & kAovMotion) throw usage_error("--aov motion: see bn-render(1)");
    if ((o.rsm.aovs & kAovVariance) && o.spp < 2)
        throw usage_error("--aov variance needs --spp 2 or more");
    for (const std::string* path : {&o.output, &o.map_output})
        if (o.scene.frames.size() > 1 && !path->empty() && !is_numbered(*path))
            throw usage_error("{}: {} frames need a numbered name such as frame.%04d.exr", *path,
                              o.scene.frames.size());
    file_format(o.output, o.format);
    if (!o.map_output.empty() &&
        file_format(o.map_output, FileFormat::by_extension) != FileFormat::exr)
        throw usage_error("{}: maps are written as .exr", o.map_output);
}

Array2D<float> thresholds(const Array2D<uint32_t>& values, double levels) {
    Array2D<float> mask(values.width(), values.height());
    for (size_t i = 0; i < values.size(); ++i)
        mask[i] = float((double(values[i]) + 0.5) / levels);
    return mask;
}

Array2D<float> rotation_mask(const Options& o, cli::Session& session) {
    if (o.rsm.rotation != Rotation::blue) return {};
    if (o.mask_path.empty()) {
        MaskConfig config;
        const Array2D<uint32_t> ranks = mask_ranks(config, session.progress());
        return thresholds(ranks, double(ranks.size()));
    }
    const Mask mask = mask_from_image(session.read_image(o.mask_path), "", o.mask_path);
    return thresholds(mask.values, mask.levels);
}

// The bound in render space.
GeometryBound bound_of(const Clamp& clamp, const RenderSpace& space) {
    const double distance = clamp.distance * space.scale;
    return {clamp.kind == Clamp::Kind::disc ? 1.0f : 0.0f, float(distance * distance)};
}

void check_lights(const Options& o, const PosedScene& posed, cli::Session& session) {
    const std::string& path = o.scene.paths.front();
    const std::vector<MapLight> lights = map_lights(posed);
    if (posed.lights().triangle_count() > 0)
        session.warn(fmt::format("{}: {} emissive triangles are shown but light nothing "
                                 "(see bn-render)",
                                 path, posed.lights().triangle_count()));
    if (lights.empty() && !o.scene.allow_dark)
        throw input_error("{}: no point, spot or directional light that shines (--allow-dark "
                          "renders it all the same)",
                          path);
    const size_t faces = o.rsm.map.kind == MapKind::perspective ? 6 : 1;
    size_t maps = 0;
    for (const MapLight& light : lights)
        maps += light.kind == Light::Kind::point ? faces : 1;
    const double gib = double(maps * map_bytes(o.rsm.map.size)) / double(1 << 30);
    if (gib > o.max_memory_gib)
        throw usage_error("{} maps of {} x {} texels take about {:.2g} GiB, --max-memory allows {}",
                          maps, o.rsm.map.size, o.rsm.map.size, gib, o.max_memory_gib);
}

void fill_stats(const RsmRenderer& renderer, const Options& o, const PosedScene& posed,
                RsmCounts& total, cli::Session& session) {
    total.add(renderer.counts());
    cli::Stats& stats = session.stats();
    stats.rays = {{"camera", total.camera},
                  {"map", total.map},
                  {"direct_shadow", total.direct_shadow},
                  {"gather_shadow", total.gather_shadow},
                  {"compensation", total.compensation},
                  {"compensation_shadow", total.compensation_shadow}};
    stats.discarded_samples = total.discarded_samples;
    cli::Json maps = cli::Json::array();
    const World& world = posed.world();
    const double watts =
        std::ldexp(1 / (world.space.scale * world.space.scale), posed.lights().exponent());
    for (const ReflectiveShadowMap& map : renderer.maps()) {
        cli::Json entry = {{"light", map.name}, {"lit_texels", map.lit_texels}};
        if (o.rsm.map.measure == FluxMeasure::watts)
            entry["flux_watts"] = {map.flux.x * watts, map.flux.y * watts, map.flux.z * watts};
        maps.push_back(entry);
    }
    stats.result["maps"] = maps;
    stats.result["passes"] = renderer.passes();
    stats.result["interpolated_share"] =
        total.lit_pixels > 0 ? double(total.interpolated_pixels) / double(total.lit_pixels) : 0.0;
}

Metadata settings(const Options& o, int passes, int frame) {
    Metadata m;
    m["ql:frame"] = frame;
    m["ql:passes"] = passes;
    m["ql:rsm_size"] = o.rsm.map.size;
    m["ql:seed"] = std::to_string(o.rsm.seed);
    return m;
}

void render_one(const Options& o, const cli::OpenScene& open, const PosedScene& posed, int frame,
                RsmCounts& total, cli::Session& session) {
    using Clock = std::chrono::steady_clock;
    const PixelCamera camera =
        pixel_camera(open.camera, open.scene, open.space, frame / o.scene.fps, o.scene.size.width,
                     o.scene.size.height);
    RsmConfig config = o.rsm;
    config.frame = uint32_t(frame);
    config.gather.bound = bound_of(o.clamp, open.space);
    RsmRenderer renderer(posed, camera, o.scene.size.width, o.scene.size.height, config,
                         session.workers(), session.progress());

    // Add passes while there are some to come and time for one more.
    const auto begin = Clock::now();
    const auto fits = [&] {
        if (!(o.time_limit_seconds > 0) || renderer.passes() == 0) return true;
        const double seconds = std::chrono::duration<double>(Clock::now() - begin).count();
        return seconds * (1 + 1.0 / renderer.passes()) <= o.time_limit_seconds;
    };
    while (renderer.passes() < o.spp && fits()) {
        {
            const auto timer = session.phase("maps");
            renderer.prepare_pass();
        }
        const auto timer = session.phase("render");
        renderer.render_pass();
    }

    // Write the image and the maps.
    fill_stats(renderer, o, posed, total, session);
    if (o.strict && total.discarded_samples > 0)
        throw input_error("{}: {} samples up to frame {} are not finite", o.scene.paths.front(),
                          total.discarded_samples, frame);
    Image image = renderer.image();
    image.metadata = camera_metadata(camera);
    image.metadata.merge(settings(o, renderer.passes(), frame));
    ImageWriteConfig write = session.image_config();
    write.format = o.format;
    write.depth = o.half ? FloatDepth::half : FloatDepth::float32;
    write.exposure_stops = o.exposure_stops;
    session.write_image(numbered_path(o.output, frame), image, write);
    if (o.map_output.empty()) return;
    std::vector<Image> parts = map_images(renderer.maps(), posed.world(), posed.lights().exponent(),
                                          o.rsm.map.measure, o.rsm.gather.mips);
    if (parts.empty()) {
        session.warn(fmt::format("{}: not written, no light has a map", o.map_output));
        return;
    }
    if (parts.size() == 1) parts.front().name.clear();
    session.write_image_parts(numbered_path(o.map_output, frame), parts, session.image_config());
}

void run(const cli::Tool& tool, Options& o, cli::Session& session) {
    settle(tool, o);
    o.rsm.mask = rotation_mask(o, session);
    const cli::OpenScene open = cli::open_scene(session, o.scene, cli::LightNeed::required);
    const bool moves = has_moving_surfaces_or_lights(open.scene);
    std::unique_ptr<PosedScene> posed;
    RsmCounts total;
    for (const int frame : o.scene.frames) {
        if (!posed || moves) {
            const auto timer = session.phase("build");
            posed.reset();
            posed = std::make_unique<PosedScene>(open.scene, open.space, frame / o.scene.fps,
                                                 session.workers());
        }
        if (frame == o.scene.frames.front()) check_lights(o, *posed, session);
        render_one(o, open, *posed, frame, total, session);
    }
    if (total.discarded_samples > 0)
        session.warn(fmt::format("{} samples were not finite and have been left out",
                                 total.discarded_samples));
}

} // namespace

int main(int argc, char** argv) {
    cli::Tool tool({"rsm-render",
                    "Renders direct light and one diffuse bounce from reflective shadow maps.",
                    "rsm-render scene.gltf --size 640x480 --samples 100 -o image.exr"});
    Options options;
    declare(tool, options);
    return tool.main(argc, argv, [&](cli::Session& session) { run(tool, options, session); });
}
