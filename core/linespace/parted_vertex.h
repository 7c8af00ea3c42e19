// A vertex of a camera path whose lobes are parted: into those that read the cache and those that
// are traced on.
//
// Diffuse lobes read, and glossy ones where GlossyLimits say so (Nilles 2017, section 4.2.3);
// mirrors, glass and metals never do. Pure functions.
#pragma once

#include "linespace/vertex.h"

namespace ql {

struct GlossyLimits {
    float low = 0;  // Phong exponents below read the cache ...
    float high = 0; // ... at or above are traced on, in between by chance
};

struct PartedVertex {
    PathVertex at;
    Bsdf read, traced;
    float p_trace; // probability of following the lobes that are traced on; 1: no others
    bool reads() const { return p_trace < 1; }
};

// reads: whether anything may read there at all; u_glossy in [0, 1).
template<uint32_t Lobes>
PartedVertex parted(const PathVertex& vertex, bool reads, const GlossyLimits& glossy,
                    float u_glossy) {
    PartedVertex v{vertex, vertex.bsdf, vertex.bsdf, reads ? 0.0f : 1.0f};
    if (!reads || Lobes == kLobeDiffuse) return v;
    const float n = vertex.bsdf.exponent;
    const bool glossy_reads =
        n < glossy.low ||
        (n < glossy.high && u_glossy >= (n - glossy.low) / (glossy.high - glossy.low));
    v.traced.diffuse = V3f(0);
    v.read.mirror = v.read.refraction = V3f(0);
    (glossy_reads ? v.traced : v.read).phong = V3f(0);
    if (!(vertex.wo_local.z > detail::kMinCosine)) return v;
    const detail::LobeWeights weights = detail::lobe_weights<Lobes>(vertex.bsdf, vertex.wo_local.z);
    const float reading = weights.diffuse + (glossy_reads ? weights.phong : 0);
    const float sum = weights.sum();
    v.p_trace = sum > 0 ? 1 - reading / sum : 1;
    // Lobes that are all read leave nothing to chance.
    if (v.p_trace < 1e-4f) v.p_trace = 0;
    return v;
}

// Of the lobes that read. Under a coat the diffuse lobe alone does; elsewhere Phong lobes may.
template<uint32_t Lobes>
BsdfValue read_value(const PartedVertex& v, const V3f& wi) {
    if constexpr (Lobes != kLobeDiffuse)
        if (v.read.lobes & kLobeMicrofacet) {
            if (!(wi.z > detail::kMinCosine) || !(v.at.wo_local.z > detail::kMinCosine)) return {};
            return detail::diffuse_reflection<Lobes>(v.read, v.at.wo_local, wi);
        }
    return value_and_pdf_bsdf<Lobes & ~uint32_t(kLobeTransmission)>(v.read, v.at.wo_local, wi);
}

template<uint32_t Lobes>
std::optional<BsdfSample> read_sample(const PartedVertex& v, V2f u, float u_lobe) {
    if constexpr (Lobes != kLobeDiffuse)
        if (v.read.lobes & kLobeMicrofacet) {
            const V3f wi = square_to_cosine_hemisphere(u);
            const BsdfValue value = read_value<Lobes>(v, wi);
            if (!(value.pdf_solid_angle > 0)) return std::nullopt;
            return BsdfSample{wi, value.value / value.pdf_solid_angle, value.pdf_solid_angle, false,
                              false};
        }
    return sample_bsdf<Lobes & ~uint32_t(kLobeTransmission)>(v.read, v.at.wo_local, u_lobe, u);
}

} // namespace ql
