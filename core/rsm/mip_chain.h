// Averages of the texels of a map, level by level, for the gather of Nilles 2017, section 5.1.
//
// Level 0 is the map. A texel of level l averages a block of about 2^l x 2^l: flux over all of
// them, positions and normals over those that saw something. Such a position lies on no surface
// where the block sees several: the method's defect, kept as it is. Immutable.
#pragma once

#include "rsm/map.h"

namespace ql {

struct MipLevel {
    int size = 0;
    Texels texels;
};

enum class MipLevels { all, first };

class MipChain {
  public:
    explicit MipChain(const ReflectiveShadowMap& map, MipLevels levels = MipLevels::all);

    int levels() const { return int(m_levels.size()) + 1; }
    // level 0 is the map's own texels.
    const Texels& texels(int level) const;
    int size(int level) const;

  private:
    const ReflectiveShadowMap* m_map;
    std::vector<MipLevel> m_levels;
};

// The level, of so many, whose texels are about diameter_px wide: log2, rounded.
int mip_level(float diameter_px, int levels);

} // namespace ql
