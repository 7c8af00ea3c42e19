#include "rsm/texel_level.h"

#include "base/wide_kernel.h"

#include <cmath>

namespace ql {

namespace {

// Blocks of a map along a side, at most.
constexpr int kMostBlocks = 48;

// Bounds are rounded away from the texels by a little more than the errors of single precision.
constexpr double kMargin = 1 + 0x1p-20;

TexelBlock bounds_of(std::span<const TexelRecord* const> texels) {
    TexelBlock block;
    if (texels.empty()) return block;
    Imath::Box3d box;
    V3d normal(0);
    for (const TexelRecord* t : texels) {
        box.extendBy(V3d(t->position));
        normal += V3d(t->normal);
    }
    block.centre = V3f(box.center());
    block.axis = V3f(normal / double(texels.size()));
    double radius = 0, spread = 0, reach = -double(kInfinity);
    for (const TexelRecord* t : texels) {
        const V3d way = V3d(block.centre) - V3d(t->position);
        radius = std::max(radius, way.length());
        spread = std::max(spread, (V3d(t->normal) - V3d(block.axis)).length());
        reach = std::max(reach, V3d(t->normal).dot(way));
    }
    block.radius = float(radius * kMargin);
    block.spread = float(spread * kMargin);
    block.reach = std::nextafter(float(reach), kInfinity);
    return block;
}

// Written for the vectoriser: no branches.
QL_WIDE_KERNEL
void find_texels(const float* u, const float* v, size_t count, int size, int shift, int across,
                 uint32_t* texels, uint32_t* blocks, uint32_t* is_inside) {
    const float* __restrict us = u;
    const float* __restrict vs = v;
    uint32_t* __restrict found = texels;
    uint32_t* __restrict found_blocks = blocks;
    uint32_t* __restrict inside = is_inside;
    for (size_t i = 0; i < count; ++i) {
        // NaN becomes 0.
        float x = us[i] > 0 ? us[i] : 0.0f, y = vs[i] > 0 ? vs[i] : 0.0f;
        x = x < 1 ? x : 1.0f;
        y = y < 1 ? y : 1.0f;
        inside[i] = uint32_t(x == us[i]) & uint32_t(y == vs[i]);
        int column = int(x * float(size)), row = int(y * float(size));
        column = column < size ? column : size - 1;
        row = row < size ? row : size - 1;
        found[i] = uint32_t(row * size + column);
        found_blocks[i] = uint32_t((row >> shift) * across + (column >> shift));
    }
}

} // namespace

TexelLevel::TexelLevel(const Texels& texels, int of_size) : size(of_size), records(texels.count()) {
    for (size_t i = 0; i < texels.count(); ++i) {
        const V3f flux = texels.flux(i);
        const V3f normal = flux == V3f(0, 0, 0) ? V3f(0) : texels.normal(i);
        records[i] = {texels.position(i), texels.radius2[i], normal, texels.offset[i], flux};
    }

    // Bound the blocks.
    while ((size - 1) >> block_shift >= kMostBlocks)
        ++block_shift;
    blocks_across = ((size - 1) >> block_shift) + 1;
    std::vector<const TexelRecord*> lit;
    for (int by = 0; by < blocks_across; ++by)
        for (int bx = 0; bx < blocks_across; ++bx) {
            lit.clear();
            const int side = 1 << block_shift;
            for (int y = by * side; y < std::min(size, (by + 1) * side); ++y)
                for (int x = bx * side; x < std::min(size, (bx + 1) * side); ++x) {
                    const TexelRecord& texel = records[size_t(y) * size_t(size) + size_t(x)];
                    if (texel.normal != V3f(0, 0, 0)) lit.push_back(&texel);
                }
            blocks.push_back(bounds_of(lit));
        }
}

void TexelLevel::find(const float* u, const float* v, size_t count, uint32_t* texels,
                      uint32_t* blocks_of, uint32_t* is_inside) const {
    find_texels(u, v, count, size, block_shift, blocks_across, texels, blocks_of, is_inside);
}

std::vector<std::vector<TexelLevel>> texel_levels(std::span<const ReflectiveShadowMap> maps,
                                                  MipLevels mips) {
    std::vector<std::vector<TexelLevel>> all;
    for (const ReflectiveShadowMap& map : maps) {
        const MipChain chain(map, mips);
        std::vector<TexelLevel>& levels = all.emplace_back();
        for (int level = 0; level < chain.levels(); ++level)
            levels.emplace_back(chain.texels(level), chain.size(level));
    }
    return all;
}

} // namespace ql
