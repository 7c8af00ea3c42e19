// Pictures of textures in every format that is decoded: PNG, JPEG, WebP, BMP, GIF, TIFF, DDS.
#include "fuzz.h"

#include "image/picture_decode.h"

using namespace ql;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    PictureDecodeConfig config;
    config.max_pixels = 1 << 16;
    fuzz::refuse_or([&] {
        const Picture picture =
            decode_picture(std::as_bytes(std::span(data, size)), "picture", config);
        if (picture.rgba.size() != 4 * size_t(picture.width) * size_t(picture.height))
            fuzz::report_finding("a picture without all of its samples");
    });
    return 0;
}
