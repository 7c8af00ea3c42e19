// bn-mask: blue-noise, white-noise and ordered threshold masks.
#include "bluenoise/mask.h"
#include "bluenoise/mask_file.h"
#include "cli/tool.h"

using namespace ql;

namespace {

struct Options {
    std::string method = "void-and-cluster";
    cli::Size size{64, 64};
    double sigma_px = 1.5;
    int channels = 1;
    uint64_t seed = 0;
    double max_memory_gib = 4;
    std::string output;
    FileFormat format = FileFormat::by_extension;
    const CLI::Option* sigma_option = nullptr;
    const CLI::Option* seed_option = nullptr;
};

void add_options(cli::Tool& tool, Options& options) {
    tool.app.add_option("--method", options.method, "How thresholds are arranged")
        ->check(CLI::IsMember({"void-and-cluster", "white", "bayer"}));
    tool.add_size(options.size, "Pixels of the tile, at most 2^24; powers of two for bayer");
    options.sigma_option =
        tool.app.add_option("--sigma", options.sigma_px,
                            "Pixels, 0.3 to 8; void-and-cluster: smaller is bluer, with more "
                            "structure");
    tool.app.add_option("--channels", options.channels, "Independent masks in one file")
        ->check(CLI::Range(1, 4));
    options.seed_option = tool.add_seed(options.seed);
    tool.app.add_option("--max-memory", options.max_memory_gib, "GiB that may be used")
        ->check(CLI::PositiveNumber);
    tool.add_output(options.output, "Mask, .png (16 bit) or .exr (float)");
    tool.add_format(options.format);
}

MaskConfig mask_config(const Options& options) {
    MaskConfig config;
    if (options.method == "white") config.method = MaskMethod::white;
    if (options.method == "bayer") config.method = MaskMethod::bayer;
    config.width = options.size.width;
    config.height = options.size.height;
    config.sigma_px = options.sigma_px;
    config.seed = options.seed;
    check_mask_config(config);
    return config;
}

void check_combination(const Options& options, const MaskConfig& config, FileFormat format) {
    if (config.method != MaskMethod::void_and_cluster && options.sigma_option->count() > 0)
        throw usage_error("--sigma is for void-and-cluster, not for {}", options.method);
    const bool one_only = config.method == MaskMethod::bayer;
    if (one_only && (options.seed_option->count() > 0 || options.channels > 1))
        throw usage_error("there is one Bayer mask of a size: neither --seed nor --channels goes");
    if (format == FileFormat::png && options.channels == 2)
        throw usage_error("PNG holds 1, 3 or 4 channels, not 2; write EXR");
    const size_t n = size_t(config.width) * size_t(config.height);
    const double bytes = double(options.channels) * double(mask_memory_bytes(config) + 16 * n);
    if (bytes > options.max_memory_gib * 0x1p30)
        throw usage_error("{:.2g} GiB are needed, --max-memory allows {}", bytes / 0x1p30,
                          options.max_memory_gib);
}

void run(const Options& options, cli::Session& session) {
    const MaskConfig config = mask_config(options);
    const FileFormat format = file_format(options.output, options.format);
    check_combination(options, config, format);
    const size_t n = size_t(config.width) * size_t(config.height);
    if (format == FileFormat::png && n > 65536)
        session.warn(fmt::format("{} ranks in samples of 16 bit: ranks share samples; EXR keeps "
                                 "them apart",
                                 n));

    std::vector<Array2D<uint32_t>> channels(size_t(options.channels));
    {
        const auto timer = session.phase("build");
        session.progress().start("ranks", n * channels.size());
        session.workers().for_each(channels.size(), [&](size_t c) {
            MaskConfig channel = config;
            channel.channel = uint32_t(c);
            channels[c] = mask_ranks(channel, session.progress());
        });
        session.progress().finish();
    }
    ImageWriteConfig write = session.image_config();
    write.format = options.format;
    write.png = PngEncoding::linear16;
    const auto samples = format == FileFormat::png ? MaskSamples::bits16 : MaskSamples::exact;
    session.write_image(options.output, mask_image(channels, config, samples), write);

    cli::Json& result = session.stats().result;
    result["ranks"] = n;
    result["channels"] = channels.size();
    result["hash"] = cli::Json::array();
    for (const auto& channel : channels)
        result["hash"].push_back(mask_hash(channel));
}

} // namespace

int main(int argc, char** argv) {
    cli::Tool tool({"bn-mask", "Makes a threshold mask: a tile of ranks that repeats without seam.",
                    "bn-mask --size 128x128 --sigma 1.2 -o mask.png"});
    Options options;
    add_options(tool, options);
    return tool.main(argc, argv, [&](cli::Session& session) { run(options, session); });
}
