// Irradiance of a point by the texels of reflective shadow maps, with or without a shadow test.
//
// Nilles 2017, sections 4.1 and 5.1; Dachsbacher & Stamminger 2005. What is summed, or estimated:
//   E(x) = sum_p Phi_p / pi  max(0, n_p . d) max(0, -n . d) / |x - x_p|^2  V(x, x_p)
// with d from x_p to x and the divisor bounded, see GeometryBound. Units: those of
// ReflectiveShadowMap. Thread-safe; the caller owns counters and random numbers.
#pragma once

#include "rsm/flux_table.h"
#include "rsm/samples.h"
#include "rsm/seen_sum.h"
#include "rsm/texel_level.h"
#include "sampling/discrete.h"

#include <span>

namespace ql {

enum class Gather {
    pattern,   // a disc about the projected point in each map, density 1/distance
    full,      // every texel: exact for these maps
    importance // texels by flux, and the disc, joined by the balance heuristic; unbiased
};
// thesis: weight xi1^2 and division by the sum of the weights. Not an estimate of E.
enum class PatternWeights { unbiased, thesis };
enum class MipUse { off, on };

struct GatherConfig {
    Gather gather = Gather::importance;
    int samples = 64;    // importance: in all; pattern: of each map
    float radius = 0.3f; // of the disc, in map widths, (0, 2]
    PatternWeights weights = PatternWeights::unbiased;
    MipUse mips = MipUse::off; // pattern
    ShadowTest shadow_test = ShadowTest::on;
    GeometryBound bound = {};
};

// The alpha key of the ray to a texel, from that of the pixel and the texel's or sample's number.
inline uint32_t alpha_key_of(uint32_t pixel_key, size_t number) {
    return pixel_key ^ (uint32_t(number) * 0x9e3779b9u);
}

class Gatherer {
  public:
    // Maps and scene must outlive it.
    Gatherer(const EmbreeScene& scene, std::span<const ReflectiveShadowMap> maps,
             const GatherConfig& config);

    // samples: of the kind that the gather takes; place: see ShiftSource; alpha_key: of the pixel
    // and pass.
    V3f irradiance(const Receiver& receiver, const PassSamples& samples, const CellPlace& place,
                   uint32_t alpha_key, ShadowLog& log) const;

    const GatherConfig& config() const { return m_config; }
    std::span<const ReflectiveShadowMap> maps() const { return m_maps; }
    // Maps by their flux; empty if there is none.
    const AliasTable& map_table() const { return m_map_table; }

  private:
    struct Batch;
    struct PatternWeight;
    struct ImportanceJob;
    struct ImportanceWeight;

    void add_full(const Receiver& receiver, uint32_t alpha_key, SeenSum& sum) const;
    void add_pattern(const Receiver& receiver, size_t map, const DiscPoints& disc,
                     const CellPlace& place, uint32_t alpha_key, SeenSum& sum) const;
    void add_importance(const Receiver& receiver, const PassSamples& samples,
                        const CellPlace& place, uint32_t alpha_key, SeenSum& sum) const;
    void add_by_flux(const ImportanceJob& job, const CellPlace& place) const;
    void add_around(const ImportanceJob& job, const CellPlace& place) const;
    void add_importance_chunk(const ImportanceJob& job, const Batch& points,
                              const uint32_t* map) const;
    template<class Weight>
    void add_batch(const Receiver& receiver, const TexelLevel& level, const Batch& batch,
                   uint32_t alpha_key, const Weight& weight, SeenSum& sum) const;

    const EmbreeScene& m_scene;
    std::span<const ReflectiveShadowMap> m_maps;
    GatherConfig m_config;
    std::vector<std::vector<TexelLevel>> m_levels; // by map; of all but Gather::full
    FluxTable m_texel_table;                       // importance
    AliasTable m_map_table;
};

} // namespace ql
