// Images in files: OpenEXR (float, half or 32-bit unsigned, one or several parts) and PNG.
//
// The same image and configuration give the same bytes. Channels are found by name, never by index.
// A path of "-" stands for standard input or output.
#pragma once

#include "image/image.h"

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace ql {

enum class FileFormat { by_extension, exr, png };
// Files with unsigned planes always hold full floats. Values beyond the range of half (65504) are
// an error, not infinities.
enum class FloatDepth { float32, half };
// How linear values become PNG samples: pictures are sRGB-encoded 8 bit, data stays linear.
enum class PngEncoding { srgb8, linear8, linear16 };

struct ImageWriteConfig {
    FileFormat format = FileFormat::by_extension;
    FloatDepth depth = FloatDepth::float32;
    PngEncoding png = PngEncoding::srgb8;
    float exposure_stops = 0; // sRGB PNG only: values are multiplied by 2^exposure
    std::string software = "quietlight";
    std::string date_time = "1970:01:01 00:00:00"; // never the clock: equal runs, equal bytes
};

enum class NonFinite { reject, keep };

struct ImageReadConfig {
    NonFinite non_finite = NonFinite::reject;
    size_t max_pixels = size_t(1) << 28; // per plane
    size_t max_bytes = size_t(1) << 33;  // of all planes of all parts together, and of the file
};

// One part, or an error if the file has more.
Image read_image(const std::string& path, const ImageReadConfig& config = {});
std::vector<Image> read_image_parts(const std::string& path, const ImageReadConfig& config = {});

void write_image(const std::string& path, const Image& image, const ImageWriteConfig& config = {});
// Several parts need EXR; every part needs a name of its own.
void write_image_parts(const std::string& path, std::span<const Image> parts,
                       const ImageWriteConfig& config = {});

// What NonFinite::reject does on reading: an error that names channel and pixel.
void require_finite(const Image& image, const std::string& path);

// The format that `path` asks for. Errors: ErrorKind::usage.
FileFormat file_format(const std::string& path, FileFormat requested);

// Threads that encoding and decoding may use; results do not depend on it.
void set_image_threads(int threads);

// Versions of the libraries underneath, for --version -v.
std::string image_library_versions();

} // namespace ql
