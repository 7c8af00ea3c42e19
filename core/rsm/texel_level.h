// The texels of a map, or of one of its mip levels, laid out for gathers that read here and there.
//
// What decides whether a texel lights a point takes half a cache line; its flux lies elsewhere.
// Immutable.
#pragma once

#include "rsm/mip_chain.h"

#include <span>

namespace ql {

struct alignas(32) TexelPlace {
    V3f position;
    float radius2; // area / pi
    V3f normal;    // 0 where the flux is
    float offset;
};

struct TexelLevel {
    uint32_t map = 0; // its number
    int size = 0;     // texels along a side
    std::vector<TexelPlace> places;
    std::vector<V3f> flux;

    TexelLevel(const Texels& texels, int size, uint32_t map);
};

// The texels of points of the square, each in a level of its own size. is_inside is 0 for points
// outside of the square; these get some texel.
void find_texels(const float* u, const float* v, const int* sizes, size_t count, uint32_t* texels,
                 uint32_t* is_inside);

// For each map its levels, finest first.
std::vector<std::vector<TexelLevel>> texel_levels(std::span<const ReflectiveShadowMap> maps,
                                                  MipLevels mips);

} // namespace ql
