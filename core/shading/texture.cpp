#include "shading/texture.h"

namespace ql {

namespace {

std::array<float, 256> srgb_table() {
    std::array<float, 256> table{};
    for (size_t code = 0; code < table.size(); ++code) {
        const double v = static_cast<double>(code) / 255;
        table[code] =
            static_cast<float>(v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4));
    }
    return table;
}

} // namespace

const std::array<float, 256> kSrgbToLinear = srgb_table();

} // namespace ql
