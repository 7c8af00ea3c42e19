#include "cli/image_options.h"

#include "image/atomic_file.h"

#include <cmath>

namespace ql::cli {

namespace {

Image chosen_part(std::vector<Image> parts, const std::string& part, const std::string& path) {
    if (part.empty()) {
        if (parts.size() == 1) return std::move(parts.front());
        throw input_error("{}: {} parts, choose one with --part", input_name(path), parts.size());
    }
    for (size_t i = 0; i < parts.size(); ++i)
        if (parts[i].name == part || fmt::format("{}", i) == part) return std::move(parts[i]);
    throw input_error("{}: no part {} among {}", input_name(path), part, parts.size());
}

std::vector<std::string> chosen_channels(const Image& image, const ImageSelection& selection) {
    if (!selection.channels.empty()) return selection.channels;
    std::vector<std::string> all, colors;
    for (const Plane<float>& plane : image.planes) {
        if (selection.layer.empty() || plane.name.starts_with(selection.layer + "."))
            all.push_back(plane.name);
        if (plane.name == "R" || plane.name == "G" || plane.name == "B")
            colors.push_back(plane.name);
    }
    return selection.layer.empty() && !colors.empty() ? colors : all;
}

Array2D<float> cropped(const Array2D<float>& pixels, const Rectangle& crop) {
    Array2D<float> result(crop.width, crop.height);
    for (int y = 0; y < crop.height; ++y)
        for (int x = 0; x < crop.width; ++x)
            result(x, y) = pixels(crop.x + x, crop.y + y);
    return result;
}

} // namespace

void add_image_selection(Tool& tool, ImageSelection& selection) {
    auto* channels = tool.app
                         .add_option("--channels", selection.channels,
                                     "Channels by name, with commas (default: R,G,B or all)")
                         ->type_name("NAME,...")
                         ->delimiter(',')
                         ->allow_extra_args(false);
    tool.app.add_option("--layer", selection.layer, "All channels NAME.*, such as direct.R")
        ->type_name("NAME")
        ->excludes(channels);
    tool.app.add_option("--part", selection.part, "Part of a multi-part file, from 0 or by name")
        ->type_name("NAME|NUMBER");
    tool.app
        .add_option_function<std::string>(
            "--crop",
            [&selection](const std::string& text) { selection.crop = parse_rectangle(text); },
            "Only this rectangle, in pixels from the upper left corner")
        ->type_name("X,Y,W,H");
}

Image read_selected(Session& session, const std::string& path, const ImageSelection& selection,
                    NonFinite non_finite) {
    // Channels that were not asked for may hold what they like
    ImageReadConfig config;
    config.non_finite = NonFinite::keep;
    const Image image = chosen_part(session.read_image_parts(path, config), selection.part, path);
    const std::vector<std::string> names = chosen_channels(image, selection);
    if (names.empty())
        throw input_error("{}: no float channels{} among {}", input_name(path),
                          selection.layer.empty() ? "" : " " + selection.layer + ".*",
                          image.channel_names());
    const Rectangle crop = selection.crop.value_or(Rectangle{0, 0, image.width, image.height});
    if (crop.width > image.width - crop.x || crop.height > image.height - crop.y)
        throw input_error("{}: {} x {} pixels, the rectangle {},{},{},{} is not inside",
                          input_name(path), image.width, image.height, crop.x, crop.y, crop.width,
                          crop.height);
    Image result(crop.width, crop.height);
    result.source_bits = image.source_bits;
    for (const std::string& name : names) {
        const Array2D<float>* plane = image.find(name);
        if (!plane)
            throw input_error("{}: no float channel {} among {}", input_name(path), name,
                              image.channel_names());
        result.plane(name) = cropped(*plane, crop);
    }
    if (non_finite == NonFinite::reject) require_finite(result, path);
    return result;
}

Rectangle parse_rectangle(const std::string& text) {
    const std::vector<double> numbers = parse_numbers(text, 4, "--crop");
    constexpr double kMaxSide = 1 << 30;
    for (size_t i = 0; i < 4; ++i)
        if (numbers[i] != std::floor(numbers[i]) || numbers[i] < (i < 2 ? 0 : 1) ||
            numbers[i] > kMaxSide)
            throw usage_error("--crop: '{}', expected whole numbers x,y,w,h with a size", text);
    return {int(numbers[0]), int(numbers[1]), int(numbers[2]), int(numbers[3])};
}

} // namespace ql::cli
