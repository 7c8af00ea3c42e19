// Which parts of an emission texture are not black: points on emitters are drawn everywhere, but
// how bright a triangle is can be told from few points only roughly, and what is taken for black
// would never be drawn.
#pragma once

#include "scene/scene.h"

#include <array>
#include <vector>

namespace ql {

class LitTexels {
  public:
    explicit LitTexels(const Texture& texture);

    // Whether a bilinear look-up anywhere in the triangle of these coordinates may find light; on
    // the safe side.
    bool any_in(const TextureUse& use, const std::array<V2f, 3>& uvs) const;

  private:
    static constexpr int kBlock = 8; // texels a side

    int m_width, m_height, m_across, m_down; // texels, blocks
    std::vector<char> m_lit;                 // by block
    bool m_any = false;
};

} // namespace ql
