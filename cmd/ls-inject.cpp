// ls-inject: light paths from the lights of a glTF scene into a Linespace cache.
#include "cli/blur_option.h"
#include "cli/choice.h"
#include "cli/scene_options.h"
#include "cli/tool.h"
#include "linespace/cache_file.h"
#include "linespace/inject.h"
#include "scene/scene_hash.h"

#include <charconv>
#include <cmath>
#include <memory>

namespace {

using namespace ql;

struct Options {
    cli::SceneOptions scene;
    InjectConfig inject;
    std::string output, add, info;
};

uint64_t photon_number(std::string_view text, const std::string& whole) {
    uint64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    // 1e9 and 2.5e6 are numbers of photons too.
    double real = 0;
    const auto [real_end, real_error] =
        std::from_chars(text.data(), text.data() + text.size(), real);
    const char* const last = text.data() + text.size();
    if (error == std::errc() && end == last) return value;
    if (real_error == std::errc() && real_end == last && real >= 0 && real <= 1e15 &&
        real == std::floor(real))
        return uint64_t(real);
    throw usage_error("--photons: '{}', expected a number such as 2e6, or a range A:B", whole);
}

PhotonRange parse_photons(const std::string& text) {
    const size_t colon = text.find(':');
    PhotonRange range;
    if (colon == text.npos) {
        range.end = photon_number(text, text);
    } else {
        range.begin = photon_number(std::string_view(text).substr(0, colon), text);
        range.end = photon_number(std::string_view(text).substr(colon + 1), text);
    }
    if (range.begin >= range.end || range.end > uint64_t{1} << 50)
        throw usage_error("--photons: '{}', expected at least one photon and at most 2^50", text);
    return range;
}

std::array<int, 3> parse_voxels(const std::string& text) {
    std::array<int, 3> voxels{};
    const char* at = text.data();
    const char* const end = at + text.size();
    for (size_t axis = 0; axis < 3; ++axis) {
        const auto [next, error] = std::from_chars(at, end, voxels[axis]);
        const bool separated = axis == 2 ? next == end : next != end && *next == 'x';
        if (error != std::errc() || !separated || voxels[axis] < 1 ||
            voxels[axis] > kMaxVoxelsPerSide)
            throw usage_error("--voxels: '{}', expected NXxNYxNZ with counts from 1 to {}", text,
                              kMaxVoxelsPerSide);
        at = next + 1;
    }
    return voxels;
}

void declare(cli::Tool& tool, Options& o) {
    cli::add_scene_options(tool, o.scene);
    tool.app.get_option("scene")->required(false);
    for (const char* name : {"--camera", "--look-from", "--look-at", "--fov", "--size"})
        tool.app.remove_option(tool.app.get_option(name));
    tool.add_output(o.output, "Cache, deep .exr")->required(false);
    tool.app.add_option("--info", o.info, "Describe a cache; needs no scene")->type_name("CACHE");
    tool.app
        .add_option_function<std::string>(
            "--photons", [&o](const std::string& text) { o.inject.photons = parse_photons(text); },
            "Photons of all lights together, or a range A:B of their numbers")
        ->type_name("N|A:B")
        ->default_str("1000000");
    auto* voxels = tool.app.add_option_function<std::string>(
        "--voxels", [&o](const std::string& text) { o.inject.grid.voxels = parse_voxels(text); },
        "Voxels along x, y and z; the default is cubes of 1/32 of the longest side");
    voxels->type_name("NXxNYxNZ");
    tool.app.add_option("--voxel-size", o.inject.grid.voxel_size, "Side of cubic voxels in metres")
        ->type_name("M")
        ->check(CLI::PositiveNumber)
        ->excludes(voxels)
        ->default_str("");
    tool.app
        .add_option("--patches", o.inject.patches,
                    "Patches per side of a voxel's face (N); 15 N^4 shafts a voxel")
        ->check(CLI::Range(1, kMaxPatches));
    tool.app
        .add_option("--normal-classes", o.inject.normal_classes,
                    "Classes of surface normals kept apart in a shaft: 6 (by axis) or 1")
        ->check(CLI::IsMember({1, 6}));
    cli::add_choice<Estimator>(tool, "--estimator", o.inject.estimator,
                               {{"energy", Estimator::energy},
                                {"count-text", Estimator::count_text},
                                {"count-listing", Estimator::count_listing}},
                               "energy: radiance; count-text, count-listing: Nilles 2017, to "
                               "reproduce it");
    tool.app
        .add_option("--max-depth", o.inject.max_depth,
                    "Scatterings between light and camera, both parts of the path together")
        ->check(CLI::Range(2, kMaxJoinedDepth));
    tool.app
        .add_option_function<std::string>(
            "--blur", [&o](const std::string& text) { o.inject.blur = cli::parse_blur(text); },
            "Radius of the disc on which deposits are moved, and later reads, in metres or in "
            "voxels (0.25vox); the estimator energy alone")
        ->type_name("R|Xvox")
        ->default_str("0");
    tool.app
        .add_option(
            "--branches", o.inject.branches,
            "Paths into which a photon is split at the first surface, each with a share of its "
            "flux; the estimator energy alone")
        ->check(CLI::Range(1, kMaxBranches));
    tool.app.add_option("--add", o.add, "Add to this cache of other photons of the same run")
        ->type_name("CACHE");
    tool.add_seed(o.inject.seed);
}

std::string printed(const V3d& v) {
    return fmt::format("{:g} x {:g} x {:g}", v.x, v.y, v.z);
}

void print_info(const std::string& path, cli::Session& session) {
    session.stats().input.push_back(path);
    const LightCache cache = read_cache(path);
    const CacheHeader& h = cache.header;
    uint64_t filled = 0;
    for (size_t v = 0; v + 1 < cache.first.size(); ++v)
        filled += cache.first[v + 1] > cache.first[v];
    std::string ranges;
    for (const PhotonRange& range : h.photons)
        ranges += fmt::format(" {}:{}", range.begin, range.end);
    std::string text = fmt::format("{}: Linespace cache, version {}\n", path, kCacheVersion);
    const auto line = [&](const char* name, const std::string& value) {
        text += fmt::format("  {:<14}{}\n", name, value);
    };
    line("estimator", name_of(h.estimator));
    line("voxels", fmt::format("{} x {} x {} of {} m, {} with light", h.voxels[0], h.voxels[1],
                               h.voxels[2], printed(h.cell), filled));
    line("lower corner", fmt::format("{:g}, {:g}, {:g} m", h.lower.x, h.lower.y, h.lower.z));
    line("patches", fmt::format("{} x {} a face, {} directed shafts a voxel, normals in {} classes",
                                h.patches, h.patches, h.directed(), h.normal_classes));
    line("shafts",
         fmt::format("{} with light, {} bytes in memory", cache.size(), cache.memory_bytes()));
    line("photons", fmt::format("{}:{}", h.photon_count(), ranges));
    line("seed", fmt::format("{}", h.seed));
    line("max depth", fmt::format("{}", h.max_depth));
    line("branches", fmt::format("{}", h.branches));
    line("blur", fmt::format("{} m", h.blur));
    line(h.estimator == Estimator::energy ? "power" : "intensity",
         fmt::format("{:g} {}", h.unit, h.estimator == Estimator::energy ? "W" : "W/sr"));
    line("scene hash", fmt::format("{:016x}", h.scene_hash));
    session.print(text);
    session.stats().result = {{"photons", h.photon_count()},
                              {"shafts", cache.size()},
                              {"voxels", h.voxel_count()},
                              {"filled_voxels", filled},
                              {"memory_bytes", cache.memory_bytes()}};
}

void report(const InjectReport& r, const LightCache& cache, cli::Stats& stats) {
    const double unit = std::ldexp(1.0, -kOrderBits);
    double stored = 0;
    for (size_t i = 0; i < cache.header.weight_by_order.size(); ++i)
        stored += double(cache.header.weight_by_order[i] + cache.header.caustic_by_order[i]) * unit;
    const double watts = cache.header.unit / double(cache.header.photon_count());
    stats.rays = {{"photon", r.photons.rays}};
    stats.seconds["trace"] = r.seconds_tracing;
    stats.seconds["measure"] = r.seconds_measuring;
    stats.result = {{"photons", cache.header.photon_count()},
                    {"vertices", r.photons.vertices},
                    {"deposits", r.photons.deposits},
                    {"gated_deposits", r.photons.gated},
                    {"shafts", cache.size()},
                    {"groups", cache.groups.size()},
                    {"cache_memory_bytes", cache.memory_bytes()},
                    {"measure_lines", r.measure.lines}};
    stats.discarded_samples = r.photons.discarded;
    if (cache.header.estimator != Estimator::energy) return;
    // Light that no shaft took, and light in shafts where no line of the measure met a surface.
    stats.result["stored_flux"] = stored * watts;
    stats.result["unclassified_flux"] =
        (double(cache.header.unclassified) * unit + r.measure.unmeasured_weight) * watts;
    stats.result["unmeasured_shafts"] = r.measure.unmeasured_shafts;
}

// inject() splits photons for the estimator energy alone.
void settle_branches(const cli::Tool& tool, const Options& o, cli::Session& session) {
    if (o.inject.estimator == Estimator::energy) return;
    if (tool.is_given("--branches") && o.inject.branches > 1)
        throw usage_error("--branches is for the estimator energy");
    session.stats().config["branches"] = 1;
}

void run(const cli::Tool& tool, Options& o, cli::Session& session) {
    if (!o.info.empty()) return print_info(o.info, session);
    if (o.scene.paths.empty()) throw usage_error("no scene, expected a glTF file");
    if (o.output.empty()) throw usage_error("--output is required");
    if (o.output != "-") file_format(o.output, FileFormat::exr);
    settle_branches(tool, o, session);
    const std::string date_time = session.image_config().date_time;
    if (o.inject.estimator != Estimator::energy)
        session.warn(
            fmt::format("--estimator {} is not radiometric: brightness depends on the "
                        "unit of length and falls with the number of lights; see ls-inject(1)",
                        name_of(o.inject.estimator)));
    const cli::OpenScene open = cli::open_scene(session, o.scene, cli::LightNeed::required);
    std::unique_ptr<PosedScene> posed;
    {
        const auto timer = session.phase("build");
        posed = std::make_unique<PosedScene>(open.scene, open.space, 0, session.workers());
    }
    // What is to be added must fit before anything is traced.
    const uint64_t hash = scene_hash(open.scene);
    LightCache before;
    if (!o.add.empty()) {
        const auto timer = session.phase("load");
        session.stats().input.push_back(o.add);
        before = read_cache(o.add);
        require_mergeable(before.header, inject_header(*posed, hash, o.inject), o.add);
    }
    InjectReport injected;
    LightCache cache =
        inject(*posed, hash, o.inject, session.workers(), session.progress(), injected);
    report(injected, cache, session.stats());
    if (!o.add.empty()) cache = merged(before, cache, o.add);
    {
        const auto timer = session.phase("write");
        session.stats().output.push_back(o.output);
        write_cache(o.output, cache, date_time);
    }
    if (injected.photons.discarded > 0)
        session.warn(fmt::format("{} photons became infinite or too bright and ended there",
                                 injected.photons.discarded));
}

} // namespace

int main(int argc, char** argv) {
    cli::Tool tool({"ls-inject", "Traces photons through a glTF scene into a Linespace cache.",
                    "ls-inject scene.gltf --photons 2e6 --voxels 25x25x25 -o cache.exr"});
    Options options;
    declare(tool, options);
    return tool.main(argc, argv, [&](cli::Session& session) { run(tool, options, session); });
}
