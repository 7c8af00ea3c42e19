// Flat OpenEXR files of one or several parts: scan lines, ZIP, float, half or unsigned channels.
//
// The same images and configuration give the same bytes, for any number of threads.
#pragma once

#include "image/image.h"
#include "image/image_file.h"

#include <cstddef>
#include <span>
#include <vector>

namespace ql {

// Float planes become halves if that is asked for and the image has no unsigned planes.
bool exr_is_half(const Image& image, const ImageWriteConfig& config);

// Errors: what the library throws.
std::vector<std::byte> exr_bytes(std::span<const Image> parts, const ImageWriteConfig& config);

} // namespace ql
