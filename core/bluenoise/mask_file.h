// Masks as images, and the mask values that the permutation passes compare.
//
// In EXR a threshold is (rank + 0.5) / n, from which the rank comes back exactly for n <= 2^24. In
// a PNG of 16 bits the sample is floor(65536 (rank + 0.5) / n): distinct, and the rank comes back
// as floor((2 sample + 1) n / 131072), for n <= 65536; larger masks share samples evenly.
// One channel is named Y, several R G B A. Pure functions.
#pragma once

#include "base/array2d.h"
#include "bluenoise/mask.h"
#include "image/image.h"

#include <string>
#include <vector>

namespace ql {

enum class MaskSamples { exact, bits16 };

// 1 to 4 channels of ranks as an image, with the settings as ql:* metadata.
Image mask_image(const std::vector<Array2D<uint32_t>>& channels, const MaskConfig& config,
                 MaskSamples samples);

// A mask read from anywhere: integer values in the file's own steps.
struct Mask {
    Array2D<uint32_t> values; // 8 bit: 0..255; 16 bit: 0..65535; float: order of distinct values
    uint32_t levels = 1;      // greatest value that can occur, plus one
    std::string hash;         // 16 hexadecimal digits, of size and values
};

// channel "" takes the only channel, Y, or R of R = G = B (A left aside).
// Errors: ErrorKind::input, with `path` in the message.
Mask mask_from_image(const Image& image, const std::string& channel, const std::string& path);

// FNV-1a of the size and the values.
std::string mask_hash(const Array2D<uint32_t>& values);

} // namespace ql
