// Flat OpenEXR files of one or several parts: scan lines or tiles (the first level), any
// compression, half, float and unsigned channels.
//
// A part is its data window; where that lies in the display window is not kept. Channels come layer
// by layer, R, G, B, A first. Subsampled channels are refused.
#pragma once

#include "image/image.h"
#include "image/image_file.h"

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace ql {

// The bytes must have passed check_exr(). `name` is for messages. Errors: ErrorKind::input, or what
// the library throws.
std::vector<Image> read_exr(std::span<const std::byte> bytes, const std::string& name,
                            const ImageReadConfig& config);

} // namespace ql
