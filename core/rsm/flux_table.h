// Texels of all maps by their flux, from two numbers in [0, 1).
//
// By the inverse of the distribution function, rows first, then texels of the row: unlike an alias
// table it is monotone, so that near numbers give near texels, which samples shifted by a
// blue-noise mask need. Guide tables make a look-up take constant time on average (Chen & Asau, "On
// generating random variates from an empirical distribution", 1974). Immutable.
#pragma once

#include "rsm/map.h"

#include <span>

namespace ql {

class FluxTable {
  public:
    FluxTable() = default;
    explicit FluxTable(std::span<const ReflectiveShadowMap> maps);

    bool empty() const { return !(m_inverse_sum > 0); }

    struct Choice {
        size_t map;
        size_t texel;
        V2f uv; // uniform in the texel
    };
    // The table must not be empty.
    Choice sample(double u_row, float u_texel) const;
    // Of a texel of that flux.
    float probability(const V3f& flux) const { return (flux.x + flux.y + flux.z) * m_inverse_sum; }

  private:
    int m_size = 0;                    // texels along a side; all maps have the same
    float m_inverse_sum = 0;           // 1 / sum of all fluxes, of all colours
    std::vector<double> m_row_end;     // sum of the shares up to and with each row
    std::vector<uint32_t> m_row_guide; // first row that may hold k / rows
    std::vector<float> m_texel_end;    // the same within each row
    std::vector<uint16_t> m_texel_guide;
};

} // namespace ql
