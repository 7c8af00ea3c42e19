// img-diff: error figures of an image against a reference, with limits for tests.
#include "cli/figures.h"
#include "cli/image_options.h"
#include "metrics/error.h"
#include "metrics/false_color.h"

#include <bit>
#include <cmath>

using namespace ql;

namespace {

struct Limit {
    std::string option;
    std::string figure; // its name, or the stem of several: perceptual_
    enum class Side { at_most, at_least } side;
    double value;
};

struct Options {
    std::string image, reference;
    cli::ImageSelection selection;
    ErrorConfig error;
    std::vector<Limit> limits;
    std::string heatmap;
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

std::vector<std::pair<std::string, std::string>> labels(const Options& options) {
    return {{"image", options.image}, {"reference", options.reference}};
}

void check_limits(const cli::Figures& figures, const Options& options, cli::Session& session) {
    for (const Limit& limit : options.limits)
        for (const auto& [name, value] : figures) {
            const bool stem = limit.figure.ends_with('_') && name.starts_with(limit.figure);
            if (name != limit.figure && !stem) continue;
            // Written so that NaN fails
            const bool above = limit.side == Limit::Side::at_most;
            const bool holds = above ? value <= limit.value : value >= limit.value;
            if (!holds)
                session.fail_check(fmt::format("{} is {:.9g}, {} {} {:.9g}", name, value,
                                               above ? "above" : "below", limit.option,
                                               limit.value));
        }
}

std::vector<ChannelPair> channel_pairs(const Image& image, const Image& reference) {
    std::vector<ChannelPair> pairs;
    for (const Plane<float>& plane : reference.planes)
        pairs.push_back({image.find(plane.name), &plane.pixels});
    return pairs;
}

Image heat_picture(std::span<const ChannelPair> pairs, const Options& options,
                   const Workers& workers) {
    const Array2D<float> error = relative_error(pairs, workers);
    const double low = std::log(options.heatmap_range[0]);
    const double high = std::log(options.heatmap_range[1]);
    Image picture(error.width(), error.height());
    auto &r = picture.plane("R"), &g = picture.plane("G"), &b = picture.plane("B");
    for (size_t i = 0; i < error.size(); ++i) {
        const double t = (std::log(double(error[i])) - low) / (high - low);
        const Imath::V3f color = false_color(float(t));
        r[i] = color.x, g[i] = color.y, b[i] = color.z;
    }
    return picture;
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

void compare(const Options& options, cli::Session& session) {
    const Image reference =
        read_selected(session, options.reference, options.selection, NonFinite::keep);
    cli::ImageSelection same = options.selection;
    same.layer.clear();
    same.channels.clear();
    for (const Plane<float>& plane : reference.planes)
        same.channels.push_back(plane.name);
    const Image image = read_selected(session, options.image, same, NonFinite::keep);
    require_same_shape(image, reference, options);

    cli::Figures figures;
    const std::vector<ChannelPair> pairs = channel_pairs(image, reference);
    {
        const auto timer = session.phase("compare");
        figures = named(error_figures(pairs, options.error, session.workers()), "");
        for (size_t c = 0; options.per_channel && c < pairs.size(); ++c) {
            const cli::Figures one =
                named(error_figures(std::span(&pairs[c], 1), options.error, session.workers()),
                      reference.planes[c].name + ".");
            figures.insert(figures.end(), one.begin(), one.end());
        }
    }
    session.stats().result = cli::as_json(figures);
    session.print(cli::formatted(figures, options.form(), labels(options)));
    if (!options.heatmap.empty())
        session.write_image(options.heatmap, heat_picture(pairs, options, session.workers()),
                            session.image_config());
    check_limits(figures, options, session);
    for (const auto& [pixels, path] :
         {std::pair(&image, &options.image), std::pair(&reference, &options.reference)})
        if (const std::string what = first_non_finite(*pixels, *path); !what.empty())
            session.fail_check(what);
}

template<class Planes>
size_t differing_samples(const Planes& planes, const Planes& others) {
    size_t count = 0;
    for (size_t c = 0; c < planes.size(); ++c)
        for (size_t i = 0; i < planes[c].pixels.size(); ++i)
            count += std::bit_cast<uint32_t>(planes[c].pixels[i]) !=
                     std::bit_cast<uint32_t>(others[c].pixels[i]);
    return count;
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
        count += differing_samples(parts[i].planes, others[i].planes);
        count += differing_samples(parts[i].uint_planes, others[i].uint_planes);
        if (const std::string what = first_non_finite(parts[i], options.image); !what.empty())
            session.fail_check(what);
    }
    const cli::Figures figures = {{"differing_samples", double(count)}};
    session.stats().result = cli::as_json(figures);
    session.print(cli::formatted(figures, options.form(), labels(options)));
    if (count > 0) session.fail_check(fmt::format("{} samples differ", count));
}

void add_limits(cli::Tool& tool, Options& options) {
    const auto add = [&](const std::string& option, const std::string& figure, Limit::Side side) {
        tool.app
            .add_option_function<std::string>(
                option,
                [&options, option, figure, side](const std::string& text) {
                    const double value = cli::parse_numbers(text, 1, option)[0];
                    options.limits.push_back({option, figure, side, value});
                },
                fmt::format("Fail if {} is {}", figure,
                            side == Limit::Side::at_most ? "above" : "below"))
            ->type_name("LIMIT")
            ->group("Limits (exit status 1)");
    };
    add("--max-mse", "mse", Limit::Side::at_most);
    add("--max-rmse", "rmse", Limit::Side::at_most);
    add("--max-relmse", "relmse", Limit::Side::at_most);
    add("--max-block-relmse", "block_relmse", Limit::Side::at_most);
    add("--max-abs", "max_abs", Limit::Side::at_most);
    add("--max-perceptual", "perceptual_", Limit::Side::at_most);
    add("--min-psnr", "psnr_db", Limit::Side::at_least);
    tool.app
        .add_option_function<std::string>(
            "--mean-ratio",
            [&options](const std::string& text) {
                const auto range = cli::parse_numbers(text, 2, "--mean-ratio");
                options.limits.push_back(
                    {"--mean-ratio", "mean_ratio", Limit::Side::at_least, range[0]});
                options.limits.push_back(
                    {"--mean-ratio", "mean_ratio", Limit::Side::at_most, range[1]});
            },
            "Fail if mean_ratio is outside")
        ->type_name("LO,HI")
        ->group("Limits (exit status 1)");
}

void add_options(cli::Tool& tool, Options& options) {
    auto& app = tool.app;
    app.add_option("IMAGE", options.image, "Image to judge, EXR or PNG; - is standard input")
        ->required();
    app.add_option("REFERENCE", options.reference, "What it should be")->required();
    add_image_selection(tool, options.selection);
    app.add_option("--sigma", options.error.sigmas_px,
                   "Gaussian of the perceptual error in pixels, 0..1000; may be repeated")
        ->type_name("PX");
    app.add_flag("--wrap", options.wrap, "Tileable images: the Gaussian wraps around");
    app.add_option("--peak", options.error.peak, "White of psnr_db")->type_name("VALUE");
    app.add_flag("--per-channel", options.per_channel, "Every figure also for each channel");
    app.add_option("--heatmap", options.heatmap, "False-colour picture of the relative error")
        ->type_name("FILE");
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
        ->default_str("0.001,1");
    auto* json = app.add_flag("--json", options.json, "Figures as a JSON object");
    app.add_flag("--csv", options.csv, "Figures as CSV, a header and a row")->excludes(json);
    add_limits(tool, options);
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
    options.error.border = options.wrap ? Border::wrap : Border::mirror;
    if (options.identical)
        compare_bits(options, session);
    else
        compare(options, session);
}

} // namespace

int main(int argc, char** argv) {
    cli::Tool tool({"img-diff", "Measures how far an image is from a reference.",
                    "img-diff --max-relmse 0.01 image.exr reference.exr"});
    Options options;
    add_options(tool, options);
    return tool.main(argc, argv, [&](cli::Session& session) { run(options, session); });
}
