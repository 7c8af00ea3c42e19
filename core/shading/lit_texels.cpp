#include "shading/lit_texels.h"

#include "shading/texture.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ql {

LitTexels::LitTexels(const Texture& texture)
    : m_width(texture.width), m_height(texture.height), m_across((m_width + kBlock - 1) / kBlock),
      m_down((m_height + kBlock - 1) / kBlock), m_lit(size_t(m_across) * size_t(m_down), 0) {
    for (int y = 0; y < m_height; ++y)
        for (int x = 0; x < m_width; ++x) {
            const uint8_t* const texel =
                &texture.texels[4 * (size_t(y) * size_t(m_width) + size_t(x))];
            if (!(texel[0] | texel[1] | texel[2])) continue;
            m_lit[size_t(y / kBlock) * size_t(m_across) + size_t(x / kBlock)] = 1;
            m_any = true;
        }
}

bool LitTexels::any_in(const TextureUse& use, const std::array<V2f, 3>& uvs) const {
    if (!m_any) return false;
    V2f low(std::numeric_limits<float>::infinity()), high(-std::numeric_limits<float>::infinity());
    for (const V2f& uv : uvs) {
        const V2f at = transformed_uv(use, uv);
        for (int axis = 0; axis < 2; ++axis) {
            low[axis] = std::min(low[axis], at[axis]);
            high[axis] = std::max(high[axis], at[axis]);
        }
    }
    // Across the border, where the picture goes on in some way, all of it counts.
    if (!(low.x >= 0 && low.y >= 0 && high.x <= 1 && high.y <= 1)) return true;
    const auto block = [](float u, int texels, int blocks) {
        return std::clamp(int(std::floor(u * float(texels))) / kBlock, 0, blocks - 1);
    };
    // A look-up near the border of the texture reaches the other side; one texel more is enough
    // elsewhere.
    const float dx = 1 / float(m_width), dy = 1 / float(m_height);
    if (low.x < dx || low.y < dy || high.x > 1 - dx || high.y > 1 - dy) return true;
    for (int y = block(low.y - dy, m_height, m_down); y <= block(high.y + dy, m_height, m_down);
         ++y)
        for (int x = block(low.x - dx, m_width, m_across);
             x <= block(high.x + dx, m_width, m_across); ++x)
            if (m_lit[size_t(y) * size_t(m_across) + size_t(x)]) return true;
    return false;
}

} // namespace ql
