#include "cli/blur_option.h"

#include "base/error.h"

#include <charconv>

namespace ql::cli {

BlurRadius parse_blur(const std::string& text) {
    BlurRadius radius;
    const char* const end = text.data() + text.size();
    const auto [unit, error] = std::from_chars(text.data(), end, radius.value);
    radius.in_voxels = std::string(unit, end) == "vox";
    if (error != std::errc() || !(unit == end || radius.in_voxels) || !(radius.value >= 0) ||
        !(radius.value <= 1e6))
        throw usage_error("--blur: '{}', expected a radius in metres or, as 0.25vox, in voxels",
                          text);
    return radius;
}

} // namespace ql::cli
