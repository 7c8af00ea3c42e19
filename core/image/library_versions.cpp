#include "image/image_file.h"

#include <cstdio> // jpeglib.h does not include what it needs

#include <OpenEXR/OpenEXRConfig.h>
#include <fmt/format.h>
#include <jpeglib.h>
#include <png.h>
#include <webp/decode.h>

namespace ql {

std::string image_library_versions() {
    const int webp = WebPGetDecoderVersion();
    return fmt::format("OpenEXR {}, libpng {}, libjpeg {}, libwebp {}.{}.{}",
                       OPENEXR_VERSION_STRING, png_get_libpng_ver(nullptr), JPEG_LIB_VERSION,
                       webp >> 16, webp >> 8 & 255, webp & 255);
}

} // namespace ql
