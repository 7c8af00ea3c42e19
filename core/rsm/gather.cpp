#include "rsm/gather.h"

#include "base/check.h"
#include "sampling/warp.h"

#include <cmath>

namespace ql {

namespace {

// Texels whose geometry terms are computed at a time.
constexpr size_t kBlock = 64;
// Keeps 0/0 away where a texel lies on the receiver; d^4 is 1e-26 at the distances that rounding
// allows.
constexpr float kTiny = 1e-35f;

double mean(const V3d& v) {
    return (v.x + v.y + v.z) / 3;
}

uint32_t mixed(uint32_t key, size_t number) {
    return key ^ (uint32_t(number) * 0x9e3779b9u);
}

// The terms of texels [begin, begin + count), count at most kBlock. Written for the vectoriser:
// no branches, one array for each value.
void geometry_block(const Receiver& receiver, const Texels& texels, size_t begin, size_t count,
                    const GeometryBound& bound, float* __restrict out) {
    const float* __restrict px = &texels.px[begin];
    const float* __restrict py = &texels.py[begin];
    const float* __restrict pz = &texels.pz[begin];
    const float* __restrict nx = &texels.nx[begin];
    const float* __restrict ny = &texels.ny[begin];
    const float* __restrict nz = &texels.nz[begin];
    const float* __restrict radius2 = &texels.radius2[begin];
    const V3f x = receiver.position, ng = receiver.ng, ns = receiver.ns;
    const float scale = bound.radius2_scale, least = bound.least_distance2;
    for (size_t i = 0; i < count; ++i) {
        const float dx = px[i] - x.x, dy = py[i] - x.y, dz = pz[i] - x.z;
        const float d2 = dx * dx + dy * dy + dz * dz;
        const float at_texel = -(nx[i] * dx + ny[i] * dy + nz[i] * dz);
        const float at_plane = ng.x * dx + ng.y * dy + ng.z * dz;
        const float at_receiver = ns.x * dx + ns.y * dy + ns.z * dz;
        const float widened = d2 + scale * radius2[i];
        const float divisor = widened > least ? widened : least;
        const float lit = at_texel > kPlaneNoise ? at_texel : 0.0f;
        const float facing = at_plane > kPlaneNoise ? at_receiver : 0.0f;
        out[i] = lit * (facing > 0 ? facing : 0.0f) / (d2 * divisor + kTiny);
    }
}

} // namespace

float bounded_geometry(const Receiver& receiver, const V3f& position, const V3f& normal,
                       float radius2, const GeometryBound& bound) {
    const V3f d = position - receiver.position;
    const float at_texel = -normal.dot(d);
    const float at_receiver = receiver.ns.dot(d);
    if (!(at_texel > kPlaneNoise) || !(receiver.ng.dot(d) > kPlaneNoise) || !(at_receiver > 0))
        return 0;
    const float d2 = d.dot(d);
    return at_texel * at_receiver / (d2 * bound.divisor(d2, radius2) + kTiny);
}

Gatherer::Gatherer(const EmbreeScene& scene, std::span<const ReflectiveShadowMap> maps,
                   const GatherConfig& config)
    : m_scene(scene), m_maps(maps), m_config(config) {
    QL_CHECK(config.samples >= 1 && config.radius > 0);
    std::vector<double> map_flux, texel_flux;
    for (const ReflectiveShadowMap& map : maps) {
        map_flux.push_back(mean(map.flux));
        if (config.gather == Gather::pattern && config.mips == MipUse::on) m_mips.emplace_back(map);
        if (config.gather != Gather::importance) continue;
        m_first_texel.push_back(texel_flux.size());
        for (size_t i = 0; i < map.texels.count(); ++i)
            texel_flux.push_back(mean(V3d(map.texels.flux(i))));
    }
    m_map_table = AliasTable(map_flux);
    m_texel_table = AliasTable(texel_flux);
}

bool Gatherer::is_visible(const Receiver& receiver, const Texels& texels, size_t texel,
                          uint32_t alpha_key, ShadowLog& log) const {
    const V3f target = texels.position(texel) + texels.normal(texel) * texels.offset[texel];
    Ray ray;
    ray.origin = receiver.position + receiver.ng * receiver.offset;
    ray.direction = target - ray.origin;
    ray.t_far = 1;
    ++log.count;
    if (log.rays) log.rays->push_back(ray);
    return !m_scene.is_occluded(ray, alpha_key);
}

// Phi G V of one texel, without 1/pi.
V3f Gatherer::texel_irradiance(const Receiver& receiver, const Texels& texels, size_t texel,
                               uint32_t alpha_key, ShadowLog& log) const {
    const V3f flux = texels.flux(texel);
    if (flux == V3f(0, 0, 0)) return V3f(0);
    const float g = bounded_geometry(receiver, texels.position(texel), texels.normal(texel),
                                     texels.radius2[texel], m_config.bound);
    if (!(g > 0)) return V3f(0);
    if (m_config.shadow_test == ShadowTest::on &&
        !is_visible(receiver, texels, texel, alpha_key, log))
        return V3f(0);
    return flux * g;
}

V3f Gatherer::irradiance(const Receiver& receiver, const PassSamples& samples,
                         const std::array<float, 3>& shift, uint32_t alpha_key,
                         ShadowLog& log) const {
    if (m_map_table.empty()) return V3f(0);
    switch (m_config.gather) {
    case Gather::pattern:
        return pattern(receiver, samples, shift[2], alpha_key, log);
    case Gather::importance:
        return importance(receiver, samples, shift, alpha_key, log);
    case Gather::full:
        break;
    }
    return m_config.shadow_test == ShadowTest::on ? full(receiver, alpha_key, log)
                                                  : full_unshadowed(receiver);
}

V3f Gatherer::full(const Receiver& receiver, uint32_t alpha_key, ShadowLog& log) const {
    V3d sum(0);
    float g[kBlock];
    for (const ReflectiveShadowMap& map : m_maps) {
        const Texels& texels = map.texels;
        for (size_t begin = 0; begin < texels.count(); begin += kBlock) {
            const size_t count = std::min(kBlock, texels.count() - begin);
            geometry_block(receiver, texels, begin, count, m_config.bound, g);
            for (size_t i = 0; i < count; ++i) {
                if (!(g[i] > 0)) continue;
                const V3f flux = texels.flux(begin + i);
                if (flux == V3f(0, 0, 0)) continue;
                if (is_visible(receiver, texels, begin + i, mixed(alpha_key, begin + i), log))
                    sum += V3d(flux) * double(g[i]);
            }
        }
    }
    return V3f(sum / double(kPi));
}

V3f Gatherer::full_unshadowed(const Receiver& receiver) const {
    V3d sum(0);
    float g[kBlock];
    for (const ReflectiveShadowMap& map : m_maps) {
        const Texels& texels = map.texels;
        for (size_t begin = 0; begin < texels.count(); begin += kBlock) {
            const size_t count = std::min(kBlock, texels.count() - begin);
            geometry_block(receiver, texels, begin, count, m_config.bound, g);
            // Few terms at a time in float, and all of them in double.
            V3f block(0);
            for (size_t i = 0; i < count; ++i)
                block += texels.flux(begin + i) * g[i];
            sum += V3d(block);
        }
    }
    return V3f(sum / double(kPi));
}

V3f Gatherer::pattern(const Receiver& receiver, const PassSamples& samples, float turn,
                      uint32_t alpha_key, ShadowLog& log) const {
    V3f sum(0);
    for (size_t map = 0; map < m_maps.size(); ++map)
        sum += map_pattern(receiver, map, samples, turn, mixed(alpha_key, map), log);
    return sum;
}

V3f Gatherer::map_pattern(const Receiver& receiver, size_t index, const PassSamples& samples,
                          float turn, uint32_t alpha_key, ShadowLog& log) const {
    const ReflectiveShadowMap& map = m_maps[index];
    const bool thesis = m_config.weights == PatternWeights::thesis;
    const auto at = map.projection.point(receiver.position);
    if (thesis && !at.is_ahead) return V3f(0);
    // The thesis lets discs leave the map with the points they belong to; ours stay on its border.
    const V2f centre =
        thesis ? at.uv : V2f(std::clamp(at.uv.x, 0.0f, 1.0f), std::clamp(at.uv.y, 0.0f, 1.0f));
    const float r = m_config.radius;
    V3f sum(0);
    float weights = 0;
    for (size_t i = 0; i < samples.pattern.size(); ++i) {
        const float xi1 = samples.pattern[i].x;
        const SinCos angle = sin_cos_turns(shifted(samples.pattern[i].y, turn));
        const float weight = thesis ? xi1 * xi1 : xi1;
        weights += weight;
        const V2f uv(centre.x + r * xi1 * angle.sin, centre.y + r * xi1 * angle.cos);
        // Read the texel, or an average as wide as the samples are apart.
        const int64_t texel = map.texel_at(uv.x, uv.y);
        if (texel < 0) continue;
        const uint32_t key = mixed(alpha_key, i);
        if (m_mips.empty()) {
            sum += texel_irradiance(receiver, map.texels, size_t(texel), key, log) * weight;
            continue;
        }
        const MipChain& mips = m_mips[index];
        const float diameter_px = float(map.size) * (r * xi1) * (r * xi1);
        const int level = mips.level_for(diameter_px);
        const int size = mips.size(level);
        const int x = std::min(int(uv.x * float(size)), size - 1);
        const int y = std::min(int(uv.y * float(size)), size - 1);
        sum += texel_irradiance(receiver, mips.texels(level), size_t(y) * size_t(size) + size_t(x),
                                key, log) *
               weight;
    }
    if (thesis) return weights > 0 ? sum / weights : V3f(0);
    // The density of samples is 1/(2 pi r^2 xi1) per map area, and 1/size^2 is that of a texel.
    const float texels = float(map.size) * float(map.size);
    return sum * (2 * r * r * texels / float(samples.pattern.size()));
}

// Of both kinds of samples together at a point of a map, per area of the map's square.
float Gatherer::density(size_t map, size_t texel, const V2f& uv, const V2f& centre,
                        const PassSamples& samples) const {
    const float texels = float(m_maps[map].texels.count());
    float sum =
        float(samples.flux.size()) * texels * m_texel_table.probability(m_first_texel[map] + texel);
    const float distance = (uv - centre).length();
    if (distance < m_config.radius && distance > 0)
        sum += float(samples.around.size()) * m_map_table.probability(map) /
               (2 * kPi * distance * m_config.radius);
    return sum;
}

V3f Gatherer::importance(const Receiver& receiver, const PassSamples& samples,
                         const std::array<float, 3>& shift, uint32_t alpha_key,
                         ShadowLog& log) const {
    const auto centre_in = [&](size_t map) {
        const V2f uv = m_maps[map].projection.point(receiver.position).uv;
        return V2f(std::clamp(uv.x, 0.0f, 1.0f), std::clamp(uv.y, 0.0f, 1.0f));
    };
    V3f sum(0);
    const auto add = [&](size_t map, size_t texel, const V2f& uv, const V2f& centre, uint32_t key) {
        const float all = density(map, texel, uv, centre, samples);
        if (!(all > 0) || !std::isfinite(all)) return;
        const float texels = float(m_maps[map].texels.count());
        sum += texel_irradiance(receiver, m_maps[map].texels, texel, key, log) * (texels / all);
    };

    // Texels by flux, a point anywhere in each.
    for (size_t i = 0; i < samples.flux.size(); ++i) {
        const SampleNumbers& u = samples.flux[i];
        const size_t global = m_texel_table.sample(shifted(u.pick, shift[0])).index;
        size_t map = m_maps.size() - 1;
        while (m_first_texel[map] > global)
            --map;
        const size_t texel = global - m_first_texel[map];
        const auto size = size_t(m_maps[map].size);
        const V2f uv((float(texel % size) + shifted(u.xi1, shift[1])) / float(size),
                     (float(texel / size) + shifted(u.xi2, shift[2])) / float(size));
        add(map, texel, uv, centre_in(map), mixed(alpha_key, 2 * i));
    }

    // Points of the disc around the receiver's place in a map.
    for (size_t i = 0; i < samples.around.size(); ++i) {
        const SampleNumbers& u = samples.around[i];
        const size_t map = m_map_table.sample(shifted(u.pick, shift[0])).index;
        const V2f centre = centre_in(map);
        const SinCos angle = sin_cos_turns(shifted(u.xi2, shift[2]));
        const float distance = m_config.radius * shifted(u.xi1, shift[1]);
        const V2f uv(centre.x + distance * angle.sin, centre.y + distance * angle.cos);
        const int64_t texel = m_maps[map].texel_at(uv.x, uv.y);
        if (texel >= 0) add(map, size_t(texel), uv, centre, mixed(alpha_key, 2 * i + 1));
    }
    return sum / kPi;
}

} // namespace ql
