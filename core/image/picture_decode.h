// Pictures for texturing: encoded bytes (PNG, JPEG, WebP: what glTF may hold) to 8-bit RGBA.
//
// Samples keep the encoding of the file (no change of transfer function), alpha is not
// premultiplied, row 0 is the top. Thread-safe: several pictures may be decoded at once.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace ql {

struct Picture {
    int width = 0;
    int height = 0;
    std::vector<uint8_t> rgba; // width * height * 4
};

struct PictureDecodeConfig {
    size_t max_pixels = size_t(1) << 28;
};

// `name` is what messages call the picture. Errors: ErrorKind::input, one line.
Picture decode_picture(std::span<const std::byte> bytes, const std::string& name,
                       const PictureDecodeConfig& config = {});

} // namespace ql
