// rsm-render: direct light and one diffuse bounce from reflective shadow maps.
#include "cli/render_output.h"
#include "cli/rsm_options.h"
#include "cli/scene_options.h"
#include "image/frame_range.h"
#include "render/path_tracer.h"
#include "rsm/map_image.h"

#include <chrono>
#include <memory>

namespace {

using namespace ql;

struct Options {
    cli::SceneOptions scene;
    cli::RsmOptions rsm;
    cli::RenderOutput output;
    bool strict = false;
};

void declare(cli::Tool& tool, Options& o) {
    cli::add_scene_options(tool, o.scene);
    cli::add_frame_options(tool, o.scene);
    cli::add_render_output(tool, o.output, "Image, .exr or .png, numbered by %04d");
    cli::add_rsm_options(tool, o.rsm);
    tool.app.add_flag("--strict", o.strict, "Samples that are not finite are an error");
}

void check_lights(const Options& o, const PosedScene& posed, cli::Session& session) {
    const std::string& path = o.scene.paths.front();
    const std::vector<MapLight> lights = map_lights(posed);
    if (const size_t emitters = posed.lights().emitter_count(); emitters > 0)
        session.warn(fmt::format("{}: {} emissive triangles and shapes are shown but light nothing "
                                 "(see bn-render)",
                                 path, emitters));
    if (lights.empty() && !o.scene.allow_dark)
        throw input_error("{}: no point, spot or directional light that shines (--allow-dark "
                          "renders it all the same)",
                          path);
    const size_t faces = o.rsm.config.map.kind == MapKind::perspective ? 6 : 1;
    size_t maps = 0;
    for (const MapLight& light : lights)
        maps += light.kind == Light::Kind::point ? faces : 1;
    const double gib = double(maps * map_bytes(o.rsm.config.map.size)) / double(1 << 30);
    if (gib > o.rsm.max_memory_gib)
        throw usage_error("{} maps of {} x {} texels take about {:.2g} GiB, --max-memory allows {}",
                          maps, o.rsm.config.map.size, o.rsm.config.map.size, gib,
                          o.rsm.max_memory_gib);
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
        if (o.rsm.config.map.measure == FluxMeasure::watts)
            entry["flux_watts"] = {map.flux.x * watts, map.flux.y * watts, map.flux.z * watts};
        maps.push_back(entry);
    }
    stats.result["maps"] = maps;
    stats.result["passes"] = renderer.passes();
    if (o.rsm.config.measure == RayMeasure::on) {
        const double gather = double(total.gather_ns) * 1e-9, bare = double(total.bare_ns) * 1e-9;
        stats.result["measured_rays"] = {{"gather_seconds", gather},
                                         {"bare_seconds", bare},
                                         {"share_of_bare", gather > 0 ? bare / gather : 0.0}};
    }
    stats.result["interpolated_share"] =
        total.lit_pixels > 0 ? double(total.interpolated_pixels) / double(total.lit_pixels) : 0.0;
}

Metadata settings(const Options& o, int passes, int frame) {
    Metadata m;
    m["ql:frame"] = frame;
    m["ql:passes"] = passes;
    m["ql:rsm_size"] = o.rsm.config.map.size;
    m["ql:seed"] = std::to_string(o.rsm.config.seed);
    return m;
}

void render_one(const Options& o, const cli::OpenScene& open, const PosedScene& posed, int frame,
                RsmCounts& total, cli::Session& session) {
    using Clock = std::chrono::steady_clock;
    const PixelCamera camera =
        pixel_camera(open.camera, open.scene, open.space, frame / o.scene.fps, o.scene.size.width,
                     o.scene.size.height, posed.world().bounds);
    RsmConfig config = o.rsm.config;
    config.frame = uint32_t(frame);
    config.gather.bound = cli::geometry_bound(o.rsm.clamp, open.space);
    RsmRenderer renderer(posed, camera, o.scene.size.width, o.scene.size.height, config,
                         session.workers(), session.progress());

    // Add passes while there are some to come and time for one more; a variance needs two.
    const int least_passes = config.aovs & kAovVariance ? 2 : 1;
    const auto begin = Clock::now();
    const auto fits = [&] {
        if (!(o.rsm.time_limit_seconds > 0) || renderer.passes() < least_passes) return true;
        const double seconds = std::chrono::duration<double>(Clock::now() - begin).count();
        return seconds * (1 + 1.0 / renderer.passes()) <= o.rsm.time_limit_seconds;
    };
    while (renderer.passes() < o.rsm.passes && fits()) {
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
    session.write_image(numbered_path(o.output.path, frame), image,
                        cli::image_config(session, o.output));
    if (o.rsm.map_output.empty()) return;
    std::vector<Image> parts = map_images(renderer.maps(), posed.world(), posed.lights().exponent(),
                                          o.rsm.config.map.measure, o.rsm.config.gather.mips);
    if (parts.empty()) {
        session.warn(fmt::format("{}: not written, no light has a map", o.rsm.map_output));
        return;
    }
    if (parts.size() == 1) parts.front().name.clear();
    session.write_image_parts(numbered_path(o.rsm.map_output, frame), parts,
                              session.image_config());
}

void run(const cli::Tool& tool, Options& o, cli::Session& session) {
    cli::settle_rsm_options(tool, o.rsm, session.stats().config);
    cli::check_frame_names(o.scene.frames, {o.output.path, o.rsm.map_output});
    file_format(o.output.path, o.output.format);
    o.rsm.config.mask = cli::rotation_mask(session, o.rsm);
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
