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

// A chunk of samples, on the stack: first all texels are found, then all are read, so that the
// waits for memory overlap.
struct Gatherer::Batch {
    static constexpr size_t kCapacity = 128;
    std::array<Candidate, kCapacity> items;
    size_t count = 0;

    void add(const PackedTexel* texel, float weight, size_t number) {
        __builtin_prefetch(texel);
        items[count++] = {texel, weight, uint32_t(number), 0, {0, 0}};
    }
    // Its weight follows from the density there.
    void add(const PackedTexel* texel, size_t map, const V2f& uv, size_t number) {
        __builtin_prefetch(texel);
        items[count++] = {texel, 0, uint32_t(number), uint32_t(map), uv};
    }
    bool is_full() const { return count == kCapacity; }
};

const PackedTexel* Gatherer::Level::at(float u, float v) const {
    const int x = std::min(int(u * float(size)), size - 1);
    const int y = std::min(int(v * float(size)), size - 1);
    return &texels[size_t(y) * size_t(size) + size_t(x)];
}

Gatherer::Gatherer(const EmbreeScene& scene, std::span<const ReflectiveShadowMap> maps,
                   const GatherConfig& config)
    : m_scene(scene), m_maps(maps), m_config(config) {
    QL_CHECK(config.samples >= 1 && config.radius > 0);
    std::vector<double> map_flux;
    for (const ReflectiveShadowMap& map : maps)
        map_flux.push_back(mean(map.flux));
    m_map_table = AliasTable(map_flux);
    if (config.gather == Gather::full) return;
    if (config.gather == Gather::importance) m_texel_table = FluxTable(maps);
    const bool has_mips = config.gather == Gather::pattern && config.mips == MipUse::on;
    for (const ReflectiveShadowMap& map : maps) {
        const MipChain chain(map, has_mips ? MipLevels::all : MipLevels::first);
        std::vector<Level>& levels = m_levels.emplace_back();
        for (int level = 0; level < chain.levels(); ++level) {
            const Texels& t = chain.texels(level);
            levels.push_back({chain.size(level), std::vector<PackedTexel>(t.count())});
            for (size_t i = 0; i < t.count(); ++i)
                levels.back().texels[i] = {t.position(i), t.radius2[i], t.normal(i), t.offset[i],
                                           t.flux(i)};
        }
    }
}

bool Gatherer::is_visible(const Receiver& receiver, const V3f& target, uint32_t alpha_key,
                          ShadowLog& log) const {
    Ray ray;
    ray.origin = receiver.position + receiver.ng * receiver.offset;
    ray.direction = target - ray.origin;
    ray.t_far = 1;
    ++log.count;
    if (log.rays) log.rays->push_back(ray);
    return !m_scene.is_occluded(ray, alpha_key);
}

// Sum of weight Phi G V, without 1/pi.
V3f Gatherer::irradiance(const Receiver& receiver, const Batch& batch, uint32_t alpha_key,
                         ShadowLog& log) const {
    V3f sum(0);
    for (size_t i = 0; i < batch.count; ++i) {
        const PackedTexel& texel = *batch.items[i].texel;
        const float g =
            bounded_geometry(receiver, texel.position, texel.normal, texel.radius2, m_config.bound);
        if (!(g > 0) || texel.flux == V3f(0, 0, 0) || batch.items[i].weight == 0) continue;
        if (m_config.shadow_test == ShadowTest::on &&
            !is_visible(receiver, texel.position + texel.normal * texel.offset,
                        mixed(alpha_key, batch.items[i].number), log))
            continue;
        sum += texel.flux * (g * batch.items[i].weight);
    }
    return sum;
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
                const V3f target = texels.position(begin + i) +
                                   texels.normal(begin + i) * texels.offset[begin + i];
                if (is_visible(receiver, target, mixed(alpha_key, begin + i), log))
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
    const std::vector<Level>& levels = m_levels[index];
    const SinCos turn_angle = sin_cos_turns(turn);
    V3f sum(0);
    float weights = 0;
    Batch batch;
    for (size_t i = 0; i < samples.pattern.size(); ++i) {
        const float xi1 = samples.pattern[i].xi1;
        const SinCos angle = turned(samples.pattern[i].angle, turn_angle);
        const float weight = thesis ? xi1 * xi1 : xi1;
        weights += weight;
        const float u = centre.x + r * xi1 * angle.sin, v = centre.y + r * xi1 * angle.cos;
        if (!(u >= 0 && u <= 1 && v >= 0 && v <= 1)) continue;
        // Read the texel, or an average as wide as the samples are apart.
        const float diameter_px = float(map.size) * (r * xi1) * (r * xi1);
        const int level = levels.size() > 1 ? mip_level(diameter_px, int(levels.size())) : 0;
        batch.add(levels[size_t(level)].at(u, v), weight, i);
        if (!batch.is_full()) continue;
        sum += irradiance(receiver, batch, alpha_key, log);
        batch.count = 0;
    }
    sum += irradiance(receiver, batch, alpha_key, log);
    if (thesis) return weights > 0 ? sum / weights : V3f(0);
    // The density of samples is 1/(2 pi r^2 xi1) per map area, and 1/size^2 is that of a texel.
    const float texels = float(map.size) * float(map.size);
    return sum * (2 * r * r * texels / float(samples.pattern.size()));
}

// Of both kinds of samples together at a point of a map, per area of the map's square.
float Gatherer::density(size_t map, const V3f& flux, const V2f& uv, const V2f& centre,
                        const PassSamples& samples) const {
    const float texels = float(m_maps[map].texels.count());
    float sum = float(samples.flux.size()) * texels * m_texel_table.probability(flux);
    const float distance = (uv - centre).length();
    if (distance < m_config.radius && distance > 0)
        sum += float(samples.around.size()) * m_map_table.probability(map) /
               (2 * kPi * distance * m_config.radius);
    return sum;
}

// A texel by flux, a point anywhere in it.
void Gatherer::add_flux_sample(size_t i, const PassSamples& samples,
                               const std::array<float, 3>& shift, Batch& batch) const {
    const SampleNumbers& u = samples.flux[i];
    const auto [map, texel, uv] =
        m_texel_table.sample(shifted(u.pick, shift[0]), shifted(u.xi1, shift[1]));
    batch.add(&m_levels[map][0].texels[texel], map, uv, 2 * i);
}

// A point of the disc around the receiver's place in a map.
void Gatherer::add_disc_sample(size_t i, const PassSamples& samples,
                               const std::array<float, 3>& shift, const SinCos& turn,
                               std::span<const V2f> centres, Batch& batch) const {
    const SampleNumbers& u = samples.around[i];
    const size_t map = m_maps.size() > 1 ? m_map_table.sample(shifted(u.pick, shift[0])).index : 0;
    const SinCos angle = turned(u.angle, turn);
    const float distance = m_config.radius * shifted(u.xi1, shift[1]);
    const V2f uv(centres[map].x + distance * angle.sin, centres[map].y + distance * angle.cos);
    if (!(uv.x >= 0 && uv.x <= 1 && uv.y >= 0 && uv.y <= 1)) return;
    batch.add(m_levels[map][0].at(uv.x, uv.y), map, uv, 2 * i + 1);
}

V3f Gatherer::importance(const Receiver& receiver, const PassSamples& samples,
                         const std::array<float, 3>& shift, uint32_t alpha_key,
                         ShadowLog& log) const {
    if (m_texel_table.empty()) return V3f(0);
    // Where the receiver lies in each map; few scenes have more lights than fit on the stack.
    std::array<V2f, 16> few;
    std::vector<V2f> many(m_maps.size() > few.size() ? m_maps.size() : 0);
    const std::span<V2f> centres = many.empty() ? std::span<V2f>(few) : std::span<V2f>(many);
    for (size_t map = 0; map < m_maps.size(); ++map) {
        const V2f uv = m_maps[map].projection.point(receiver.position).uv;
        centres[map] = {std::clamp(uv.x, 0.0f, 1.0f), std::clamp(uv.y, 0.0f, 1.0f)};
    }

    V3f sum(0);
    Batch batch;
    const auto finish = [&] {
        for (size_t i = 0; i < batch.count; ++i) {
            Candidate& c = batch.items[i];
            const float all = density(c.map, c.texel->flux, c.uv, centres[c.map], samples);
            const float texels = float(m_maps[c.map].texels.count());
            c.weight = all > 0 && std::isfinite(all) ? texels / all : 0;
        }
        sum += irradiance(receiver, batch, alpha_key, log);
        batch.count = 0;
    };
    for (size_t i = 0; i < samples.flux.size(); ++i) {
        add_flux_sample(i, samples, shift, batch);
        if (batch.is_full()) finish();
    }
    const SinCos turn = sin_cos_turns(shift[2]);
    for (size_t i = 0; i < samples.around.size(); ++i) {
        add_disc_sample(i, samples, shift, turn, centres, batch);
        if (batch.is_full()) finish();
    }
    finish();
    return sum / kPi;
}

} // namespace ql
