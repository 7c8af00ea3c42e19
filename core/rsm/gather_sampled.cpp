#include "rsm/gather.h"

#include "base/wide_kernel.h"

#include <cmath>

namespace ql {

namespace {

// Samples that are looked up together, on the stack.
constexpr size_t kChunk = 128;

// Where the receiver lies in a map; on its border if that is outside.
V2f place_in(const ReflectiveShadowMap& map, const Receiver& receiver) {
    const V2f uv = map.projection.point(receiver.position).uv;
    return {std::min(std::max(0.0f, uv.x), 1.0f), std::min(std::max(0.0f, uv.y), 1.0f)};
}

// The points of a disc as a pixel turns and shifts them. Written for the vectoriser: no branches.
QL_WIDE_KERNEL
void disc_points(const float* xi1, const float* sine, const float* cosine, size_t count,
                 float shift, const SinCos& turn, float* distance, float* x, float* y) {
    const float* __restrict numbers = xi1;
    const float* __restrict sines = sine;
    const float* __restrict cosines = cosine;
    float* __restrict distances = distance;
    float* __restrict xs = x;
    float* __restrict ys = y;
    const float s = turn.sin, c = turn.cos;
    for (size_t i = 0; i < count; ++i) {
        const float sum = numbers[i] + shift;
        const float d = sum < 1 ? sum : sum - 1;
        distances[i] = d;
        xs[i] = d * (sines[i] * c + cosines[i] * s);
        ys[i] = d * (cosines[i] * c - sines[i] * s);
    }
}

} // namespace

// Points of one level of a map: first all texels are found, then all are read, so that the waits
// for memory overlap. Whether a texel counts is a coin's throw, so nothing branches on it before
// the rays.
struct Gatherer::Batch {
    size_t count = 0;
    float u[kChunk], v[kChunk];
    uint32_t number[kChunk]; // of the sample

    void add(float of_u, float of_v, size_t of_sample) {
        u[count] = of_u;
        v[count] = of_v;
        number[count++] = uint32_t(of_sample);
    }
};

// weight(i): of a point of the batch, asked for those alone whose texel faces the receiver;
// weight.fetch(i): begins to fetch what that needs.
template<class Weight>
void Gatherer::add_batch(const Receiver& receiver, const TexelLevel& level, const Batch& batch,
                         uint32_t alpha_key, const Weight& weight, SeenSum& sum) const {
    // Find the texels, and keep those whose blocks may light the receiver.
    uint32_t texel[kChunk], block[kChunk], inside[kChunk], kept[kChunk];
    level.find(batch.u, batch.v, batch.count, texel, block, inside);
    size_t kept_count = 0;
    for (size_t i = 0; i < batch.count; ++i) {
        kept[kept_count] = uint32_t(i);
        kept_count += inside[i] & uint32_t(level.blocks[block[i]].may_light(receiver));
    }
    for (size_t k = 0; k < kept_count; ++k) {
        __builtin_prefetch(&level.records[texel[kept[k]]]);
        weight.fetch(kept[k]);
    }

    // Compute the geometry terms.
    float px[kChunk], py[kChunk], pz[kChunk], nx[kChunk], ny[kChunk], nz[kChunk], radius2[kChunk];
    for (size_t k = 0; k < kept_count; ++k) {
        const TexelRecord& record = level.records[texel[kept[k]]];
        px[k] = record.position.x;
        py[k] = record.position.y;
        pz[k] = record.position.z;
        radius2[k] = record.radius2;
        nx[k] = record.normal.x;
        ny[k] = record.normal.y;
        nz[k] = record.normal.z;
    }
    float g[kChunk];
    bounded_geometry(receiver, {px, py, pz, nx, ny, nz, radius2}, kept_count, m_config.bound, g);

    // Keep those that are not 0, and add what is seen.
    uint32_t lit[kChunk];
    size_t lit_count = 0;
    for (size_t k = 0; k < kept_count; ++k) {
        lit[lit_count] = uint32_t(k);
        lit_count += g[k] > 0 ? 1 : 0;
    }
    for (size_t j = 0; j < lit_count; ++j) {
        const size_t k = lit[j], i = kept[k];
        const float w = weight(i);
        if (!(w > 0)) continue;
        const TexelRecord& record = level.records[texel[i]];
        sum.add(record.position + record.normal * record.offset, record.flux * (g[k] * w),
                alpha_key_of(alpha_key, batch.number[i]));
    }
}

struct Gatherer::PatternWeight {
    const Batch& batch;
    const float* xi1; // of the samples from number `first` on
    size_t first;
    float scale;
    bool is_squared;

    void fetch(size_t) const {}
    float operator()(size_t i) const {
        const float number = xi1[batch.number[i] - first];
        return scale * (is_squared ? number * number : number);
    }
};

void Gatherer::add_pattern(const Receiver& receiver, size_t index, const DiscPoints& disc,
                           const CellPlace& place, uint32_t alpha_key, SeenSum& sum) const {
    const ReflectiveShadowMap& map = m_maps[index];
    const bool thesis = m_config.weights == PatternWeights::thesis;
    const auto at = map.projection.point(receiver.position);
    if (thesis && !at.is_ahead) return;
    // The thesis lets discs leave the map with the points they belong to; ours stay on its border.
    const V2f centre = thesis ? at.uv : place_in(map, receiver);
    const std::vector<TexelLevel>& levels = m_levels[index];
    const V2f shift = disc.cell.shift(place);
    const SinCos turn = sin_cos_turns(shift.y);

    // The density of samples is 1/(2 pi r^2 xi1) per map area, and 1/size^2 is that of a texel. The
    // thesis divides by all weights.
    const float r = m_config.radius, texels = float(map.size) * float(map.size);
    const float scale =
        thesis ? 1 / disc.sum_of_squares(shift.x) : 2 * r * r * texels / float(disc.size());
    for (size_t begin = 0; begin < disc.size(); begin += kChunk) {
        const size_t count = std::min(disc.size() - begin, kChunk);
        float xi1[kChunk], x[kChunk], y[kChunk];
        disc_points(&disc.xi1[begin], &disc.sine[begin], &disc.cosine[begin], count, shift.x, turn,
                    xi1, x, y);
        // The texel there, or an average as wide as the samples are apart.
        uint32_t level[kChunk];
        for (size_t i = 0; i < count && levels.size() > 1; ++i)
            level[i] = uint32_t(
                mip_level(float(map.size) * (r * xi1[i]) * (r * xi1[i]), int(levels.size())));
        for (size_t l = 0; l < levels.size(); ++l) {
            Batch batch;
            for (size_t i = 0; i < count; ++i)
                if (levels.size() == 1 || level[i] == l)
                    batch.add(centre.x + r * x[i], centre.y + r * y[i], begin + i);
            if (batch.count > 0)
                add_batch(receiver, levels[l], batch, alpha_key,
                          PatternWeight{batch, xi1, begin, scale, thesis}, sum);
        }
    }
}

// What the samples of importance share. Samples are numbered by flux first, then around.
struct Gatherer::ImportanceJob {
    const Receiver& receiver;
    const PassSamples& samples;
    uint32_t alpha_key;
    std::span<const V2f> centres; // the receiver's places in the maps
    SeenSum& sum;
};

// One over the density of both kinds of samples together, in samples per texel.
struct Gatherer::ImportanceWeight {
    const Gatherer& gatherer;
    const ImportanceJob& job;
    const Batch& batch;
    size_t map;

    void fetch(size_t i) const {
        gatherer.m_texel_table.prefetch_density(map, {batch.u[i], batch.v[i]});
    }
    float operator()(size_t i) const {
        const V2f uv(batch.u[i], batch.v[i]);
        const float radius = gatherer.m_config.radius;
        const float texels = float(gatherer.m_maps[map].texels.count());
        float density = float(job.samples.flux.size()) * gatherer.m_texel_table.density(map, uv);
        const float distance2 = (uv - job.centres[map]).length2();
        if (distance2 < radius * radius) // infinite in the middle, which is never chosen
            density += float(job.samples.disc.size()) * gatherer.m_map_table.probability(map) /
                       (2 * kPi * std::sqrt(distance2) * radius);
        return density > 0 && std::isfinite(density) ? texels * kInvPi / density : 0.0f;
    }
};

// Points of all maps, map[i] that of the i-th.
void Gatherer::add_importance_chunk(const ImportanceJob& job, const Batch& points,
                                    const uint32_t* map) const {
    for (size_t m = 0; m < m_maps.size(); ++m) {
        Batch of_map;
        if (m_maps.size() > 1)
            for (size_t i = 0; i < points.count; ++i)
                if (map[i] == m) of_map.add(points.u[i], points.v[i], points.number[i]);
        const Batch& batch = m_maps.size() > 1 ? of_map : points;
        if (batch.count == 0) continue;
        add_batch(job.receiver, m_levels[m][0], batch, job.alpha_key,
                  ImportanceWeight{*this, job, batch, m}, job.sum);
    }
}

// Points by flux.
void Gatherer::add_by_flux(const ImportanceJob& job, const CellPlace& place) const {
    const FluxPoints& flux = job.samples.flux;
    const V2f shift = flux.cell.shift(place);
    for (size_t begin = 0; begin < flux.size(); begin += kChunk) {
        const size_t end = std::min(begin + kChunk, flux.size());
        Batch points;
        uint32_t row[kChunk], column[kChunk], map[kChunk];
        const auto u_row = [&](size_t i) { return shifted(flux.u[i], shift.x); };
        const auto u_place = [&](size_t i) { return shifted(flux.v[i], shift.y); };
        for (size_t i = begin; i < end; ++i)
            row[i - begin] = m_texel_table.row(u_row(i), u_place(i));
        for (size_t i = begin; i < end; ++i)
            column[i - begin] = m_texel_table.first_column(row[i - begin], u_place(i));
        for (size_t i = begin; i < end; ++i) {
            const auto choice =
                m_texel_table.choice(row[i - begin], column[i - begin], u_row(i), u_place(i));
            map[i - begin] = choice.map;
            points.add(choice.uv.x, choice.uv.y, i);
        }
        add_importance_chunk(job, points, map);
    }
}

// Points of the discs around the receiver's places in the maps.
void Gatherer::add_around(const ImportanceJob& job, const CellPlace& place) const {
    const DiscPoints& disc = job.samples.disc;
    const V2f shift = disc.cell.shift(place);
    const SinCos turn = sin_cos_turns(shift.y);
    const float r = m_config.radius;
    for (size_t begin = 0; begin < disc.size(); begin += kChunk) {
        const size_t count = std::min(disc.size() - begin, kChunk);
        Batch points;
        float xi1[kChunk], x[kChunk], y[kChunk];
        uint32_t map[kChunk] = {};
        disc_points(&disc.xi1[begin], &disc.sine[begin], &disc.cosine[begin], count, shift.x, turn,
                    xi1, x, y);
        for (size_t i = 0; i < count; ++i) {
            float stretch = r;
            if (m_maps.size() > 1) {
                // One number chooses a map and, by what is left of it, the distance.
                const DiscreteSample pick = m_map_table.sample(double(xi1[i]));
                map[i] = pick.index;
                stretch = xi1[i] > 0 ? r * pick.u / xi1[i] : 0;
            }
            const V2f& centre = job.centres[map[i]];
            points.add(centre.x + stretch * x[i], centre.y + stretch * y[i],
                       job.samples.flux.size() + begin + i);
        }
        add_importance_chunk(job, points, map);
    }
}

void Gatherer::add_importance(const Receiver& receiver, const PassSamples& samples,
                              const CellPlace& place, uint32_t alpha_key, SeenSum& sum) const {
    // Find the receiver in each map; few scenes have more lights than fit on the stack.
    std::array<V2f, 16> few;
    std::vector<V2f> many(m_maps.size() > few.size() ? m_maps.size() : 0);
    const std::span<V2f> centres = many.empty() ? std::span<V2f>(few) : std::span<V2f>(many);
    for (size_t map = 0; map < m_maps.size(); ++map)
        centres[map] = place_in(m_maps[map], receiver);
    const ImportanceJob job{receiver, samples, alpha_key, centres, sum};
    add_by_flux(job, place);
    add_around(job, place);
}

} // namespace ql
