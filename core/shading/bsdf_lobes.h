// Which lobes a BSDF has where light comes from a direction, and how often each is picked.
//
// Perfectly specular lobes have a weight in colour, rough ones a share of the picks alone: their
// values are those of bsdf_impl.h. Pure functions.
#pragma once

#include "shading/bsdf.h"
#include "shading/bsdf_fresnel.h"
#include "shading/bsdf_microfacet.h"

#include <algorithm>
#include <cmath>

namespace ql {

// Index of the other side over that of the side of wo.
inline float relative_eta(const Bsdf& bsdf) {
    if (bsdf.thin_walled || bsdf.entering) return bsdf.eta;
    return bsdf.eta > 0 ? 1 / bsdf.eta : 0;
}

namespace detail {

// Directions closer to the horizon scatter nothing: keeps products of cosines away from underflow.
inline constexpr float kMinCosine = 1e-9f;
// Least probability of a rough lobe, whose Fresnel factor may be larger off the normal than at it.
inline constexpr float kMinRoughWeight = 0.05f;

inline float average(const V3f& v) {
    return (v.x + v.y + v.z) * (1.0f / 3);
}

template<uint32_t Lobes>
bool has(const Bsdf& bsdf, uint32_t lobe) {
    return (Lobes & bsdf.lobes & lobe) != 0;
}

inline bool is_smooth(const Bsdf& bsdf) {
    return bsdf.alpha <= kSmoothAlpha;
}

// Rough refraction that bends less than a smooth lobe is wide has no density.
inline bool transmits_smoothly(const Bsdf& bsdf) {
    return is_smooth(bsdf) ||
           (!bsdf.thin_walled && bsdf.alpha * std::abs(bsdf.eta - 1) <= kSmoothAlpha);
}

template<uint32_t Lobes>
bool has_rough_reflection(const Bsdf& bsdf) {
    return has<Lobes>(bsdf, kLobeMicrofacet) && !is_smooth(bsdf);
}

template<uint32_t Lobes>
bool has_rough_transmission(const Bsdf& bsdf) {
    if constexpr (!(Lobes & kLobeTransmission)) return false;
    return has<Lobes>(bsdf, kLobeTransmission) && !transmits_smoothly(bsdf);
}

// Whether reflection and transmission are told apart at a sampled half vector: if either is rough.
template<uint32_t Lobes>
bool transmits_at_half_vector(const Bsdf& bsdf) {
    if constexpr (!(Lobes & kLobeTransmission)) return false;
    return has<Lobes>(bsdf, kLobeTransmission) &&
           (has_rough_reflection<Lobes>(bsdf) || has_rough_transmission<Lobes>(bsdf));
}

template<uint32_t Lobes>
bool has_rough_phong(const Bsdf& bsdf) {
    if constexpr (!(Lobes & kLobePhong)) return false;
    return has<Lobes>(bsdf, kLobePhong) && bsdf.exponent <= kMirrorExponent;
}

inline V3f microfacet_reflectance(const Bsdf& bsdf, float cosine, float fresnel) {
    return schlick_fresnel(bsdf.metal_f0, cosine) * bsdf.metallic +
           V3f((1 - bsdf.metallic) * fresnel);
}

inline float phong_boundary_fresnel(const Bsdf& bsdf, float cosine) {
    const float eta = relative_eta(bsdf);
    return bsdf.schlick ? schlick_dielectric_fresnel(cosine, eta) : dielectric_fresnel(cosine, eta);
}

// Weights of the perfectly specular lobes for flux.
template<uint32_t Lobes>
V3f specular_reflection(const Bsdf& bsdf, float cos_o) {
    V3f weight(0);
    if constexpr ((Lobes & kLobeMicrofacet) != 0)
        if (has<Lobes>(bsdf, kLobeMicrofacet) && is_smooth(bsdf))
            weight +=
                microfacet_reflectance(bsdf, cos_o, dielectric_fresnel(cos_o, relative_eta(bsdf)));
    if constexpr ((Lobes & kLobePhong) != 0)
        if (has<Lobes>(bsdf, kLobePhong) && !has_rough_phong<Lobes>(bsdf))
            weight += bsdf.phong * cos_o;
    if constexpr ((Lobes & kLobeSpecular) != 0)
        if (has<Lobes>(bsdf, kLobeSpecular)) {
            const bool split = bsdf.eta > 0 && bsdf.refraction != V3f(0);
            weight += split ? (bsdf.mirror + bsdf.refraction) * phong_boundary_fresnel(bsdf, cos_o)
                            : bsdf.mirror;
        }
    return weight;
}

template<uint32_t Lobes>
V3f specular_transmission(const Bsdf& bsdf, float cos_o) {
    V3f weight(0);
    if constexpr ((Lobes & kLobeTransmission) != 0)
        if (has<Lobes>(bsdf, kLobeTransmission) && !transmits_at_half_vector<Lobes>(bsdf))
            weight += bsdf.transmission * (1 - dielectric_fresnel(cos_o, relative_eta(bsdf)));
    if constexpr ((Lobes & kLobeSpecular) != 0)
        if (has<Lobes>(bsdf, kLobeSpecular) && bsdf.refraction != V3f(0)) {
            weight += bsdf.eta > 0 ? (bsdf.mirror + bsdf.refraction) *
                                         (1 - phong_boundary_fresnel(bsdf, cos_o))
                                   : bsdf.refraction;
        }
    return weight;
}

// How often each lobe is picked, before division by the sum.
struct LobeWeights {
    float diffuse = 0;
    float microfacet = 0; // rough reflection and rough transmission, told apart at the half vector
    float phong = 0;
    V3f reflection = {0, 0, 0}; // perfectly specular: their weights in colour
    V3f transmission = {0, 0, 0};

    float sum() const {
        return diffuse + microfacet + phong + average(reflection) + average(transmission);
    }
};

template<uint32_t Lobes>
LobeWeights lobe_weights(const Bsdf& bsdf, float cos_o) {
    LobeWeights w;
    if (has<Lobes>(bsdf, kLobeDiffuse)) w.diffuse = average(bsdf.diffuse);
    if constexpr ((Lobes & (kLobeMicrofacet | kLobeTransmission)) != 0) {
        if (bsdf.lobes & (kLobeMicrofacet | kLobeTransmission)) {
            const float fresnel = dielectric_fresnel(cos_o, relative_eta(bsdf));
            const bool reflects = has_rough_reflection<Lobes>(bsdf);
            const bool transmits = transmits_at_half_vector<Lobes>(bsdf);
            if (reflects) w.microfacet += average(microfacet_reflectance(bsdf, cos_o, fresnel));
            if (transmits) w.microfacet += average(bsdf.transmission) * (1 - fresnel);
            if (reflects || transmits) w.microfacet = std::max(w.microfacet, kMinRoughWeight);
            if (bsdf.lobes & kLobeMicrofacet) w.diffuse *= 1 - fresnel;
        }
    }
    if constexpr ((Lobes & kLobePhong) != 0)
        if (has_rough_phong<Lobes>(bsdf)) w.phong = average(bsdf.phong);
    if constexpr ((Lobes & ~kLobeDiffuse) != 0)
        w.reflection = specular_reflection<Lobes>(bsdf, cos_o);
    if constexpr ((Lobes & (kLobeTransmission | kLobeSpecular)) != 0)
        w.transmission = specular_transmission<Lobes>(bsdf, cos_o);
    return w;
}

} // namespace detail

} // namespace ql
