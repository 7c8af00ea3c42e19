#include "image/exr_read.h"

#include "base/error.h"
#include "image/exr_metadata.h"
#include "image/exr_stream.h"
#include "image/exr_threads.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfTiledInputPart.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <set>
#include <string_view>
#include <tuple>

namespace ql {

namespace {

struct Channel {
    std::string name;
    Imf::PixelType type = Imf::FLOAT;
    size_t rank = 0; // among those of its layer

    std::string_view layer() const {
        return std::string_view(name).substr(0, name.rfind('.') + 1); // npos + 1 is 0: none
    }
    std::string suffix() const {
        std::string text = name.substr(layer().size());
        for (char& c : text)
            c = char(std::tolower(static_cast<unsigned char>(c)));
        return text;
    }
};

// The order of channels in a layer; others follow by name. With an x, y and z are its companions
// and no luminance or depth.
constexpr std::string_view kColours[] = {"r",    "red",  "g",  "green", "b",     "blue", "y",
                                         "real", "imag", "a",  "alpha", "ar",    "ra",   "ag",
                                         "ga",   "ab",   "ba", "z",     "depth", "zback"};
constexpr std::string_view kVectors[] = {"r",  "red", "g",    "green", "b",  "blue",  "x",
                                         "y",  "z",   "real", "imag",  "a",  "alpha", "ar",
                                         "ra", "ag",  "ga",   "ab",    "ba", "depth", "zback"};

size_t place(std::span<const std::string_view> order, const std::string& suffix) {
    return size_t(std::find(order.begin(), order.end(), suffix) - order.begin());
}

void rank_channels(std::vector<Channel>& channels) {
    std::map<std::string_view, std::set<std::string>> axes; // of each layer
    for (const Channel& channel : channels)
        if (const std::string suffix = channel.suffix();
            suffix == "x" || suffix == "y" || suffix == "z")
            axes[channel.layer()].insert(suffix);
    for (Channel& channel : channels) {
        const std::set<std::string>& found = axes[channel.layer()];
        const bool vector = found.contains("x") && found.size() > 1;
        channel.rank = place(vector ? std::span<const std::string_view>(kVectors) : kColours,
                             channel.suffix());
    }
}

std::vector<Channel> sorted_channels(const Imf::Header& header) {
    std::vector<Channel> channels;
    for (auto it = header.channels().begin(); it != header.channels().end(); ++it)
        channels.push_back({it.name(), it.channel().type});
    rank_channels(channels);
    std::sort(channels.begin(), channels.end(), [](const Channel& a, const Channel& b) {
        return std::tuple(a.layer(), a.rank, std::string_view(a.name)) <
               std::tuple(b.layer(), b.rank, std::string_view(b.name));
    });
    return channels;
}

bool is_tiled(const Imf::Header& header) {
    return header.hasType() ? header.type() == Imf::TILEDIMAGE : header.hasTileDescription();
}

// bytes: what the parts before this one take, to which this one is added.
void check_part(const Imf::Header& header, const std::string& name, size_t& bytes,
                const ImageReadConfig& config) {
    const Imath::Box2i window = header.dataWindow();
    const size_t width = size_t(window.max.x - window.min.x) + 1;
    const size_t height = size_t(window.max.y - window.min.y) + 1;
    size_t channels = 0;
    for (auto it = header.channels().begin(); it != header.channels().end(); ++it, ++channels)
        if (it.channel().xSampling != 1 || it.channel().ySampling != 1)
            throw input_error("{}: channel {} has a sample in {} x {} pixels, expected one in "
                              "each",
                              name, it.name(), it.channel().xSampling, it.channel().ySampling);
    bytes += width * height * channels * 4;
    if (width * height > config.max_pixels || bytes > config.max_bytes)
        throw input_error("{}: {} x {} pixels of {} channels, more than the limit of {} pixels or "
                          "{} bytes",
                          name, width, height, channels, config.max_pixels, config.max_bytes);
    if (channels == 0) throw input_error("{}: no channels", name);
    if (header.hasType() && header.type().starts_with("deep"))
        throw input_error("{}: a deep image, expected a flat one", name);
}

// Planes for all channels, and where the library finds them.
Imf::FrameBuffer planes_of(const Imf::Header& header, Image& image) {
    Imf::FrameBuffer buffer;
    image.source_bits = 16;
    for (const Channel& channel : sorted_channels(header)) {
        if (channel.type != Imf::HALF) image.source_bits = 32;
        const bool word = channel.type == Imf::UINT;
        void* pixels = word ? static_cast<void*>(image.uint_plane(channel.name).values().data())
                            : image.plane(channel.name).values().data();
        buffer.insert(channel.name,
                      Imf::Slice::Make(word ? Imf::UINT : Imf::FLOAT, pixels, header.dataWindow()));
    }
    return buffer;
}

Image read_part(Imf::MultiPartInputFile& file, int part) {
    const Imf::Header& header = file.header(part);
    const Imath::Box2i window = header.dataWindow();
    Image image(window.max.x - window.min.x + 1, window.max.y - window.min.y + 1);
    if (header.hasName()) image.name = header.name();
    image.metadata = exr_metadata(header);
    const Imf::FrameBuffer buffer = planes_of(header, image);
    if (is_tiled(header)) {
        Imf::TiledInputPart input(file, part);
        input.setFrameBuffer(buffer);
        input.readTiles(0, input.numXTiles(0) - 1, 0, input.numYTiles(0) - 1, 0, 0);
    } else {
        Imf::InputPart input(file, part);
        input.setFrameBuffer(buffer);
        input.readPixels(window.min.y, window.max.y);
    }
    return image;
}

} // namespace

std::vector<Image> read_exr(std::span<const std::byte> bytes, const std::string& name,
                            const ImageReadConfig& config) {
    start_exr_threads();
    ExrMemoryInput stream(bytes);
    Imf::MultiPartInputFile file(stream);
    std::vector<Image> parts;
    size_t total_bytes = 0;
    for (int part = 0; part < file.parts(); ++part) {
        const Imf::Header& header = file.header(part);
        check_part(header, name, total_bytes, config);
        parts.push_back(read_part(file, part));
        if (config.non_finite == NonFinite::reject) require_finite(parts.back(), name);
    }
    return parts;
}

} // namespace ql
