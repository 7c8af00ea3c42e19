// The texels of a map, or of one of its mip levels, laid out for gathers that read here and there.
//
// A texel takes one line of the cache. Blocks of texels have bounds on where they are and where
// they face, small enough to stay in the cache: most texels that light nothing are found out
// there, without a look at the texel. Immutable.
#pragma once

#include "rsm/geometry_term.h"
#include "rsm/mip_chain.h"

#include <span>
#include <vector>

namespace ql {

struct alignas(64) TexelRecord {
    V3f position;
    float radius2; // area / pi
    V3f normal;    // 0 where the flux is
    float offset;
    V3f flux;
};

// Of the texels of a block that have flux.
struct TexelBlock {
    V3f centre = {0, 0, 0};
    float radius = -kInfinity; // of a sphere around them; without any, minus infinity
    V3f axis = {0, 0, 0};      // their normals are no further from it than `spread`
    float spread = 0;
    float reach = 0; // the most of normal . (centre - position)

    // False: none of them lights the receiver, as bounded_geometry has it.
    bool may_light(const Receiver& receiver) const {
        const V3f way = receiver.position - centre;
        const float before_receiver = radius - receiver.ng.dot(way);
        // The sum is no less than the length of the way.
        const float length = std::abs(way.x) + std::abs(way.y) + std::abs(way.z);
        const float before_texels = axis.dot(way) + spread * length + reach;
        return std::min(before_receiver, before_texels) > kPlaneNoise;
    }
};

struct TexelLevel {
    int size = 0; // texels along a side
    std::vector<TexelRecord> records;
    std::vector<TexelBlock> blocks;
    int block_shift = 0; // blocks have 2^block_shift texels along a side
    int blocks_across = 0;

    TexelLevel(const Texels& texels, int size);

    // Texels of points, and their blocks. is_inside is 0 for points outside of the unit square;
    // these get some texel.
    void find(const float* u, const float* v, size_t count, uint32_t* texels, uint32_t* blocks_of,
              uint32_t* is_inside) const;
};

// For each map its levels, finest first.
std::vector<std::vector<TexelLevel>> texel_levels(std::span<const ReflectiveShadowMap> maps,
                                                  MipLevels mips);

} // namespace ql
