#include "rsm/texel_level.h"

#include "base/wide_kernel.h"

namespace ql {

TexelLevel::TexelLevel(const Texels& texels, int of_size, uint32_t of_map)
    : map(of_map), size(of_size), places(texels.count()), flux(texels.count()) {
    for (size_t i = 0; i < texels.count(); ++i) {
        flux[i] = texels.flux(i);
        const V3f normal = flux[i] == V3f(0, 0, 0) ? V3f(0) : texels.normal(i);
        places[i] = {texels.position(i), texels.radius2[i], normal, texels.offset[i]};
    }
}

// Written for the vectoriser: no branches.
QL_WIDE_KERNEL
void find_texels(const float* u, const float* v, const int* sizes, size_t count, uint32_t* texels,
                 uint32_t* is_inside) {
    const float* __restrict us = u;
    const float* __restrict vs = v;
    uint32_t* __restrict found = texels;
    uint32_t* __restrict inside = is_inside;
    for (size_t i = 0; i < count; ++i) {
        // NaN becomes 0.
        float x = us[i] > 0 ? us[i] : 0.0f, y = vs[i] > 0 ? vs[i] : 0.0f;
        x = x < 1 ? x : 1.0f;
        y = y < 1 ? y : 1.0f;
        inside[i] = uint32_t(x == us[i]) & uint32_t(y == vs[i]);
        const int size = sizes[i];
        int column = int(x * float(size)), row = int(y * float(size));
        column = column < size ? column : size - 1;
        row = row < size ? row : size - 1;
        found[i] = uint32_t(row * size + column);
    }
}

std::vector<std::vector<TexelLevel>> texel_levels(std::span<const ReflectiveShadowMap> maps,
                                                  MipLevels mips) {
    std::vector<std::vector<TexelLevel>> all;
    for (const ReflectiveShadowMap& map : maps) {
        const MipChain chain(map, mips);
        std::vector<TexelLevel>& levels = all.emplace_back();
        for (int level = 0; level < chain.levels(); ++level)
            levels.emplace_back(chain.texels(level), chain.size(level), uint32_t(all.size() - 1));
    }
    return all;
}

} // namespace ql
