// PNG files to samples and back, through libpng.
//
// Samples keep the encoding of the file (no change of transfer function), alpha is not
// premultiplied, row 0 is the top. Palettes become RGB, fewer than 8 bits become 8, transparent
// colours become an alpha; then pixels have 1 to 4 samples: grey, grey + alpha, RGB or RGBA.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace ql {

using PngText = std::vector<std::pair<std::string, std::string>>; // keywords and values

struct PngHeader {
    int width = 0;
    int height = 0;
    int channels = 0;
    int bits = 8; // of a sample: 8 or 16
    PngText text; // what stands before the samples

    size_t sample_count() const { return size_t(width) * size_t(height) * size_t(channels); }
};

// The bytes must have passed check_png() and outlive the reader. `name` is for messages.
// Errors: ErrorKind::input.
class PngReader {
  public:
    PngReader(std::span<const std::byte> bytes, const std::string& name);
    ~PngReader();
    PngReader(const PngReader&) = delete;
    PngReader& operator=(const PngReader&) = delete;

    // Known before memory is taken for samples.
    const PngHeader& header() const { return m_header; }

    // All samples, once: one of the two, by the bits of the header.
    std::vector<uint8_t> samples8();
    std::vector<uint16_t> samples16();

  private:
    struct State;

    void read_rows(void* samples);

    std::string m_name;
    std::unique_ptr<State> m_state;
    PngHeader m_header;
};

enum class PngTransfer { srgb, linear };

struct PngDate {
    int year = 1970, month = 1, day = 1, hour = 0, minute = 0, second = 0;
};

// `samples`: header.sample_count() of them, in the range of its bits. The same input gives the same
// bytes. Errors: std::runtime_error without
// the name of a file.
std::vector<std::byte> png_bytes(const PngHeader& header, std::span<const uint16_t> samples,
                                 PngTransfer transfer, const PngDate& date);

} // namespace ql
