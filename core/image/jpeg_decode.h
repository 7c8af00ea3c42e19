// JPEG files to 8-bit samples, through libjpeg.
//
// Samples keep the encoding of the file; YCbCr becomes RGB, CMYK and YCCK too. Row 0 is the top.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace ql {

struct JpegImage {
    int width = 0;
    int height = 0;
    int channels = 0; // 1: grey, 3: RGB
    std::vector<uint8_t> samples;
};

// `name` is for messages; more than `max_pixels` are refused before memory is taken for them.
// Errors: ErrorKind::input.
JpegImage decode_jpeg(std::span<const std::byte> bytes, const std::string& name, size_t max_pixels);

} // namespace ql
