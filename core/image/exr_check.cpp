#include "image/exr_check.h"

#include "base/error.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <string_view>
#include <vector>

namespace ql {

namespace {

constexpr uint32_t kTiled = 0x200, kNonImage = 0x800, kMultiPart = 0x1000;
constexpr size_t kMaxName = 255;
constexpr int64_t kMaxCoordinate = std::numeric_limits<int>::max() / 2;

// Types of one size.
struct FixedType {
    std::string_view name;
    size_t bytes;
};
constexpr FixedType kFixedTypes[] = {{"box2f", 16},      {"box2i", 16},   {"chromaticities", 32},
                                     {"compression", 1}, {"double", 8},   {"envmap", 1},
                                     {"float", 4},       {"int", 4},      {"keycode", 28},
                                     {"lineOrder", 1},   {"m33d", 72},    {"m33f", 36},
                                     {"m44d", 128},      {"m44f", 64},    {"rational", 8},
                                     {"tiledesc", 9},    {"timecode", 8}, {"v2d", 16},
                                     {"v2f", 8},         {"v2i", 8},      {"v3d", 24},
                                     {"v3f", 12},        {"v3i", 12},     {"deepImageState", 1}};

// Scan lines of a chunk by compression: none, RLE, ZIPS, ZIP, PIZ, PXR24, B44, B44A, DWAA, DWAB.
constexpr int64_t kChunkLines[] = {1, 1, 1, 16, 32, 16, 32, 32, 32, 256};

struct Part {
    int64_t width = 0, height = 0;
    std::optional<uint8_t> compression;
    std::string type;
    uint64_t pixel_bytes = 0;
    bool has_window = false, has_channels = false, has_tiles = false;
    uint32_t tile_width = 0, tile_height = 0;
};

class HeaderReader {
  public:
    HeaderReader(std::span<const std::byte> bytes, const std::string& name)
        : m_bytes(bytes), m_name(name) {}

    size_t left() const { return m_bytes.size() - m_at; }

    template<class T>
    T number() {
        T value;
        std::memcpy(&value, take(sizeof value).data(), sizeof value);
        return value;
    }

    std::span<const std::byte> take(size_t size) {
        if (size > left()) throw damaged("the header ends early");
        m_at += size;
        return m_bytes.subspan(m_at - size, size);
    }

    std::string_view text() {
        const size_t most = std::min(left(), kMaxName + 1);
        const auto* begin = reinterpret_cast<const char*>(m_bytes.data()) + m_at;
        const void* end = most > 0 ? std::memchr(begin, 0, most) : nullptr;
        if (!end) throw damaged("a name without end");
        const auto size = size_t(static_cast<const char*>(end) - begin);
        m_at += size + 1;
        return {begin, size};
    }

    Error damaged(const std::string& what) const {
        return input_error("{}: damaged OpenEXR: {}", m_name, what);
    }

  private:
    std::span<const std::byte> m_bytes;
    const std::string& m_name;
    size_t m_at = 0;
};

void read_window(HeaderReader value, Part& part) {
    const int64_t x0 = value.number<int32_t>(), y0 = value.number<int32_t>();
    const int64_t x1 = value.number<int32_t>(), y1 = value.number<int32_t>();
    for (const int64_t coordinate : {x0, y0, x1, y1})
        if (coordinate < -kMaxCoordinate || coordinate > kMaxCoordinate)
            throw value.damaged(fmt::format("a pixel at {}", coordinate));
    if (x1 < x0 || y1 < y0) throw value.damaged("an empty data window");
    part.width = x1 - x0 + 1;
    part.height = y1 - y0 + 1;
    part.has_window = true;
}

// Returns the bytes of a pixel.
uint64_t read_channels(HeaderReader value) {
    uint64_t pixel_bytes = 0;
    while (!value.text().empty()) {
        const auto type = value.number<int32_t>();
        value.take(4); // linear, reserved
        const auto x_sampling = value.number<int32_t>(), y_sampling = value.number<int32_t>();
        if (type < 0 || type > 2) throw value.damaged(fmt::format("a channel of type {}", type));
        if (x_sampling < 1 || y_sampling < 1)
            throw value.damaged(fmt::format("sampling {} x {}", x_sampling, y_sampling));
        pixel_bytes += type == 1 ? 2 : 4;
    }
    if (value.left() > 0) throw value.damaged("bytes behind the list of channels");
    return pixel_bytes;
}

void read_tiles(HeaderReader value, Part& part) {
    part.tile_width = value.number<uint32_t>();
    part.tile_height = value.number<uint32_t>();
    if (part.tile_width < 1 || part.tile_height < 1 || part.tile_width > kMaxCoordinate ||
        part.tile_height > kMaxCoordinate)
        throw value.damaged(fmt::format("tiles of {} x {}", part.tile_width, part.tile_height));
    part.has_tiles = true;
}

// A list of strings, each with its length before it.
void check_strings(HeaderReader value) {
    while (value.left() > 0) {
        const auto size = value.number<int32_t>();
        if (size < 0) throw value.damaged("a string of negative length");
        value.take(size_t(size));
    }
}

void check_preview(HeaderReader value) {
    const auto width = value.number<uint32_t>(), height = value.number<uint32_t>();
    if (uint64_t{width} * height * 4 != value.left())
        throw value.damaged(fmt::format("a preview of {} x {}", width, height));
}

void read_attribute(std::string_view key, std::string_view type, HeaderReader value, Part& part) {
    for (const FixedType& fixed : kFixedTypes)
        if (fixed.name == type && value.left() != fixed.bytes)
            throw value.damaged(fmt::format("{} bytes of type {}", value.left(), fixed.name));
    // The library reads these as far as they say themselves, whatever their size.
    if (type == "preview") check_preview(value);
    if (type == "stringvector") check_strings(value);
    if (type == "floatvector" && value.left() % 4 != 0)
        throw value.damaged(fmt::format("{} bytes of type floatvector", value.left()));
    if (type == "idmanifest") throw value.damaged("an ID manifest, which is not supported");
    if (type == "chlist") {
        const uint64_t pixel_bytes = read_channels(value);
        if (key == "channels") part.pixel_bytes = pixel_bytes;
        part.has_channels |= key == "channels";
    }
    if (key == "dataWindow" && type == "box2i") read_window(value, part);
    if (key == "tiles" && type == "tiledesc") read_tiles(value, part);
    if (key == "compression" && type == "compression") part.compression = value.number<uint8_t>();
    if (key == "type" && type == "string") {
        const auto text = value.take(value.left());
        part.type.assign(reinterpret_cast<const char*>(text.data()), text.size());
    }
}

// Attributes up to the empty name that ends them; none: no more parts.
std::optional<Part> read_part(HeaderReader& header, const std::string& name) {
    Part part;
    bool any = false;
    for (;;) {
        const std::string_view key = header.text();
        if (key.empty()) break;
        any = true;
        const std::string_view type = header.text();
        const auto size = header.number<int32_t>();
        if (size < 0) throw header.damaged("an attribute of negative size");
        read_attribute(key, type, HeaderReader(header.take(size_t(size)), name), part);
    }
    if (!any) return std::nullopt;
    if (!part.has_window || !part.has_channels || !part.compression)
        throw header.damaged("no data window, channels or compression");
    if (*part.compression >= std::size(kChunkLines))
        throw header.damaged(fmt::format("compression {}", int(*part.compression)));
    return part;
}

uint64_t divided_up(uint64_t a, uint64_t b) {
    return (a + b - 1) / b;
}

// Chunks of a part at least: those of the first level.
uint64_t chunk_count(const Part& part, bool tiled) {
    const auto width = uint64_t(part.width), height = uint64_t(part.height);
    if (!tiled) return divided_up(height, uint64_t(kChunkLines[*part.compression]));
    return divided_up(width, part.tile_width) * divided_up(height, part.tile_height);
}

void check_part(const Part& part, bool tiled, const HeaderReader& header, const std::string& name,
                const ExrLimits& limits, uint64_t& total_bytes) {
    const bool deep = part.type.starts_with("deep");
    if (tiled && !part.has_tiles) throw header.damaged("tiles of no size");
    const uint64_t pixels = uint64_t(part.width) * uint64_t(part.height);
    const uint64_t pixel_bytes = deep ? sizeof(uint32_t) : std::max<uint64_t>(part.pixel_bytes, 1);
    if (pixels > limits.max_pixels || pixel_bytes > limits.max_bytes / pixels ||
        pixels * pixel_bytes > limits.max_bytes - total_bytes)
        throw input_error("{}: {} x {} pixels of {} bytes, more than the limit of {} pixels or {} "
                          "bytes",
                          name, part.width, part.height, pixel_bytes, limits.max_pixels,
                          limits.max_bytes);
    total_bytes += pixels * pixel_bytes;
    // The library takes memory for whole chunks, be they larger than the image.
    const uint64_t chunk_pixels =
        tiled ? uint64_t{part.tile_width} * part.tile_height
              : uint64_t(part.width) * uint64_t(kChunkLines[*part.compression]);
    // What small images may take: lines of 2^16 pixels in any compression.
    constexpr uint64_t kSmallTile = 1 << 22, kSmallLines = 1 << 24;
    if (chunk_pixels > std::max(4 * pixels, tiled ? kSmallTile : kSmallLines))
        throw header.damaged(fmt::format("chunks of {} pixels in an image of {} x {}", chunk_pixels,
                                         part.width, part.height));
    // Every chunk has an entry of 8 bytes in a table.
    if (chunk_count(part, tiled) > header.left() / 8)
        throw header.damaged(
            fmt::format("{} x {} pixels in {} bytes", part.width, part.height, header.left()));
}

} // namespace

void check_exr(std::span<const std::byte> bytes, const std::string& name, const ExrLimits& limits) {
    HeaderReader header(bytes, name);
    header.take(4); // the magic number
    const auto version = header.number<uint32_t>();
    if ((version & 0xff) != 2)
        throw input_error("{}: OpenEXR version {}, expected 2", name, version & 0xff);
    std::vector<Part> parts;
    while (const std::optional<Part> part = read_part(header, name)) {
        parts.push_back(*part);
        if (!(version & kMultiPart)) break;
    }
    if (parts.empty()) throw header.damaged("no header");
    uint64_t total_bytes = 0;
    for (const Part& part : parts) {
        // Only files of one flat part say by the version whether they are tiled.
        const bool by_type = version & (kMultiPart | kNonImage);
        const bool tiled = by_type ? part.type == "tiledimage" || part.type == "deeptile"
                                   : (version & kTiled) != 0;
        check_part(part, tiled, header, name, limits, total_bytes);
    }
}

} // namespace ql
