#include "rsm/gather.h"

#include "base/check.h"

#include <algorithm>

namespace ql {

namespace {

// Texels whose geometry terms are computed at a time.
constexpr size_t kBlock = 64;

} // namespace

Gatherer::Gatherer(const EmbreeScene& scene, std::span<const ReflectiveShadowMap> maps,
                   const GatherConfig& config)
    : m_scene(scene), m_maps(maps), m_config(config) {
    QL_CHECK(config.samples >= 1 && config.radius > 0);
    std::vector<double> map_flux;
    for (const ReflectiveShadowMap& map : maps)
        map_flux.push_back((map.flux.x + map.flux.y + map.flux.z) / 3);
    m_map_table = AliasTable(map_flux);
    if (config.gather == Gather::full) return;
    if (config.gather == Gather::importance) m_texel_table = FluxTable(maps);
    const bool has_mips = config.gather == Gather::pattern && config.mips == MipUse::on;
    m_levels = texel_levels(maps, has_mips ? MipLevels::all : MipLevels::first);
}

V3f Gatherer::irradiance(const Receiver& receiver, const PassSamples& samples,
                         const CellPlace& place, uint32_t alpha_key, ShadowLog& log) const {
    if (m_map_table.empty()) return V3f(0);
    SeenSum sum(m_scene, receiver, m_config.shadow_test, log);
    switch (m_config.gather) {
    case Gather::pattern: {
        for (size_t map = 0; map < m_maps.size(); ++map)
            add_pattern(receiver, map, samples.disc, place, alpha_key_of(alpha_key, map), sum);
        break;
    }
    case Gather::importance:
        if (!m_texel_table.empty()) add_importance(receiver, samples, place, alpha_key, sum);
        break;
    case Gather::full:
        add_full(receiver, alpha_key, sum);
        break;
    }
    return V3f(sum.sum());
}

void Gatherer::add_full(const Receiver& receiver, uint32_t alpha_key, SeenSum& sum) const {
    float g[kBlock];
    for (const ReflectiveShadowMap& map : m_maps) {
        const Texels& t = map.texels;
        for (size_t begin = 0; begin < t.count(); begin += kBlock) {
            const size_t count = std::min(kBlock, t.count() - begin);
            const TexelArrays block{&t.px[begin], &t.py[begin], &t.pz[begin],     &t.nx[begin],
                                    &t.ny[begin], &t.nz[begin], &t.radius2[begin]};
            bounded_geometry(receiver, block, count, m_config.bound, g);
            for (size_t i = 0; i < count; ++i) {
                if (!(g[i] > 0)) continue;
                const size_t p = begin + i;
                const V3f light = t.flux(p) * (g[i] * kInvPi);
                if (light == V3f(0, 0, 0)) continue;
                sum.add(t.position(p) + t.normal(p) * t.offset[p], light,
                        alpha_key_of(alpha_key, p));
            }
        }
    }
}

} // namespace ql
