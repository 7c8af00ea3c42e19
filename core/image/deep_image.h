// Deep OpenEXR files: pixels that hold lists of samples of named 32-bit channels.
//
// Rows go in and out a few at a time, so that a large file needs no second copy in memory and is
// packed by several threads; the encoded bytes are written whole or not at all. Samples are 32-bit
// words: unsigned, or the bits of floats. The same content gives the same bytes. Sizes are checked
// before memory is taken.
#pragma once

#include <Imath/ImathVec.h>

#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace ql {

struct DeepChannel {
    std::string name;
    enum class Type { uint32, float32 } type = Type::uint32;
    bool operator==(const DeepChannel&) const = default;
};

using DeepValue = std::variant<int, double, std::string, Imath::V3d>;

struct DeepHeader {
    int width = 0;
    int height = 0;
    std::vector<DeepChannel> channels; // sorted by name
    std::map<std::string, DeepValue> metadata;

    // The value of that key and type or nullptr.
    template<class T>
    const T* find(const std::string& key) const {
        const auto it = metadata.find(key);
        return it == metadata.end() ? nullptr : std::get_if<T>(&it->second);
    }
};

// The samples of one row: by channel, then pixel after pixel.
using DeepRow = std::vector<std::span<uint32_t>>;

// sample_counts: width * height, row by row. fill(y, row) fills spans of the right size, with
// rows in order.
// path "-" is standard output. Errors: ErrorKind::output.
void write_deep_image(const std::string& path, const DeepHeader& header,
                      std::span<const uint32_t> sample_counts,
                      const std::function<void(int y, DeepRow& row)>& fill);

struct DeepReadConfig {
    size_t max_bytes = size_t(1) << 36; // of the file
};

// What a reader does with the parts of the file, in this order.
struct DeepReader {
    virtual ~DeepReader() = default;
    // Returns how many samples a pixel may have at most.
    virtual uint64_t on_header(const DeepHeader& header) = 0;
    virtual void on_sample_counts(std::span<const uint32_t> counts, uint64_t total) = 0;
    virtual void on_row(int y, const DeepRow& row) = 0;
};

// path "-" is standard input. Errors: ErrorKind::input, one line that names the file.
void read_deep_image(const std::string& path, DeepReader& reader,
                     const DeepReadConfig& config = {});

} // namespace ql
