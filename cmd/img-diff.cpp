// img-diff: error figures of an image against a reference, with limits for tests.
#include "cli/figures.h"
#include "cli/image_options.h"
#include "cli/limits.h"
#include "image/frame_range.h"
#include "metrics/error.h"
#include "metrics/false_color.h"
#include "metrics/tiles.h"

#include <cmath>

using namespace ql;

namespace {

struct Options {
    std::string image, reference;
    cli::ImageSelection selection;
    ErrorConfig error;
    std::vector<cli::Limit> limits;
    std::vector<int> frames; // empty: one pair of images
    std::string heatmap, tiles;
    int tile_px = 16;
    std::vector<double> heatmap_range = {0.001, 1};
    bool per_channel = false, identical = false, json = false, csv = false, wrap = false;

    cli::FigureForm form() const {
        return json ? cli::FigureForm::json : csv ? cli::FigureForm::csv : cli::FigureForm::text;
    }
};

cli::Figures named(const ErrorFigures& f, const std::string& prefix) {
    cli::Figures figures = {{"mse", f.mse},
                            {"rmse", f.rmse},
                            {"relmse", f.relmse},
                            {"block_relmse", f.block_relmse},
                            {"mean_ratio", f.mean_ratio},
                            {"mean_image", f.mean_image},
                            {"mean_reference", f.mean_reference},
                            {"psnr_db", f.psnr_db},
                            {"max_abs", f.max_abs},
                            {"samples", double(f.samples)},
                            {"non_finite", double(f.non_finite)}};
    for (const PerceptualError& p : f.perceptual)
        figures.emplace_back(fmt::format("perceptual_{}px", p.sigma_px), p.mse);
    for (auto& [name, value] : figures)
        name = prefix + name;
    return figures;
}

using Labels = std::vector<std::pair<std::string, std::string>>;

Labels labels(const Options& options) {
    return {{"image", options.image}, {"reference", options.reference}};
}

std::vector<ChannelPair> channel_pairs(const Image& image, const Image& reference) {
    std::vector<ChannelPair> pairs;
    for (const Plane<float>& plane : reference.planes)
        pairs.push_back({image.find(plane.name), &plane.pixels});
    return pairs;
}

// The first sample that is not finite, for the message.
std::string first_non_finite(const Image& image, const std::string& path) {
    try {
        require_finite(image, path);
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

void require_same_shape(const Image& image, const Image& reference, const Options& options) {
    if (image.width != reference.width || image.height != reference.height)
        throw input_error("{}: {} x {} pixels, expected {} x {} as in {}", options.image,
                          image.width, image.height, reference.width, reference.height,
                          options.reference);
}

struct Pair {
    Image image, reference;
};

Pair read_pair(const Options& options, cli::Session& session) {
    Pair pair;
    pair.reference = read_selected(session, options.reference, options.selection, NonFinite::keep);
    cli::ImageSelection same = options.selection;
    same.layer.clear();
    same.channels.clear();
    for (const Plane<float>& plane : pair.reference.planes)
        same.channels.push_back(plane.name);
    pair.image = read_selected(session, options.image, same, NonFinite::keep);
    require_same_shape(pair.image, pair.reference, options);
    return pair;
}

cli::Figures compared(const Pair& pair, const std::vector<ChannelPair>& channels,
                      const Options& options, cli::Session& session) {
    const auto timer = session.phase("compare");
    cli::Figures figures = named(error_figures(channels, options.error, session.workers()), "");
    for (size_t c = 0; options.per_channel && c < channels.size(); ++c) {
        const cli::Figures one =
            named(error_figures(std::span(&channels[c], 1), options.error, session.workers()),
                  pair.reference.planes[c].name + ".");
        figures.insert(figures.end(), one.begin(), one.end());
    }
    return figures;
}

// One pair of images: its figures, its picture, its part in the tiles and the limits.
cli::Figures compare(const Options& options, cli::Session& session,
                     std::optional<TileErrors>& tiles) {
    const Pair pair = read_pair(options, session);
    const std::vector<ChannelPair> channels = channel_pairs(pair.image, pair.reference);
    const cli::Figures figures = compared(pair, channels, options, session);
    if (!options.tiles.empty()) {
        const auto timer = session.phase("compare");
        if (!tiles)
            tiles.emplace(
                TileConfig{options.tile_px, options.error.sigmas_px, options.error.border},
                pair.reference.width, pair.reference.height);
        tiles->add(channels, session.workers());
    }
    if (!options.heatmap.empty())
        session.write_image(options.heatmap,
                            heat_picture(relative_error(channels, session.workers()),
                                         options.heatmap_range[0], options.heatmap_range[1]),
                            session.image_config());
    check_limits(figures, options.limits, session);
    for (const auto& [pixels, path] :
         {std::pair(&pair.image, &options.image), std::pair(&pair.reference, &options.reference)})
        if (const std::string what = first_non_finite(*pixels, *path); !what.empty())
            session.fail_check(what);
    return figures;
}

// Without --frames one pair, else one for each frame; figures are said as they come.
void compare_all(const Options& options, cli::Session& session) {
    std::optional<TileErrors> tiles;
    cli::Json objects = cli::Json::array();
    const std::vector<int> once = {0};
    for (const int frame : options.frames.empty() ? once : options.frames) {
        Options one = options;
        cli::Figures figures;
        if (!options.frames.empty()) {
            for (std::string* path : {&one.image, &one.reference, &one.heatmap})
                *path = numbered_path(*path, frame);
            figures.emplace_back("frame", frame);
        }
        const cli::Figures measured = compare(one, session, tiles);
        figures.insert(figures.end(), measured.begin(), measured.end());
        std::string text = cli::formatted(figures, options.form(), labels(one));
        if (options.csv && !objects.empty()) text.erase(0, text.find('\n') + 1); // one header
        if (options.frames.empty() || !options.json) session.print(text);
        objects.push_back(cli::as_json(figures));
        for (const auto& [name, label] : labels(one))
            if (options.json) objects.back()[name] = label;
    }
    if (!options.frames.empty() && options.json) session.print(cli::json_text(objects));
    session.stats().result =
        options.frames.empty() ? objects.front() : cli::Json{{"frames", std::move(objects)}};
    if (tiles)
        session.write_text(options.tiles, tile_table(tiles->figures(), options.error.sigmas_px));
}

void compare_bits(const Options& options, cli::Session& session) {
    const ImageReadConfig keep{.non_finite = NonFinite::keep};
    const std::vector<Image> parts = session.read_image_parts(options.image, keep);
    const std::vector<Image> others = session.read_image_parts(options.reference, keep);
    if (parts.size() != others.size())
        throw input_error("{}: {} parts, expected {} as in {}", options.image, parts.size(),
                          others.size(), options.reference);
    size_t count = 0;
    for (size_t i = 0; i < parts.size(); ++i) {
        require_same_shape(parts[i], others[i], options);
        if (parts[i].channel_names() != others[i].channel_names() ||
            parts[i].planes.size() != others[i].planes.size())
            throw input_error("{}: channels {}, expected {} as in {}", options.image,
                              parts[i].channel_names(), others[i].channel_names(),
                              options.reference);
        count += differing_samples(parts[i], others[i]);
        if (const std::string what = first_non_finite(parts[i], options.image); !what.empty())
            session.fail_check(what);
    }
    const cli::Figures figures = {{"differing_samples", double(count)}};
    session.stats().result = cli::as_json(figures);
    session.print(cli::formatted(figures, options.form(), labels(options)));
    if (count > 0) session.fail_check(fmt::format("{} samples differ", count));
}

void add_options(cli::Tool& tool, Options& options) {
    auto& app = tool.app;
    app.add_option("IMAGE", options.image, "Image to judge, EXR or PNG; - is standard input")
        ->required();
    app.add_option("REFERENCE", options.reference, "What it should be")->required();
    add_image_selection(tool, options.selection);
    app.add_option("--sigma", options.error.sigmas_px,
                   "Gaussian of the perceptual error in pixels, 0..1000; may be repeated")
        ->type_name("PX")
        ->allow_extra_args(false);
    app.add_option_function<std::string>(
           "--frames", [&](const std::string& text) { options.frames = parse_frame_range(text); },
           "Frames to judge, A-B or A-BxS: names are numbered with %04d")
        ->type_name("RANGE");
    app.add_flag("--wrap", options.wrap, "Tileable images: the Gaussian wraps around");
    app.add_option("--peak", options.error.peak, "White of psnr_db")->type_name("VALUE");
    app.add_flag("--per-channel", options.per_channel, "Every figure also for each channel");
    auto* heatmap =
        app.add_option("--heatmap", options.heatmap, "False-colour picture of the relative error");
    heatmap->type_name("FILE");
    app.add_option_function<std::string>(
           "--heatmap-range",
           [&](const std::string& text) {
               options.heatmap_range = cli::parse_numbers(text, 2, "--heatmap-range");
               if (!(options.heatmap_range[0] > 0 &&
                     options.heatmap_range[1] > options.heatmap_range[0]))
                   throw usage_error("--heatmap-range: '{}', expected 0 < LO < HI", text);
           },
           "Relative errors at the ends of the colour scale (logarithmic)")
        ->type_name("LO,HI")
        ->needs(heatmap)
        ->default_str("0.001,1");
    auto* tiles = app.add_option("--tiles", options.tiles,
                                 "Errors by tile as CSV, means over all frames compared");
    tiles->type_name("FILE");
    app.add_option("--tile", options.tile_px, "Side of these tiles in pixels")
        ->check(CLI::Range(1, 1 << 20))
        ->needs(tiles);
    auto* json = app.add_flag("--json", options.json, "Figures as a JSON object");
    app.add_flag("--csv", options.csv, "Figures as CSV, a header and a row")->excludes(json);
    cli::add_limits(tool, options.limits);
    auto* identical =
        app.add_flag("--identical", options.identical,
                     "Only whether all samples of all channels and parts are equal bit for bit");
    for (auto* other : app.get_options([](const CLI::Option* option) {
             return option->nonpositional() && option->get_group() != "Common" &&
                    option->get_name() != "--help";
         }))
        if (other != identical && !other->check_name("--json") && !other->check_name("--csv") &&
            !other->check_name("--help"))
            identical->excludes(other);
}

void run(Options options, cli::Session& session) {
    if (options.image == "-" && options.reference == "-")
        throw usage_error("only one image can come from standard input");
    for (const std::string& path : {options.image, options.heatmap})
        if (options.frames.size() > 1 && !path.empty() && !is_numbered(path))
            throw usage_error("{}: {} frames need a numbered name such as frame.%04d.exr", path,
                              options.frames.size());
    options.error.border = options.wrap ? Border::wrap : Border::mirror;
    if (options.identical)
        compare_bits(options, session);
    else
        compare_all(options, session);
}

} // namespace

int main(int argc, char** argv) {
    cli::Tool tool({"img-diff", "Measures how far an image is from a reference.",
                    "img-diff --max-relmse 0.01 image.exr reference.exr"});
    Options options;
    add_options(tool, options);
    return tool.main(argc, argv, [&](cli::Session& session) { run(options, session); });
}
