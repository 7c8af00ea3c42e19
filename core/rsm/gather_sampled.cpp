#include "rsm/gather.h"

#include <cmath>

namespace ql {

namespace {

// Where the receiver lies in a map; on its border if that is outside.
V2f place_in(const ReflectiveShadowMap& map, const Receiver& receiver) {
    const V2f uv = map.projection.point(receiver.position).uv;
    return {std::min(std::max(0.0f, uv.x), 1.0f), std::min(std::max(0.0f, uv.y), 1.0f)};
}

// Numbers of samples; those by flux are even.
uint32_t flux_number(size_t i) {
    return uint32_t(2 * i);
}
uint32_t disc_number(size_t i) {
    return uint32_t(2 * i + 1);
}

} // namespace

// A chunk of samples, on the stack: first all texels are found, then all are read, so that the
// waits for memory overlap. Whether a texel counts is a coin's throw, so nothing branches on it
// before the rays.
struct Gatherer::Batch {
    static constexpr size_t kCapacity = 128;

    size_t count = 0;
    float u[kCapacity], v[kCapacity];
    int size[kCapacity]; // of the level
    const TexelLevel* level[kCapacity];
    uint32_t number[kCapacity]; // of the sample
    uint32_t texel[kCapacity];

    const TexelPlace& place(size_t i) const { return level[i]->places[texel[i]]; }
    const V3f& flux(size_t i) const { return level[i]->flux[texel[i]]; }

    void add(const TexelLevel& of, const V2f& uv, uint32_t of_sample) {
        u[count] = uv.x;
        v[count] = uv.y;
        size[count] = of.size;
        level[count] = &of;
        number[count++] = of_sample;
    }

    // Finds the texels of all points, and drops points that are in none.
    void find() {
        uint32_t inside[kCapacity];
        find_texels(u, v, size, count, texel, inside);
        size_t kept = 0;
        for (size_t i = 0; i < count; ++i) {
            __builtin_prefetch(&place(i));
            u[kept] = u[i];
            v[kept] = v[i];
            level[kept] = level[i];
            number[kept] = number[i];
            texel[kept] = texel[i];
            kept += inside[i];
        }
        count = kept;
    }
};

// weight: of an item of the batch; asked for those alone that face the receiver.
template<class Weight>
void Gatherer::add_batch(const Receiver& receiver, const Batch& batch, uint32_t alpha_key,
                         const Weight& weight, SeenSum& sum) const {
    // Compute the geometry terms.
    constexpr size_t kMost = Batch::kCapacity;
    float px[kMost], py[kMost], pz[kMost], nx[kMost], ny[kMost], nz[kMost], radius2[kMost];
    for (size_t i = 0; i < batch.count; ++i) {
        const TexelPlace& place = batch.place(i);
        px[i] = place.position.x;
        py[i] = place.position.y;
        pz[i] = place.position.z;
        radius2[i] = place.radius2;
        nx[i] = place.normal.x;
        ny[i] = place.normal.y;
        nz[i] = place.normal.z;
    }
    float g[kMost];
    bounded_geometry(receiver, {px, py, pz, nx, ny, nz, radius2}, batch.count, m_config.bound, g);

    // Keep those that are not 0.
    uint32_t lit[kMost];
    size_t lit_count = 0;
    for (size_t i = 0; i < batch.count; ++i) {
        lit[lit_count] = uint32_t(i);
        lit_count += g[i] > 0 ? 1 : 0;
    }
    for (size_t k = 0; k < lit_count; ++k) {
        const size_t i = lit[k];
        __builtin_prefetch(&batch.flux(i));
        if (!m_texel_table.empty())
            m_texel_table.prefetch_density(batch.level[i]->map, {batch.u[i], batch.v[i]});
    }

    // Add what is seen.
    for (size_t k = 0; k < lit_count; ++k) {
        const size_t i = lit[k];
        const float w = weight(i);
        if (!(w > 0)) continue;
        const TexelPlace& place = batch.place(i);
        sum.add(place.position + place.normal * place.offset, batch.flux(i) * (g[i] * w),
                alpha_key_of(alpha_key, batch.number[i]));
    }
}

void Gatherer::add_pattern(const Receiver& receiver, size_t index, const PassSamples& samples,
                           const SinCos& turn, uint32_t alpha_key, SeenSum& sum) const {
    const ReflectiveShadowMap& map = m_maps[index];
    const bool thesis = m_config.weights == PatternWeights::thesis;
    const auto at = map.projection.point(receiver.position);
    if (thesis && !at.is_ahead) return;
    // The thesis lets discs leave the map with the points they belong to; ours stay on its border.
    const V2f centre = thesis ? at.uv : place_in(map, receiver);
    const float r = m_config.radius;
    const PatternPoints& points = samples.pattern;
    const std::vector<TexelLevel>& levels = m_levels[index];

    // The density of samples is 1/(2 pi r^2 xi1) per map area, and 1/size^2 is that of a texel. The
    // thesis divides by all weights.
    const float texels = float(map.size) * float(map.size);
    const float scale =
        thesis ? 1 / points.sum_of_squares : 2 * r * r * texels / float(points.size());
    Batch batch;
    const auto weight = [&](size_t i) {
        const float xi1 = points.xi1[batch.number[i]];
        return scale * (thesis ? xi1 * xi1 : xi1);
    };
    for (size_t begin = 0; begin < points.size(); begin += Batch::kCapacity) {
        batch.count = 0;
        const size_t end = std::min(points.size(), begin + Batch::kCapacity);
        for (size_t i = begin; i < end; ++i) {
            const V2f uv(centre.x + r * (points.x[i] * turn.cos + points.y[i] * turn.sin),
                         centre.y + r * (points.y[i] * turn.cos - points.x[i] * turn.sin));
            // The texel there, or an average as wide as the samples are apart.
            const float distance = r * points.xi1[i];
            const int level = levels.size() > 1 ? mip_level(float(map.size) * distance * distance,
                                                            int(levels.size()))
                                                : 0;
            batch.add(levels[size_t(level)], uv, uint32_t(i));
        }
        batch.find();
        add_batch(receiver, batch, alpha_key, weight, sum);
    }
}

// Points by flux.
void Gatherer::choose_by_flux(const PassSamples& samples, const std::array<float, 3>& shift,
                              size_t begin, Batch& batch) const {
    const size_t count = std::min(samples.flux.size() - begin, Batch::kCapacity);
    const auto u_row = [&](size_t i) { return shifted(samples.flux[begin + i].pick, shift[0]); };
    const auto u_place = [&](size_t i) { return shifted(samples.flux[begin + i].xi1, shift[1]); };
    uint32_t rows[Batch::kCapacity];
    for (size_t i = 0; i < count; ++i) {
        rows[i] = m_texel_table.row(u_row(i));
        m_texel_table.prefetch(rows[i], u_place(i));
    }
    for (size_t i = 0; i < count; ++i) {
        const FluxTable::Choice choice = m_texel_table.choice(rows[i], u_row(i), u_place(i));
        batch.add(m_levels[choice.map][0], choice.uv, flux_number(begin + i));
    }
}

// Points of the discs around the receiver's places in the maps.
void Gatherer::choose_in_disc(const PassSamples& samples, const std::array<float, 3>& shift,
                              std::span<const V2f> centres, size_t begin, Batch& batch) const {
    const SinCos turn = sin_cos_turns(shift[2]);
    const size_t end = std::min(samples.around.size(), begin + Batch::kCapacity);
    for (size_t i = begin; i < end; ++i) {
        const SampleNumbers& u = samples.around[i];
        const size_t map =
            m_maps.size() > 1 ? m_map_table.sample(shifted(u.pick, shift[0])).index : 0;
        const SinCos angle = turned(u.angle, turn);
        const float distance = m_config.radius * shifted(u.xi1, shift[1]);
        const V2f& centre = centres[map];
        batch.add(m_levels[map][0],
                  {centre.x + distance * angle.sin, centre.y + distance * angle.cos},
                  disc_number(i));
    }
}

// Of both kinds of samples together at a point of a map, per area of the map's square.
float Gatherer::density(uint32_t map, const V2f& uv, const V2f& centre,
                        const PassSamples& samples) const {
    float sum = float(samples.flux.size()) * m_texel_table.density(map, uv);
    const float distance2 = (uv - centre).length2();
    if (distance2 < m_config.radius * m_config.radius && distance2 > 0)
        sum += float(samples.around.size()) * m_map_table.probability(map) /
               (2 * kPi * std::sqrt(distance2) * m_config.radius);
    return sum;
}

void Gatherer::add_importance(const Receiver& receiver, const PassSamples& samples,
                              const std::array<float, 3>& shift, uint32_t alpha_key,
                              SeenSum& sum) const {
    // Find the receiver in each map; few scenes have more lights than fit on the stack.
    std::array<V2f, 16> few;
    std::vector<V2f> many(m_maps.size() > few.size() ? m_maps.size() : 0);
    const std::span<V2f> centres = many.empty() ? std::span<V2f>(few) : std::span<V2f>(many);
    for (size_t map = 0; map < m_maps.size(); ++map)
        centres[map] = place_in(m_maps[map], receiver);

    Batch batch;
    const auto weight = [&](size_t i) {
        const uint32_t map = batch.level[i]->map;
        const float all = density(map, {batch.u[i], batch.v[i]}, centres[map], samples);
        const float texels = float(m_maps[map].texels.count());
        return all > 0 && std::isfinite(all) ? texels * kInvPi / all : 0.0f;
    };
    const auto add = [&](size_t count, const auto& choose) {
        for (size_t begin = 0; begin < count; begin += Batch::kCapacity) {
            batch.count = 0;
            choose(begin);
            batch.find();
            add_batch(receiver, batch, alpha_key, weight, sum);
        }
    };
    add(samples.flux.size(), [&](size_t begin) { choose_by_flux(samples, shift, begin, batch); });
    add(samples.around.size(),
        [&](size_t begin) { choose_in_disc(samples, shift, centres, begin, batch); });
}

} // namespace ql
