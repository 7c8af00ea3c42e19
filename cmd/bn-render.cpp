// bn-render: path-traced frames whose random numbers follow from one 32-bit seed per pixel.
#include "cli/scene_options.h"
#include "cli/tool.h"
#include "image/frame_range.h"
#include "render/path_tracer.h"

#include <memory>

namespace {

using namespace ql;

struct Options {
    cli::SceneOptions scene;
    RenderConfig render;
    bool no_roulette = false;
    std::string output, seeds, seeds_out;
    FileFormat format = FileFormat::by_extension;
    bool half = false;
    float exposure_stops = 0;
    uint64_t seed = 0;
    bool strict = false;
};

void declare(cli::Tool& tool, Options& o) {
    static const std::map<std::string, LightSampling> samplings = {
        {"mis", LightSampling::mis},
        {"lights", LightSampling::lights},
        {"bsdf", LightSampling::bsdf}};
    cli::add_scene_options(tool, o.scene);
    cli::add_frame_options(tool, o.scene);
    tool.add_output(o.output, "Frames, .exr or .png, numbered by %04d");
    tool.add_format(o.format);
    tool.app.add_flag("--half", o.half, "Write 16-bit floats");
    tool.app.add_option("--exposure", o.exposure_stops,
                        "Stops by which PNG pictures are brightened");
    tool.app.add_option("--spp", o.render.spp, "Samples per pixel and frame")
        ->check(CLI::Range(1, 1 << 24));
    tool.app
        .add_option("--max-depth", o.render.path.max_depth,
                    "Scatterings between light and camera; 1 is direct light alone")
        ->check(CLI::Range(1, 1 << 16));
    tool.app
        .add_option("--roulette-depth", o.render.path.roulette_depth,
                    "Scatterings before Russian roulette sets in")
        ->check(CLI::Range(1, 1 << 16));
    tool.app.add_flag("--no-roulette", o.no_roulette, "No Russian roulette");
    tool.app
        .add_option_function<std::string>(
            "--light-sampling",
            [&o](const std::string& name) { o.render.path.light_sampling = samplings.at(name); },
            "mis: both strategies; lights, bsdf: one alone")
        ->check(CLI::IsMember({"mis", "lights", "bsdf"}))
        ->default_str("mis");
    tool.app
        .add_option_function<std::string>(
            "--sky",
            [&o](const std::string& text) {
                const auto v = cli::parse_numbers(text, 3, "--sky");
                if (v[0] < 0 || v[1] < 0 || v[2] < 0)
                    throw usage_error("--sky: '{}', expected values of at least 0", text);
                o.render.path.sky = V3f(float(v[0]), float(v[1]), float(v[2]));
            },
            "Radiance of a uniform surrounding, W/(m^2 sr)")
        ->type_name("R,G,B");
    tool.app
        .add_option_function<std::string>(
            "--aov", [&o](const std::string& names) { o.render.aovs = parse_aovs(names); },
            "More channels: depth, normal, position, albedo, motion, direct, indirect, variance, "
            "id, all")
        ->type_name("NAMES");
    tool.add_seed(o.seed);
    tool.app
        .add_option("--seeds", o.seeds, "Read the seed texture, channel 'seed'; may be numbered")
        ->type_name("FILE");
    tool.app.add_option("--seeds-out", o.seeds_out, "Write the seeds used; may be numbered")
        ->type_name("FILE");
    tool.app.add_flag("--strict", o.strict, "Samples that are not finite are an error");
}

void check(const Options& o) {
    const bool several = o.scene.frames.size() > 1;
    for (const std::string* path : {&o.output, &o.seeds_out})
        if (several && !path->empty() && !is_numbered(*path))
            throw usage_error("{}: {} frames need a numbered name such as frame.%04d.exr", *path,
                              o.scene.frames.size());
    file_format(o.output, o.format);
    if ((o.render.aovs & kAovVariance) && o.render.spp < 2)
        throw usage_error("--aov variance needs --spp 2 or more");
}

Array2D<uint32_t> seeds_of(const Options& o, cli::Session& session, int frame) {
    const auto [width, height] = o.scene.size;
    if (o.seeds.empty()) return fresh_seeds(o.seed, frame, width, height);
    const std::string path = numbered_path(o.seeds, frame);
    const Image image = session.read_image(path);
    const Array2D<uint32_t>* seeds = image.find_uint("seed");
    if (!seeds)
        throw input_error("{}: channels {}, expected an unsigned channel 'seed'", path,
                          image.channel_names());
    if (image.width != width || image.height != height)
        throw input_error("{}: {}x{} seeds, expected {}x{}", path, image.width, image.height, width,
                          height);
    return *seeds;
}

Image seed_image(const Array2D<uint32_t>& seeds) {
    Image image(seeds.width(), seeds.height());
    image.uint_plane("seed") = seeds;
    return image;
}

void run(Options& o, cli::Session& session) {
    check(o);
    if (o.no_roulette) o.render.path.roulette_depth = 0;
    const bool lit_by_sky = o.render.path.sky != V3f(0, 0, 0);
    const cli::OpenScene open =
        cli::open_scene(session, o.scene,
                        lit_by_sky ? cli::LightNeed::provided_elsewhere : cli::LightNeed::required);
    session.stats().scene["kernel"] = choose_kernel(open.scene).name;
    ImageWriteConfig write = session.image_config();
    write.format = o.format;
    write.depth = o.half ? FloatDepth::half : FloatDepth::float32;
    write.exposure_stops = o.exposure_stops;

    const bool moves = has_moving_surfaces_or_lights(open.scene);
    std::unique_ptr<PosedScene> posed;
    RayCounts rays;
    for (const int frame : o.scene.frames) {
        // Pose the scene; one that does not move keeps its acceleration structure.
        const double time = frame / o.scene.fps;
        const double next_time = (frame + 1) / o.scene.fps;
        if (!posed || moves) {
            const auto timer = session.phase("build");
            posed.reset();
            posed = std::make_unique<PosedScene>(open.scene, open.space, time, session.workers());
        }
        const auto camera_at = [&](double t) {
            return pixel_camera(open.camera, open.scene, open.space, t, o.scene.size.width,
                                o.scene.size.height);
        };
        const PixelCamera camera = camera_at(time);
        const PixelCamera next_camera = camera_at(next_time);
        const NextFrame next{next_camera,
                             moves ? world_from_nodes(open.scene, next_time) : std::vector<M44d>()};
        const Array2D<uint32_t> seeds = seeds_of(o, session, frame);

        // Render, then write the frame and the seeds that made it.
        FrameResult result;
        {
            const auto timer = session.phase("render");
            result = render_frame(*posed, camera, seeds, o.render, &next, session.workers(),
                                  session.progress());
        }
        rays.add(result.rays);
        session.stats().discarded_samples += result.discarded_samples;
        if (o.strict && result.discarded_samples > 0)
            throw input_error("{}: {} samples of frame {} are not finite", o.scene.paths.front(),
                              result.discarded_samples, frame);
        result.image.metadata = camera_metadata(camera);
        result.image.metadata["ql:frame"] = frame;
        result.image.metadata["ql:spp"] = o.render.spp;
        result.image.metadata["ql:max_depth"] = o.render.path.max_depth;
        result.image.metadata["ql:seed"] = std::to_string(o.seed);
        session.write_image(numbered_path(o.output, frame), result.image, write);
        if (!o.seeds_out.empty())
            session.write_image(numbered_path(o.seeds_out, frame), seed_image(seeds),
                                session.image_config());
    }
    session.stats().rays = {
        {"camera", rays.camera}, {"indirect", rays.indirect}, {"shadow", rays.shadow}};
    if (session.stats().discarded_samples > 0)
        session.warn(fmt::format("{} samples were not finite and have been left out",
                                 session.stats().discarded_samples));
}

} // namespace

int main(int argc, char** argv) {
    cli::Tool tool({"bn-render", "Path-traces a glTF scene, one 32-bit seed per pixel.",
                    "bn-render scene.gltf --size 640x480 --spp 16 -o image.exr"});
    Options options;
    declare(tool, options);
    return tool.main(argc, argv, [&](cli::Session& session) { run(options, session); });
}
