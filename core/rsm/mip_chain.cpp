#include "rsm/mip_chain.h"

#include <algorithm>
#include <cmath>

namespace ql {

namespace {

// How much of texel `fine` of `fine_size` lies in texel `coarse` of `coarse_size`, in fine texels.
double overlap(int fine, int fine_size, int coarse, int coarse_size) {
    const double ratio = double(fine_size) / coarse_size;
    const double begin = std::max(double(fine), coarse * ratio);
    const double end = std::min(double(fine + 1), (coarse + 1) * ratio);
    return std::max(0.0, end - begin);
}

// Sums of the texels under a coarser one.
struct BlockSum {
    V3d position{0, 0, 0}, normal{0, 0, 0}, flux{0, 0, 0};
    double radius2 = 0, depth = 0, seen = 0, all = 0;
    float offset = 0;

    void add(const Texels& t, size_t i, double weight) {
        all += weight;
        flux += V3d(t.flux(i)) * weight;
        if (!std::isfinite(t.depth[i])) return;
        seen += weight;
        position += V3d(t.position(i)) * weight;
        normal += V3d(t.normal(i)) * weight;
        radius2 += double(t.radius2[i]) * weight;
        depth += double(t.depth[i]) * weight;
        offset = std::max(offset, t.offset[i]);
    }

    void store(Texels& t, size_t i) const {
        const V3f f(flux / all);
        t.red[i] = f.x;
        t.green[i] = f.y;
        t.blue[i] = f.z;
        if (!(seen > 0)) return;
        const V3f p(position / seen), n(normal / seen);
        t.px[i] = p.x;
        t.py[i] = p.y;
        t.pz[i] = p.z;
        t.nx[i] = n.x;
        t.ny[i] = n.y;
        t.nz[i] = n.z;
        // The areas of the block add up.
        t.radius2[i] = float(radius2);
        t.depth[i] = float(depth / seen);
        t.offset[i] = offset;
    }
};

MipLevel halved(const Texels& fine, int fine_size) {
    MipLevel coarse{std::max(1, fine_size / 2), Texels()};
    coarse.texels = Texels(size_t(coarse.size) * size_t(coarse.size));
    const auto first = [&](int i) { return int(int64_t(i) * fine_size / coarse.size); };
    const auto last = [&](int i) {
        return std::min(fine_size,
                        int((int64_t(i + 1) * fine_size + coarse.size - 1) / coarse.size));
    };
    for (int y = 0; y < coarse.size; ++y)
        for (int x = 0; x < coarse.size; ++x) {
            BlockSum sum;
            for (int fy = first(y); fy < last(y); ++fy)
                for (int fx = first(x); fx < last(x); ++fx)
                    sum.add(fine, size_t(fy) * size_t(fine_size) + size_t(fx),
                            overlap(fx, fine_size, x, coarse.size) *
                                overlap(fy, fine_size, y, coarse.size));
            sum.store(coarse.texels, size_t(y) * size_t(coarse.size) + size_t(x));
        }
    return coarse;
}

} // namespace

MipChain::MipChain(const ReflectiveShadowMap& map, MipLevels levels_wanted) : m_map(&map) {
    while (levels_wanted == MipLevels::all && size(levels() - 1) > 1)
        m_levels.push_back(halved(texels(levels() - 1), size(levels() - 1)));
}

const Texels& MipChain::texels(int level) const {
    return level == 0 ? m_map->texels : m_levels[size_t(level - 1)].texels;
}

int MipChain::size(int level) const {
    return level == 0 ? m_map->size : m_levels[size_t(level - 1)].size;
}

int mip_level(float diameter_px, int levels) {
    const float level = std::log2(std::max(1.0f, diameter_px));
    return std::min(int(level + 0.5f), levels - 1);
}

} // namespace ql
