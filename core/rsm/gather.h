// Irradiance of a point by the texels of reflective shadow maps, with or without a shadow test.
//
// Nilles 2017, sections 4.1 and 5.1; Dachsbacher & Stamminger 2005. What is summed, or estimated:
//   E(x) = sum_p Phi_p / pi  max(0, n_p . d) max(0, -n . d) / |x - x_p|^2  V(x, x_p)
// with d from x_p to x. The divisor is bounded by treating the texel as a disc of its own area A
// (d^2 + A/pi), by a distance, or not at all. Units: those of ReflectiveShadowMap.
// Thread-safe; the caller owns counters and random numbers.
#pragma once

#include "rsm/flux_table.h"
#include "rsm/mip_chain.h"
#include "rsm/samples.h"
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
enum class ShadowTest { on, off };
enum class MipUse { off, on };

// The divisor of the geometry term becomes max(d^2 + radius2_scale * A/pi, least_distance2).
struct GeometryBound {
    float radius2_scale = 1;   // 1: disc; 0: none
    float least_distance2 = 0; // render lengths, squared

    float divisor(float distance2, float radius2) const {
        return std::max(distance2 + radius2_scale * radius2, least_distance2);
    }
};

struct GatherConfig {
    Gather gather = Gather::importance;
    int samples = 64;    // importance: in all; pattern: of each map
    float radius = 0.3f; // of the disc, in map widths, (0, 2]
    PatternWeights weights = PatternWeights::unbiased;
    MipUse mips = MipUse::off; // pattern
    ShadowTest shadow_test = ShadowTest::on;
    GeometryBound bound = {};
};

struct Receiver {
    V3f position = {0, 0, 0};
    V3f ng = {0, 0, 1}; // unit, geometric
    V3f ns = {0, 0, 1}; // unit, shading
    float offset = 0;
};

// Counts shadow rays, and keeps them if asked.
struct ShadowLog {
    uint64_t count = 0;
    std::vector<Ray>* rays = nullptr;
};

// A texel whose plane holds the receiver up to rounding (positions are good to about 2^-24 in
// render space) gives no light, nor does the receiver's plane.
inline constexpr float kPlaneNoise = 0x1p-22f;

// cos cos / (distance^2, bounded); 0 where either faces away.
float bounded_geometry(const Receiver& receiver, const V3f& position, const V3f& normal,
                       float radius2, const GeometryBound& bound);

// A texel in one cache line, for gathers that read here and there; `full` reads arrays.
struct alignas(64) PackedTexel {
    V3f position;
    float radius2;
    V3f normal;
    float offset;
    V3f flux;
};

class Gatherer {
  public:
    // Maps and scene must outlive it.
    Gatherer(const EmbreeScene& scene, std::span<const ReflectiveShadowMap> maps,
             const GatherConfig& config);

    // samples: of the kind that the gather takes; shift: see ShiftSource; alpha_key: of the pixel
    // and pass.
    V3f irradiance(const Receiver& receiver, const PassSamples& samples,
                   const std::array<float, 3>& shift, uint32_t alpha_key, ShadowLog& log) const;

    const GatherConfig& config() const { return m_config; }
    std::span<const ReflectiveShadowMap> maps() const { return m_maps; }
    // Maps by their flux; empty if there is none.
    const AliasTable& map_table() const { return m_map_table; }

  private:
    V3f full(const Receiver& receiver, uint32_t alpha_key, ShadowLog& log) const;
    V3f full_unshadowed(const Receiver& receiver) const;
    V3f pattern(const Receiver& receiver, const PassSamples& samples, float turn,
                uint32_t alpha_key, ShadowLog& log) const;
    V3f map_pattern(const Receiver& receiver, size_t map, const PassSamples& samples, float turn,
                    uint32_t alpha_key, ShadowLog& log) const;
    V3f importance(const Receiver& receiver, const PassSamples& samples,
                   const std::array<float, 3>& shift, uint32_t alpha_key, ShadowLog& log) const;

    // A texel to be looked at, how much it counts, and its number for alpha decisions.
    struct Candidate {
        const PackedTexel* texel;
        float weight;
        uint32_t number;
        uint32_t map; // importance: where it was found
        V2f uv;
    };
    // Those whose texels are on their way to the cache.
    struct Batch;
    void add_flux_sample(size_t i, const PassSamples& samples, const std::array<float, 3>& shift,
                         Batch& batch) const;
    void add_disc_sample(size_t i, const PassSamples& samples, const std::array<float, 3>& shift,
                         const SinCos& turn, std::span<const V2f> centres, Batch& batch) const;
    float density(size_t map, const V3f& flux, const V2f& uv, const V2f& centre,
                  const PassSamples& samples) const;
    V3f irradiance(const Receiver& receiver, const Batch& batch, uint32_t alpha_key,
                   ShadowLog& log) const;
    bool is_visible(const Receiver& receiver, const V3f& target, uint32_t alpha_key,
                    ShadowLog& log) const;

    // The texels of a map, or of one of its mip levels.
    struct Level {
        int size;
        std::vector<PackedTexel> texels;

        const PackedTexel* at(float u, float v) const;
    };

    const EmbreeScene& m_scene;
    std::span<const ReflectiveShadowMap> m_maps;
    GatherConfig m_config;
    std::vector<std::vector<Level>> m_levels; // by map; of all but Gather::full
    FluxTable m_texel_table;                  // importance
    AliasTable m_map_table;
};

} // namespace ql
