// bn-render: path-traced frames whose random numbers follow from one 32-bit seed per pixel.
#include "cli/choice.h"
#include "cli/path_options.h"
#include "cli/permute_options.h"
#include "cli/render_output.h"
#include "cli/scene_options.h"
#include "cli/tool.h"
#include "distribution/frame_sequence.h"
#include "image/frame_range.h"

#include <memory>
#include <set>

namespace {

using namespace ql;

struct Options {
    cli::SceneOptions scene;
    cli::PermuteOptions permute;
    SequenceConfig sequence;
    bool similar = false, demodulate = false;
    cli::RenderOutput output;
    std::string accumulate, seeds, seeds_out;
    bool strict = false;
};

constexpr double kMaxSky = 1e38; // floats, with room for sums

const std::vector<std::pair<std::string, Distribution>> kDistributions = {
    {"white", Distribution::white},
    {"dithered", Distribution::dithered},
    {"histogram", Distribution::histogram},
    {"temporal", Distribution::temporal}};

void declare(cli::Tool& tool, Options& o) {
    cli::add_scene_options(tool, o.scene);
    cli::add_frame_options(tool, o.scene);
    cli::add_render_output(tool, o.output, "Frames, .exr or .png, numbered by %04d");
    tool.app.add_option("--spp", o.sequence.render.spp, "Samples per pixel and frame")
        ->check(CLI::Range(1, 1 << 24));
    tool.app
        .add_option("--max-depth", o.sequence.render.path.max_depth,
                    "Scatterings between light and camera; 1 is direct light alone")
        ->check(CLI::Range(1, 1 << 16));
    cli::add_path_options(tool, o.sequence.render.path.roulette_depth,
                          o.sequence.render.path.all_lights);
    cli::add_choice<LightSampling>(tool, "--light-sampling", o.sequence.render.path.light_sampling,
                                   {{"mis", LightSampling::mis},
                                    {"lights", LightSampling::lights},
                                    {"bsdf", LightSampling::bsdf}},
                                   "mis: both strategies; lights, bsdf: one alone");
    tool.app
        .add_option_function<std::string>(
            "--sky",
            [&o](const std::string& text) {
                const auto v = cli::parse_numbers(text, 3, "--sky");
                for (const double value : v)
                    if (!(value >= 0 && value <= kMaxSky))
                        throw usage_error("--sky: '{}', expected values from 0 to {:g}", text,
                                          kMaxSky);
                o.sequence.render.path.sky = V3f(float(v[0]), float(v[1]), float(v[2]));
            },
            "Radiance of a uniform surrounding, W/(m^2 sr)")
        ->type_name("R,G,B");
    tool.app
        .add_option_function<std::string>(
            "--aov", [&o](const std::string& names) { o.sequence.render.aovs = parse_aovs(names); },
            "More channels: depth, normal, position, albedo, motion, direct, indirect, variance, "
            "id, all")
        ->type_name("NAMES");
    cli::add_choice(tool, "--distribution", o.sequence.distribution, kDistributions,
                    "How random numbers are given to pixels; all but white need --mask");
    cli::add_permute_options(tool, o.permute);
    tool.app.add_flag("--similar", o.similar,
                      "Sort only among surfaces of similar normal and albedo");
    tool.app.add_flag("--demodulate", o.demodulate, "Sort intensity divided by albedo");
    tool.app
        .add_option("--estimates", o.sequence.estimates,
                    "histogram: estimates per pixel to choose from")
        ->check(CLI::Range(1, 4096));
    tool.app.add_option("--accumulate", o.accumulate, "Write the mean of the frames so far")
        ->type_name("FILE");
    tool.add_seed(o.sequence.seed);
    tool.app
        .add_option("--seeds", o.seeds, "Read the seed texture, channel 'seed'; may be numbered")
        ->type_name("FILE");
    tool.app.add_option("--seeds-out", o.seeds_out, "Write the seeds used; may be numbered")
        ->type_name("FILE");
    tool.app.add_flag("--strict", o.strict, "Samples that are not finite are an error");
}

// Options that would do nothing with this distribution.
void check_distribution(const cli::Tool& tool, Distribution distribution) {
    using D = Distribution;
    static const std::pair<const char*, std::set<D>> kServes[] = {
        {"--mask", {D::dithered, D::histogram, D::temporal}},
        {"--channel", {D::dithered, D::histogram, D::temporal}},
        {"--offsets", {D::dithered, D::histogram, D::temporal}},
        {"--estimates", {D::histogram}},
        {"--retarget", {D::temporal}},
        {"--block", {D::temporal}},
        {"--block-jitter", {D::temporal}},
        {"--reproject", {D::temporal}},
        {"--refresh", {D::temporal}},
        {"--similar", {D::temporal}},
        {"--demodulate", {D::temporal}},
        {"--seeds", {D::white, D::temporal}},
        {"--seeds-out", {D::white, D::histogram, D::temporal}}};
    for (const auto& [option, served] : kServes)
        if (tool.is_given(option) && !served.contains(distribution)) {
            std::string names;
            for (const auto& [name, value] : kDistributions)
                if (served.contains(value)) names += (names.empty() ? "" : ", ") + name;
            throw usage_error("{} is for --distribution {}", option, names);
        }
}

void check(const cli::Tool& tool, const Options& o) {
    check_distribution(tool, o.sequence.distribution);
    cli::check_frame_names(o.scene.frames, {o.output.path, o.seeds_out});
    if (!o.seeds_out.empty() &&
        file_format(o.seeds_out, FileFormat::by_extension) != FileFormat::exr)
        throw usage_error("{}: seeds are written as EXR", o.seeds_out);
    file_format(o.output.path, o.output.format);
    if (!o.accumulate.empty()) file_format(o.accumulate, FileFormat::by_extension);
    if ((o.sequence.render.aovs & kAovVariance) && o.sequence.render.spp < 2)
        throw usage_error("--aov variance needs --spp 2 or more");
    if (o.sequence.distribution == Distribution::white) return;
    if (o.permute.mask.empty()) throw usage_error("--distribution needs --mask, but for white");
    if (o.sequence.distribution != Distribution::temporal) return;
    for (size_t i = 1; i < o.scene.frames.size(); ++i)
        if (o.scene.frames[i] != o.scene.frames[i - 1] + 1)
            throw usage_error("--distribution temporal needs consecutive frames");
}

FrameSequence make_sequence(Options& o, cli::Session& session) {
    std::optional<Mask> mask;
    std::vector<RetargetTexture> textures;
    if (o.sequence.distribution != Distribution::white) {
        cli::PermuteInputs inputs = cli::read_permute_inputs(session, o.permute);
        mask = std::move(inputs.mask);
        textures = std::move(inputs.textures);
        o.sequence.permute = inputs.config;
    }
    if (o.demodulate) o.sequence.demodulate = Demodulate::on;
    if (o.similar) o.sequence.similar = SimilarSurfaces::on;
    return {o.sequence, std::move(mask), std::move(textures), o.scene.size.width,
            o.scene.size.height};
}

// A numbered seed texture sets every frame; another one the first frame of a temporal sequence,
// and every frame where frames do not follow from each other.
void read_frame_seeds(const Options& o, cli::Session& session, int frame, FrameSequence& sequence) {
    const bool follows = o.sequence.distribution == Distribution::temporal &&
                         frame != o.scene.frames.front() && !is_numbered(o.seeds);
    if (o.seeds.empty() || follows) return;
    const std::string path = numbered_path(o.seeds, frame);
    const Array2D<uint32_t> seeds = cli::read_seeds(session, path);
    try {
        sequence.set_seeds(seeds, frame);
    } catch (const Error& error) {
        throw Error(error.kind(), path + ": " + error.what());
    }
}

Image seed_image(const Array2D<uint32_t>& seeds, int frame) {
    Image image(seeds.width(), seeds.height());
    image.uint_plane("seed") = seeds;
    image.metadata["ql:frame"] = frame;
    return image;
}

// The mean of the frames so far; sums in double.
class RunningMean {
  public:
    Image add(const Image& frame) {
        m_sums.resize(3 * size_t(frame.width) * size_t(frame.height));
        ++m_frames;
        Image mean(frame.width, frame.height);
        size_t at = 0;
        for (const char* channel : {"R", "G", "B"}) {
            const Array2D<float>& values = *frame.find(channel);
            Array2D<float>& means = mean.plane(channel);
            for (size_t i = 0; i < values.size(); ++i, ++at)
                means[i] = float((m_sums[at] += double(values[i])) / m_frames);
        }
        return mean;
    }

  private:
    std::vector<double> m_sums;
    int m_frames = 0;
};

void write_frame(const Options& o, cli::Session& session, int frame, FrameResult& result,
                 const PixelCamera& camera, const Array2D<uint32_t>& seeds, RunningMean& mean) {
    result.image.metadata = camera_metadata(camera);
    result.image.metadata["ql:frame"] = frame;
    result.image.metadata["ql:spp"] = o.sequence.render.spp;
    result.image.metadata["ql:max_depth"] = o.sequence.render.path.max_depth;
    result.image.metadata["ql:seed"] = std::to_string(o.sequence.seed);
    ImageWriteConfig write = cli::image_config(session, o.output);
    session.write_image(numbered_path(o.output.path, frame), result.image, write);
    if (!o.seeds_out.empty())
        session.write_image(numbered_path(o.seeds_out, frame), seed_image(seeds, frame),
                            session.image_config());
    if (o.accumulate.empty()) return;
    const Image so_far = mean.add(result.image);
    write.format = FileFormat::by_extension;
    if (is_numbered(o.accumulate) || frame == o.scene.frames.back())
        session.write_image(numbered_path(o.accumulate, frame), so_far, write);
}

bool wants_motion(const Options& o) {
    return (o.sequence.render.aovs & kAovMotion) != 0 ||
           o.sequence.permute.reproject != ReprojectMode::off;
}

void report(cli::Session& session, const RayCounts& rays) {
    session.stats().rays = {
        {"camera", rays.camera}, {"indirect", rays.indirect}, {"shadow", rays.shadow}};
    const uint64_t discarded = session.stats().discarded_samples;
    if (discarded > 0)
        session.warn(fmt::format("{} samples were not finite and have been left out", discarded));
}

void run(const cli::Tool& tool, Options& o, cli::Session& session) {
    check(tool, o);
    const bool lit_by_sky = o.sequence.render.path.sky != V3f(0, 0, 0);
    const cli::OpenScene open =
        cli::open_scene(session, o.scene,
                        lit_by_sky ? cli::LightNeed::provided_elsewhere : cli::LightNeed::required);
    session.stats().scene["kernel"] = choose_kernel(open.scene).name;
    FrameSequence sequence = make_sequence(o, session);
    const bool moves = has_moving_surfaces_or_lights(open.scene);
    std::unique_ptr<PosedScene> posed;
    RunningMean mean;
    RayCounts rays;
    int motion_transforms = 0; // of all nodes
    for (const int frame : o.scene.frames) {
        // Pose the scene; one that does not move keeps its acceleration structure.
        const double time = frame / o.scene.fps, next_time = (frame + 1) / o.scene.fps;
        if (!posed || moves) {
            const auto timer = session.phase("build");
            posed.reset();
            posed = std::make_unique<PosedScene>(open.scene, open.space, time, session.workers());
        }
        const auto [width, height] = o.scene.size;
        const PixelCamera camera = pixel_camera(open.camera, open.scene, open.space, time, width,
                                                height, posed->world().bounds);
        const PixelCamera next_camera =
            pixel_camera(open.camera, open.scene, open.space, next_time, width, height);
        NextFrame next{next_camera, {}};
        if (moves && wants_motion(o)) {
            next.world_from_node = world_from_nodes(open.scene, next_time);
            ++motion_transforms;
        }

        // Render with the frame's seeds, write, and permute the seeds for the frame that follows.
        read_frame_seeds(o, session, frame, sequence);
        FrameResult result;
        {
            const auto timer = session.phase("render");
            result = sequence.render({*posed, camera, next, frame}, session.workers(),
                                     session.progress());
        }
        rays.add(result.rays);
        session.stats().discarded_samples += result.discarded_samples;
        if (o.strict && result.discarded_samples > 0)
            throw input_error("{}: {} samples of frame {} are not finite", o.scene.paths.front(),
                              result.discarded_samples, frame);
        write_frame(o, session, frame, result, camera, sequence.seeds(), mean);
        if (o.sequence.distribution == Distribution::temporal && frame != o.scene.frames.back()) {
            const auto timer = session.phase("permute");
            sequence.prepare_next(session.workers());
        }
    }
    session.stats().result["motion_transforms"] = motion_transforms;
    report(session, rays);
}

} // namespace

int main(int argc, char** argv) {
    cli::Tool tool({"bn-render", "Path-traces a glTF scene, one 32-bit seed per pixel.",
                    "bn-render scene.gltf --size 640x480 --spp 16 -o image.exr"});
    Options options;
    declare(tool, options);
    return tool.main(argc, argv, [&](cli::Session& session) { run(tool, options, session); });
}
