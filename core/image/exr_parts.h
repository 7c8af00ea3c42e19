// OpenEXR files of several parts, in memory.
//
// OpenImageIO 2.4 writes such files to disk only, whatever place it is given; this uses the OpenEXR
// library itself. Parts are scan lines, ZIP. Thread safe: pure.
#pragma once

#include "image/image_file.h"

#include <span>
#include <vector>

namespace ql {

// Every part needs a name of its own. Errors: ErrorKind::output.
std::vector<char> exr_parts(std::span<const Image> parts, const ImageWriteConfig& config);

} // namespace ql
