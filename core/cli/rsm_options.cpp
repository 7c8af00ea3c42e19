#include "cli/rsm_options.h"

#include "bluenoise/mask_file.h"
#include "cli/choice.h"
#include "render/path_tracer.h"

namespace ql::cli {

namespace {

constexpr int kUnlimitedPasses = 1 << 24;

RsmClamp parse_clamp(const std::string& text) {
    if (text == "disc") return {};
    if (text == "none") return {RsmClamp::Kind::none, 0};
    const std::string prefix = "distance=";
    if (text.starts_with(prefix)) {
        const auto value = parse_numbers(text.substr(prefix.size()), 1, "--clamp");
        if (value[0] > 0) return {RsmClamp::Kind::distance, value[0]};
    }
    throw usage_error("--clamp: '{}', expected disc, none, or distance=D with D above 0 metres",
                      text);
}

void add_map_options(Tool& tool, RsmOptions& o) {
    MapConfig& map = o.config.map;
    tool.app.add_option("--rsm-size", map.size, "Texels along a side of a map")
        ->check(CLI::Range(1, 16384));
    add_choice<MapKind>(
        tool, "--map", map.kind,
        {{"equal-area", MapKind::equal_area}, {"perspective", MapKind::perspective}},
        "What texels see of point and spot lights");
    add_choice<TexelPoint>(
        tool, "--texels", map.point,
        {{"centre", TexelPoint::centre}, {"jittered", TexelPoint::jittered}},
        "Where rays go; jittered: anywhere in their texels, afresh for each pass");
    tool.app
        .add_option("--rsm-out", o.map_output, "Write the maps: Z, P, N and flux, one part each")
        ->type_name("FILE");
    tool.app.add_option("--max-memory", o.max_memory_gib, "Stop if the maps would take more GiB")
        ->check(CLI::Range(1e-6, 1e6));
}

void add_gather_options(Tool& tool, RsmOptions& o) {
    GatherConfig& g = o.config.gather;
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
        "--compensate", [&o] { o.config.compensate = Compensate::yes; },
        "Bring back by a ray what the bound takes away");
}

void add_image_options(Tool& tool, RsmOptions& o) {
    add_choice<Rotation>(
        tool, "--rotate", o.config.rotation,
        {{"none", Rotation::none}, {"white", Rotation::white}, {"blue", Rotation::blue}},
        "How samples differ from pixel to pixel");
    tool.app.add_option("--mask", o.mask, "Mask of --rotate blue; by default one of 64x64 is made")
        ->type_name("FILE");
    add_choice<DirectMode>(tool, "--direct", o.config.direct,
                           {{"ray", DirectMode::ray}, {"map", DirectMode::map}},
                           "Shadows of direct light");
    tool.app
        .add_option("--interpolate", o.config.interpolate,
                    "Gather at every N-th pixel; interpolate where surfaces are alike")
        ->check(CLI::Range(1, 16));
    tool.app
        .add_option("--spp", o.passes, "Passes: 1 through the pixel's centre, more anywhere in it")
        ->check(CLI::Range(1, kUnlimitedPasses));
    tool.app
        .add_option("--time-limit", o.time_limit_seconds,
                    "Start no pass that would end later; without --spp as many passes as fit")
        ->type_name("SECONDS")
        ->default_str("")
        ->check(CLI::Range(1e-3, 1e9));
    tool.app
        .add_option_function<std::string>(
            "--aov",
            [&o](const std::string& names) {
                o.config.aovs = parse_aovs(names, kAovAll & ~kAovMotion);
            },
            "More channels: depth, normal, position, albedo, direct, indirect, variance, id, all")
        ->type_name("NAMES");
    tool.app.add_flag_callback(
        "--measure-rays", [&o] { o.config.measure = RayMeasure::on; },
        "Time the gather's shadow rays against the same rays alone");
}

void check(const Tool& tool, const RsmOptions& o) {
    const GatherConfig& g = o.config.gather;
    const bool thesis = g.weights == PatternWeights::thesis;
    const bool compensates = o.config.compensate == Compensate::yes;
    if (g.gather != Gather::pattern && (thesis || g.mips == MipUse::on))
        throw usage_error("{} is for --gather pattern", thesis ? "--weights thesis" : "--mips on");
    if (g.gather == Gather::full)
        for (const char* option : {"--samples", "--radius", "--rotate"})
            if (tool.is_given(option))
                throw usage_error("{}: --gather full takes every texel", option);
    if (!o.mask.empty() && o.config.rotation != Rotation::blue)
        throw usage_error("--mask is for --rotate blue");
    if (compensates && (thesis || g.shadow_test == ShadowTest::off))
        throw usage_error("--compensate needs unbiased weights and the shadow test");
    if (compensates && o.clamp.kind == RsmClamp::Kind::none)
        throw usage_error("--compensate with --clamp none: nothing is taken away");
    if ((o.config.aovs & kAovVariance) && o.passes < 2)
        throw usage_error("--aov variance needs --spp 2 or more");
    if (o.config.measure == RayMeasure::on && g.shadow_test == ShadowTest::off)
        throw usage_error("--measure-rays needs the shadow test");
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

} // namespace

void add_rsm_options(Tool& tool, RsmOptions& options) {
    add_map_options(tool, options);
    add_gather_options(tool, options);
    add_image_options(tool, options);
    tool.add_seed(options.config.seed);
}

void settle_rsm_options(const Tool& tool, RsmOptions& o, Json& used) {
    GatherConfig& g = o.config.gather;
    const bool thesis = g.weights == PatternWeights::thesis;
    if (thesis && !tool.is_given("--gather")) {
        g.gather = Gather::pattern;
        used["gather"] = "pattern";
    }
    if (thesis && !tool.is_given("--mips")) {
        g.mips = MipUse::on;
        used["mips"] = "on";
    }
    if (thesis && !tool.is_given("--clamp")) {
        o.clamp = {RsmClamp::Kind::distance, 1};
        used["clamp"] = "distance=1";
    }
    if (o.config.compensate == Compensate::yes && !tool.is_given("--texels")) {
        o.config.map.point = TexelPoint::jittered;
        used["texels"] = "jittered";
    }
    if (o.time_limit_seconds > 0 && !tool.is_given("--spp")) {
        o.passes = kUnlimitedPasses;
        used.erase("spp");
    }
    o.config.map.measure = thesis ? FluxMeasure::intensity : FluxMeasure::watts;
    o.config.pixel = o.passes == 1 ? PixelPoint::centre : PixelPoint::jittered;
    check(tool, o);
}

GeometryBound geometry_bound(const RsmClamp& clamp, const RenderSpace& space) {
    const double distance = clamp.distance * space.scale;
    return {clamp.kind == RsmClamp::Kind::disc ? 1.0f : 0.0f, float(distance * distance)};
}

Array2D<float> rotation_mask(Session& session, const RsmOptions& options) {
    if (options.config.rotation != Rotation::blue) return {};
    if (options.mask.empty()) {
        const Array2D<uint32_t> ranks = mask_ranks(MaskConfig{}, session.progress());
        return thresholds(ranks, double(ranks.size()));
    }
    const Mask mask = mask_from_image(session.read_image(options.mask), "", options.mask);
    return thresholds(mask.values, mask.levels);
}

} // namespace ql::cli
