// bn-permute: the seed texture of the next frame, from a frame by any renderer and its seeds.
#include "cli/permute_options.h"

#include <algorithm>
#include <cmath>

using namespace ql;

namespace {

struct Options {
    std::string image, seeds, motion, depth, next, similar, albedo, output;
    int64_t frame = 0;
    cli::PermuteOptions permute;
    uint64_t seed = 0;
    FileFormat format = FileFormat::by_extension;
};

void add_options(cli::Tool& tool, Options& options) {
    const auto file = [&](const char* name, auto& path, const char* what) {
        return tool.app.add_option(name, path, what)->type_name("FILE");
    };
    file("--image", options.image, "Frame as rendered: linear, not accumulated")->required();
    cli::add_permute_options(tool, options.permute)->required();
    file("--seeds", options.seeds, "Seeds of the frame, channel seed; without: fresh ones");
    tool.app.add_option("--frame", options.frame, "Number of the frame")
        ->check(CLI::Range(int64_t(0), int64_t(1'000'000'000)));
    file("--motion", options.motion,
         "Motion to the next frame, channels motion.X motion.Y, pixels");
    file("--depth", options.depth, "Depth Z with camera matrices in the header; needs --next");
    file("--next", options.next, "Any image with the next frame's camera matrices");
    file("--similar", options.similar,
         "Sort only among similar surfaces: channels id, N.X N.Y N.Z, albedo.R albedo.G albedo.B");
    file("--albedo", options.albedo,
         "Sort intensity over albedo: channels albedo.R albedo.G albedo.B");
    tool.add_seed(options.seed);
    tool.add_output(options.output, "Seeds of the next frame, .exr");
    tool.add_format(options.format);
}

void check_combination(const Options& options) {
    const bool moving = !options.motion.empty() || !options.depth.empty();
    const bool follows = options.permute.config.reproject != ReprojectMode::off;
    if (follows && !moving) throw usage_error("--reproject needs --motion, or --depth and --next");
    if (!follows && moving)
        throw usage_error("--motion and --depth need --reproject image or tile");
    if (!options.motion.empty() && !options.depth.empty())
        throw usage_error("--motion and --depth exclude each other");
    if (options.depth.empty() != options.next.empty())
        throw usage_error("--depth and --next need each other");
    if (file_format(options.output, options.format) != FileFormat::exr)
        throw usage_error("{}: seeds are written as EXR", options.output);
}

// Puts the names of files in front of what is wrong with them.
template<class Work>
auto about(const std::string& files, const Work& work) {
    try {
        return work();
    } catch (const Error& error) {
        if (error.kind() != ErrorKind::input || files.empty()) throw;
        throw Error(error.kind(), files + ": " + error.what());
    }
}

void check_size(const Image& image, int width, int height, const std::string& path) {
    if (image.width != width || image.height != height)
        throw input_error("{}: {} x {} pixels, expected {} x {}", path, image.width, image.height,
                          width, height);
}

const Imath::M44f& matrix(const Image& image, const char* key, const std::string& path) {
    if (const auto* m = image.find_metadata<Imath::M44f>(key)) return *m;
    throw input_error("no {} in the header of {}", key, path);
}

// Depth of pixels without a surface may be infinite, and so may channels that nobody asked for.
ImageReadConfig guide_config() {
    ImageReadConfig config;
    config.non_finite = NonFinite::keep;
    return config;
}

std::optional<MotionPlanes> read_motion(const Options& options, int width, int height,
                                        cli::Session& session) {
    if (!options.motion.empty()) {
        const Image image = session.read_image(options.motion, guide_config());
        check_size(image, width, height, options.motion);
        const auto motion = motion_planes(image);
        if (!motion)
            throw input_error("{}: channels {}, expected motion.X and motion.Y", options.motion,
                              image.channel_names());
        return motion;
    }
    if (options.depth.empty()) return std::nullopt;
    const Image image = session.read_image(options.depth, guide_config());
    check_size(image, width, height, options.depth);
    const Array2D<float>* depth = image.find("Z");
    if (!depth)
        throw input_error("{}: channels {}, expected Z", options.depth, image.channel_names());
    const Image next = session.read_image(options.next, guide_config());
    return about(options.depth, [&] {
        return camera_motion(*depth, matrix(image, "worldToCamera", options.depth),
                             matrix(image, "worldToNDC", options.depth),
                             matrix(next, "worldToNDC", options.next));
    });
}

Array2D<uint32_t> read_surfaces(const Options& options, int width, int height,
                                cli::Session& session) {
    if (options.similar.empty()) return {};
    const Image image = session.read_image(options.similar, guide_config());
    check_size(image, width, height, options.similar);
    Array2D<uint32_t> surfaces = surface_numbers(image);
    if (surfaces.empty())
        throw input_error("{}: channels {}, expected id, N.X N.Y N.Z or albedo.R albedo.G albedo.B",
                          options.similar, image.channel_names());
    return surfaces;
}

Array2D<float> read_intensity(const Options& options, const Image& image, cli::Session& session) {
    const Array2D<float> intensity = intensity_plane(image, options.image);
    for (size_t i = 0; i < intensity.size(); ++i)
        if (!std::isfinite(intensity[i]))
            throw input_error("{}: pixel {},{} is {}, expected finite values", options.image,
                              i % size_t(image.width), i / size_t(image.width), intensity[i]);
    if (options.albedo.empty()) return intensity;
    const Image albedo = session.read_image(options.albedo, guide_config());
    check_size(albedo, image.width, image.height, options.albedo);
    return demodulated(intensity, albedo, options.albedo);
}

Array2D<uint32_t> read_seeds(const Options& options, const Permuter& permuter,
                             cli::Session& session) {
    if (options.seeds.empty()) return permuter.fresh_seeds(options.frame);
    const Array2D<uint32_t> seeds = cli::read_seeds(session, options.seeds);
    return about(options.seeds, [&] { return permuter.padded_seeds(seeds, options.frame); });
}

bool is_permutation_of(const Array2D<uint32_t>& a, const Array2D<uint32_t>& b) {
    std::vector<uint32_t> left = a.values(), right = b.values();
    std::sort(left.begin(), left.end());
    std::sort(right.begin(), right.end());
    return left == right;
}

void run(Options& options, cli::Session& session) {
    check_combination(options);

    // Read the frame, the mask and the textures
    const Image image = session.read_image(options.image, guide_config());
    const Array2D<float> intensity = read_intensity(options, image, session);
    cli::PermuteInputs inputs = cli::read_permute_inputs(session, options.permute);
    inputs.config.seed = options.seed;
    const std::string files = fmt::format("{}", fmt::join(options.permute.retarget, ", "));
    const Permuter permuter = about(files, [&] {
        return Permuter(inputs.mask, std::move(inputs.textures), inputs.config, image.width,
                        image.height);
    });
    const Array2D<uint32_t> seeds = read_seeds(options, permuter, session);
    const auto motion = read_motion(options, image.width, image.height, session);
    const FrameGuides guides{&intensity, motion ? &*motion : nullptr,
                             read_surfaces(options, image.width, image.height, session)};

    // Permute
    Image result(permuter.padded_width(), permuter.padded_height());
    {
        const auto timer = session.phase("permute");
        result.uint_plane("seed") =
            permuter.next_seeds(seeds, options.frame, guides, session.workers());
    }
    const Array2D<uint32_t>& next = *result.find_uint("seed");
    const int refresh = inputs.config.refresh_frames;
    const bool refreshed = refresh > 0 && (options.frame + 1) % refresh == 0;
    const bool bijection = is_permutation_of(seeds, next);
    QL_CHECK(bijection || refreshed);

    // Write the seeds
    result.metadata["ql:frame"] = int(options.frame + 1);
    result.metadata["ql:image_size"] = fmt::format("{}x{}", image.width, image.height);
    ImageWriteConfig write = session.image_config();
    write.format = options.format;
    session.write_image(options.output, result, write);
    const Imath::V2i step = retarget_step(inputs.config.offsets, options.frame);
    const Imath::V2i shift = permuter.image_motion(guides);
    cli::Json& json = session.stats().result;
    json["bijection"] = bijection;
    json["refreshed"] = refreshed;
    json["padded_size"] = {permuter.padded_width(), permuter.padded_height()};
    json["mask_step"] = {step.x, step.y};
    json["image_motion"] = {shift.x, shift.y};
}

} // namespace

int main(int argc, char** argv) {
    cli::Tool tool({"bn-permute",
                    "Moves the seeds of a frame so that the next frame's error is blue noise.",
                    "bn-permute --image 0007.exr --seeds s7.exr --mask mask.png --retarget r.exr "
                    "--frame 7 -o s8.exr"});
    Options options;
    add_options(tool, options);
    return tool.main(argc, argv, [&](cli::Session& session) { run(options, session); });
}
