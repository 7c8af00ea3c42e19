// EXR and PNG images: as masks, retarget textures, seeds, and pictures to be measured.
#include "fuzz.h"

#include "bluenoise/mask_file.h"
#include "bluenoise/retarget_file.h"
#include "image/image_file.h"

using namespace ql;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    const std::string& path = fuzz::scratch_file({data, size});
    ImageReadConfig config;
    config.max_pixels = 1 << 16;
    config.max_bytes = 1 << 22;
    std::vector<Image> parts;
    config.non_finite = NonFinite::keep;
    fuzz::refuse_or([&] { parts = read_image_parts(path, config); });
    if (parts.empty()) return 0;
    for (const Image& part : parts) {
        fuzz::refuse_or([&] { require_finite(part, "image"); });
        fuzz::refuse_or([&] { (void)mask_from_image(part, "", "image"); });
        (void)part.find_uint("seed");
        (void)part.channel_names();
    }
    fuzz::refuse_or([&] { (void)retarget_textures(parts, "image"); });
    return 0;
}
