// img-spectrum: the spectrum of an image or of an error, and figures of how blue it is.
#include "cli/figures.h"
#include "cli/image_options.h"
#include "metrics/mask_quality.h"
#include "metrics/spectrum.h"

#include <cmath>

using namespace ql;

namespace {

struct Options {
    std::vector<std::string> images;
    std::string reference;
    cli::ImageSelection selection;
    Window window = Window::none;
    std::vector<double> sigmas_px = {1, 2};
    std::string picture, profile;
    std::vector<double> picture_range = {-40, 20};
    std::vector<cli::Condition> conditions;
    bool mask = false, json = false, csv = false;

    cli::FigureForm form() const {
        return json ? cli::FigureForm::json : csv ? cli::FigureForm::csv : cli::FigureForm::text;
    }
};

// R, G and B become their luminance, unless they are masks that differ; any other channels are
// frames of their own.
std::vector<Array2D<float>> frames_of(Image image, bool are_masks) {
    const auto *r = image.find("R"), *g = image.find("G"), *b = image.find("B");
    std::vector<Array2D<float>> frames;
    const bool is_color = image.planes.size() == 3 && r && g && b;
    if (is_color && (!are_masks || (*r == *g && *g == *b))) {
        Array2D<float>& grey = frames.emplace_back(image.width, image.height);
        for (size_t i = 0; i < grey.size(); ++i)
            grey[i] = luminance((*r)[i], (*g)[i], (*b)[i]);
        return frames;
    }
    for (Plane<float>& plane : image.planes)
        frames.push_back(std::move(plane.pixels));
    return frames;
}

void subtract(std::vector<Array2D<float>>& frames, const std::vector<Array2D<float>>& reference,
              const std::string& path, const std::string& reference_path) {
    if (frames.size() != reference.size() || frames[0].width() != reference[0].width() ||
        frames[0].height() != reference[0].height())
        throw input_error("{}: {} x {} pixels, {} frames, expected {} x {}, {} as in {}", path,
                          frames[0].width(), frames[0].height(), frames.size(),
                          reference[0].width(), reference[0].height(), reference.size(),
                          reference_path);
    for (size_t c = 0; c < frames.size(); ++c)
        for (size_t i = 0; i < frames[c].size(); ++i)
            frames[c][i] -= reference[c][i];
}

std::vector<Array2D<float>> loaded_frames(const Options& options, cli::Session& session) {
    std::vector<Array2D<float>> reference;
    if (!options.reference.empty())
        reference = frames_of(
            read_selected(session, options.reference, options.selection, NonFinite::reject),
            options.mask);
    std::vector<Array2D<float>> all;
    for (const std::string& path : options.images) {
        auto frames = frames_of(read_selected(session, path, options.selection, NonFinite::reject),
                                options.mask);
        if (!reference.empty()) subtract(frames, reference, path, options.reference);
        if (!all.empty() &&
            (frames[0].width() != all[0].width() || frames[0].height() != all[0].height()))
            throw input_error("{}: {} x {} pixels, expected {} x {} as in {}", path,
                              frames[0].width(), frames[0].height(), all[0].width(),
                              all[0].height(), options.images.front());
        std::move(frames.begin(), frames.end(), std::back_inserter(all));
    }
    return all;
}

void add_anisotropy(const Spectrum& spectrum, cli::Figures& figures) {
    double sum = 0, largest = -INFINITY;
    int count = 0;
    for (const RadialBin& bin : radial_profile(spectrum)) {
        if (bin.frequency >= 0.5 || std::isnan(bin.anisotropy)) continue;
        sum += bin.anisotropy;
        largest = std::max(largest, bin.anisotropy);
        ++count;
    }
    figures.emplace_back("anisotropy_mean_db", count ? sum / count : NAN);
    figures.emplace_back("anisotropy_max_db", count ? largest : NAN);
    figures.emplace_back("anisotropy_isotropic_db", 0 - 10 * std::log10(double(spectrum.frames)));
}

cli::Figures spectrum_figures(const Spectrum& spectrum, const Options& options) {
    cli::Figures figures = {{"frames", spectrum.frames},
                            {"mean", spectrum.mean},
                            {"variance", spectrum.variance},
                            {"low_frequency_share", low_frequency_share(spectrum, 0.25)},
                            {"low_frequency_share_8", low_frequency_share(spectrum, 0.125)},
                            {"low_frequency_power", low_frequency_power(spectrum, 0.25)},
                            {"low_frequency_power_8", low_frequency_power(spectrum, 0.125)}};
    for (const double sigma : options.sigmas_px) {
        const FilteredVariance left = filtered_variance(spectrum, sigma);
        figures.emplace_back(fmt::format("filtered_variance_{}px", sigma), left.share);
        figures.emplace_back(fmt::format("filtered_to_white_{}px", sigma), left.to_white);
    }
    for (const auto& [dx, dy] : {std::pair(1, 0), {0, 1}, {1, 1}, {2, 0}, {0, 2}})
        figures.emplace_back(fmt::format("autocorrelation_{}_{}", dx, dy),
                             autocorrelation(spectrum, dx, dy));
    add_anisotropy(spectrum, figures);
    return figures;
}

// Means over the frames: those of one frame for one mask.
void add_mask_figures(const std::vector<Array2D<float>>& frames, const Workers& workers,
                      cli::Figures& figures) {
    cli::Figures sums;
    for (const Array2D<float>& mask : frames) {
        cli::Figures one;
        for (const NamedRms& entry : heaviside_table(rank_values(mask), workers))
            one.emplace_back("heaviside_" + entry.filter, entry.rms);
        const ValueCounts counts = value_counts(mask);
        one.emplace_back("distinct_values", double(counts.distinct));
        one.emplace_back("value_count_min", double(counts.fewest));
        one.emplace_back("value_count_max", double(counts.most));
        one.emplace_back("uniformity_error", counts.uniformity_error);
        const SeamTest seam = seam_test(mask);
        one.emplace_back("seam_horizontal", seam.horizontal);
        one.emplace_back("seam_vertical", seam.vertical);
        if (sums.empty()) sums.assign(one.size(), {"", 0.0});
        for (size_t i = 0; i < one.size(); ++i)
            sums[i] = {one[i].first, sums[i].second + one[i].second / double(frames.size())};
    }
    figures.insert(figures.end(), sums.begin(), sums.end());
}

// Zero frequency in the middle. EXR: the amplitude relative to white noise. PNG: its decibels, from
// black to white over the range.
Image spectrum_picture(const Spectrum& spectrum, const Options& options) {
    const int width = spectrum.power.width(), height = spectrum.power.height();
    const bool linear = file_format(options.picture, FileFormat::by_extension) == FileFormat::exr;
    Image picture(width, height);
    auto& pixels = picture.plane("Y");
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const double power =
                spectrum.power(wrap(x - width / 2, width), wrap(y - height / 2, height)) /
                spectrum.variance;
            const double decibels = 10 * std::log10(power);
            const double share = (decibels - options.picture_range[0]) /
                                 (options.picture_range[1] - options.picture_range[0]);
            pixels(x, y) = std::isnan(power) ? 0
                           : linear          ? float(std::sqrt(power))
                                             : float(std::clamp(share, 0.0, 1.0));
        }
    return picture;
}

std::string profile_text(const Spectrum& spectrum, const Options& options) {
    const std::vector<RadialBin> bins = radial_profile(spectrum);
    if (options.profile.ends_with(".json")) {
        cli::Json rows = cli::Json::array();
        for (const RadialBin& bin : bins) {
            cli::Json row = {{"samples", bin.samples}};
            row.update(cli::as_json({{"frequency", bin.frequency},
                                     {"power", bin.power},
                                     {"anisotropy_db", bin.anisotropy}}));
            rows.push_back(row);
        }
        return cli::json_text(rows);
    }
    std::string text = "frequency,samples,power,anisotropy_db\n";
    for (const RadialBin& bin : bins)
        text += fmt::format("{:.9g},{},{:.9g},{:.9g}\n", bin.frequency, bin.samples, bin.power,
                            bin.anisotropy);
    return text;
}

void run(const Options& options, cli::Session& session) {
    if (!options.picture.empty()) (void)file_format(options.picture, FileFormat::by_extension);
    const std::vector<Array2D<float>> frames = loaded_frames(options, session);
    Spectrum spectrum;
    cli::Figures figures;
    {
        const auto timer = session.phase("analyse");
        spectrum = mean_spectrum(frames, options.window, session.workers());
        figures = spectrum_figures(spectrum, options);
        if (options.mask) add_mask_figures(frames, session.workers(), figures);
    }
    // An unknown name is a usage error before anything is written
    for (const cli::Condition& condition : options.conditions)
        (void)cli::figure_value(figures, condition.name);
    session.stats().result = cli::as_json(figures);
    session.print(cli::formatted(figures, options.form(),
                                 {{"image", fmt::format("{}", fmt::join(options.images, " "))},
                                  {"reference", options.reference}}));
    if (!options.profile.empty())
        session.write_text(options.profile, profile_text(spectrum, options));
    if (!options.picture.empty()) {
        ImageWriteConfig config = session.image_config();
        config.png = PngEncoding::linear8;
        session.write_image(options.picture, spectrum_picture(spectrum, options), config);
    }
    for (const cli::Condition& condition : options.conditions) {
        const double value = cli::figure_value(figures, condition.name);
        if (!cli::holds(value, condition))
            session.fail_check(fmt::format("{} is {:.9g}, expected {} {:.9g}", condition.name,
                                           std::isnan(value) ? double(NAN) : value,
                                           condition.comparison, condition.value));
    }
}

void add_options(cli::Tool& tool, Options& options) {
    auto& app = tool.app;
    app.add_option("IMAGE", options.images, "Images, EXR or PNG; several are averaged")->required();
    app.add_option("--reference", options.reference, "Take the spectrum of IMAGE - FILE")
        ->type_name("FILE");
    add_image_selection(tool, options.selection);
    app.add_option_function<std::string>(
           "--window",
           [&](const std::string& name) {
               options.window = name == "hann" ? Window::hann : Window::none;
           },
           "Window; hann for images that do not tile")
        ->check(CLI::IsMember({"none", "hann"}))
        ->default_str("none");
    app.add_option("--sigma", options.sigmas_px,
                   "Gaussian of the filtered variance in pixels; may be repeated")
        ->type_name("PX")
        ->allow_extra_args(false)
        ->check(CLI::Range(0.0, 1000.0));
    app.add_flag("--mask", options.mask, "Figures of threshold masks too, see img-spectrum(1)");
    auto* picture = app.add_option("--picture", options.picture,
                                   "Write the amplitudes as a picture, .png or .exr");
    picture->type_name("FILE");
    app.add_option_function<std::string>(
           "--picture-range",
           [&](const std::string& text) {
               options.picture_range = cli::parse_numbers(text, 2, "--picture-range");
               if (options.picture_range[0] >= options.picture_range[1])
                   throw usage_error("--picture-range: '{}', expected LO < HI", text);
           },
           "Decibels of black and white in a PNG picture; white noise is 0")
        ->type_name("LO,HI")
        ->needs(picture)
        ->default_str("-40,20");
    app.add_option("--profile", options.profile, "Write the radial profile, .csv or .json")
        ->type_name("FILE");
    auto* json = app.add_flag("--json", options.json, "Figures as a JSON object");
    app.add_flag("--csv", options.csv, "Figures as CSV, a header and a row")->excludes(json);
    app.add_option_function<std::vector<std::string>>(
           "--assert",
           [&](const std::vector<std::string>& texts) {
               for (const std::string& text : texts)
                   options.conditions.push_back(cli::parse_condition(text));
           },
           "Exit with status 1 unless this holds, e.g. 'low_frequency_share<0.02'")
        ->type_name("CONDITION")
        ->allow_extra_args(false);
}

} // namespace

int main(int argc, char** argv) {
    cli::Tool tool({"img-spectrum", "Takes the spectrum of an image or of its error.",
                    "img-spectrum --mask --assert 'low_frequency_share<0.02' mask.png"});
    Options options;
    add_options(tool, options);
    return tool.main(argc, argv, [&](cli::Session& session) { run(options, session); });
}
