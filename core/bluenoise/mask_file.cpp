#include "bluenoise/mask_file.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace ql {

namespace {

const char* method_name(MaskMethod method) {
    switch (method) {
    case MaskMethod::white:
        return "white";
    case MaskMethod::bayer:
        return "bayer";
    case MaskMethod::void_and_cluster:
        break;
    }
    return "void-and-cluster";
}

float threshold(uint32_t rank, size_t n, MaskSamples samples) {
    const double exact = (double(rank) + 0.5) / double(n);
    if (samples == MaskSamples::exact) return float(exact);
    return float(std::floor(exact * 65536) / 65535);
}

const Array2D<float>& mask_channel(const Image& image, const std::string& channel,
                                   const std::string& path) {
    if (!channel.empty()) {
        if (const auto* plane = image.find(channel)) return *plane;
        throw input_error("{}: no channel {}, expected one of {}", path, channel,
                          image.channel_names());
    }
    if (image.planes.size() == 1) return image.planes.front().pixels;
    if (const auto* plane = image.find("Y")) return *plane;
    const auto *r = image.find("R"), *g = image.find("G"), *b = image.find("B");
    if (r && g && b && *r == *g && *r == *b) return *r;
    throw input_error("{}: {} channels ({}), expected 1 or the name of one", path,
                      image.channel_count(), image.channel_names());
}

// The place of each value among the distinct values.
Array2D<uint32_t> dense_ranks(const Array2D<float>& plane) {
    std::vector<float> distinct = plane.values();
    std::sort(distinct.begin(), distinct.end());
    distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
    Array2D<uint32_t> ranks(plane.width(), plane.height());
    for (size_t i = 0; i < plane.size(); ++i)
        ranks[i] = uint32_t(std::lower_bound(distinct.begin(), distinct.end(), plane[i]) -
                            distinct.begin());
    return ranks;
}

} // namespace

Image mask_image(const std::vector<Array2D<uint32_t>>& channels, const MaskConfig& config,
                 MaskSamples samples) {
    static constexpr std::array<const char*, 4> kNames = {"R", "G", "B", "A"};
    QL_CHECK(!channels.empty() && channels.size() <= kNames.size());
    Image image(config.width, config.height);
    for (size_t c = 0; c < channels.size(); ++c) {
        Array2D<float>& plane = image.plane(channels.size() == 1 ? "Y" : kNames[c]);
        for (size_t i = 0; i < plane.size(); ++i)
            plane[i] = threshold(channels[c][i], plane.size(), samples);
    }
    image.metadata["ql:method"] = std::string(method_name(config.method));
    if (config.method == MaskMethod::void_and_cluster)
        image.metadata["ql:sigma_px"] = fmt::to_string(config.sigma_px);
    if (config.method != MaskMethod::bayer) image.metadata["ql:seed"] = fmt::to_string(config.seed);
    return image;
}

Mask mask_from_image(const Image& image, const std::string& channel, const std::string& path) {
    const Array2D<float>& plane = mask_channel(image, channel, path);
    Mask mask;
    if (image.source_bits == 32) {
        mask.values = dense_ranks(plane);
        mask.levels =
            *std::max_element(mask.values.values().begin(), mask.values.values().end()) + 1;
    } else {
        mask.levels = 1u << image.source_bits;
        mask.values = Array2D<uint32_t>(plane.width(), plane.height());
        for (size_t i = 0; i < plane.size(); ++i)
            mask.values[i] = uint32_t(std::lround(plane[i] * float(mask.levels - 1)));
    }
    mask.hash = mask_hash(mask.values);
    return mask;
}

std::string mask_hash(const Array2D<uint32_t>& values) {
    uint64_t hash = 0xcbf29ce484222325u;
    const auto add = [&](uint32_t word) {
        for (int byte = 0; byte < 4; ++byte)
            hash = (hash ^ (word >> (8 * byte) & 255)) * 0x100000001b3u;
    };
    add(uint32_t(values.width()));
    add(uint32_t(values.height()));
    for (const uint32_t value : values.values())
        add(value);
    return fmt::format("{:016x}", hash);
}

} // namespace ql
