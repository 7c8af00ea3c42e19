// Looks through the headers of an OpenEXR file before the library does, which takes memory for what
// they announce: attributes, pixels and chunks must fit the file and the limits.
//
// Source: "OpenEXR File Layout", openexr.com. Flat and deep, scan lines and tiles, several parts.
#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace ql {

struct ExrLimits {
    size_t max_pixels = size_t(1) << 28; // of a part
    size_t max_bytes = size_t(1) << 33; // of all samples of all parts, decoded; deep: of the counts
};

// `name` is for messages. Errors: ErrorKind::input.
void check_exr(std::span<const std::byte> bytes, const std::string& name, const ExrLimits& limits);

} // namespace ql
