// Bodies of the templates of bsdf.h.
//
// A sample picks one lobe with a probability that follows from bsdf and wo alone; its density is
// that of all non-specular lobes together (the one-sample model with balance heuristic of Veach
// 1997, section 9.2.4), so its weight is value / pdf whichever lobe it came from.
// Metallic-roughness follows glTF 2.0, appendix B, but for the share of the diffuse light under the
// coat: there 1 - F(wo.h), with which a smooth coat at grazing angles reflects almost twice what it
// receives; here 1 - max(F(wo.n), F(wi.n)), as reciprocal and never above 1.
#pragma once

#include "sampling/warp.h"
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

// At a half vector: what is reflected, what passes, and how often reflection is picked.
struct BoundaryShares {
    V3f reflected;
    V3f transmitted;
    float reflection_probability;
};

template<uint32_t Lobes>
BoundaryShares boundary_shares(const Bsdf& bsdf, float cos_oh) {
    const float fresnel = dielectric_fresnel(cos_oh, relative_eta(bsdf));
    BoundaryShares s{V3f(0), V3f(0), 1};
    if (has_rough_reflection<Lobes>(bsdf))
        s.reflected = microfacet_reflectance(bsdf, cos_oh, fresnel);
    if (transmits_at_half_vector<Lobes>(bsdf)) {
        s.transmitted = bsdf.transmission * (1 - fresnel);
        const float r = average(s.reflected);
        const float t = average(s.transmitted);
        if (t > 0) s.reflection_probability = r / (r + t);
    }
    return s;
}

template<uint32_t Lobes>
BsdfValue microfacet_reflection(const Bsdf& bsdf, const V3f& wo, const V3f& wi) {
    const V3f h = (wo + wi).normalized();
    const BoundaryShares shares = boundary_shares<Lobes>(bsdf, wo.dot(h));
    const float d = ggx_distribution(h, bsdf.alpha);
    return {shares.reflected * (d * ggx_geometry(wo.z, wi.z, bsdf.alpha)),
            shares.reflection_probability * d * ggx_masking(wo.z, bsdf.alpha)};
}

// Through a thin wall: the reflection lobe on the other side.
template<uint32_t Lobes>
BsdfValue thin_transmission(const Bsdf& bsdf, const V3f& wo, const V3f& wi) {
    const V3f h = V3f(wo.x + wi.x, wo.y + wi.y, wo.z - wi.z).normalized();
    const BoundaryShares shares = boundary_shares<Lobes>(bsdf, wo.dot(h));
    const float d = ggx_distribution(h, bsdf.alpha);
    return {shares.transmitted * (d * ggx_geometry(wo.z, -wi.z, bsdf.alpha)),
            (1 - shares.reflection_probability) * d * ggx_masking(wo.z, bsdf.alpha)};
}

// Walter et al. 2007, eq. 16, 17 and 21.
template<uint32_t Lobes, TransportMode Mode>
BsdfValue solid_transmission(const Bsdf& bsdf, const V3f& wo, const V3f& wi) {
    const float eta = relative_eta(bsdf);
    V3f h = wo + wi * eta;
    const float length2 = h.length2();
    if (length2 <= 0) return {};
    h *= (h.z < 0 ? -1 : 1) / std::sqrt(length2);
    const float cos_oh = wo.dot(h);
    const float cos_ih = wi.dot(h);
    if (cos_oh <= 0 || cos_ih >= 0) return {};
    const BoundaryShares shares = boundary_shares<Lobes>(bsdf, cos_oh);
    const float common = 4 * ggx_distribution(h, bsdf.alpha) * cos_oh * -cos_ih / length2;
    const float mode_scale = Mode == TransportMode::importance ? eta * eta : 1;
    return {shares.transmitted * (common * ggx_geometry(wo.z, -wi.z, bsdf.alpha) * mode_scale),
            (1 - shares.reflection_probability) * common * eta * eta *
                ggx_masking(wo.z, bsdf.alpha)};
}

inline void add(BsdfValue& sum, const BsdfValue& lobe, float probability) {
    sum.value += lobe.value;
    sum.pdf_solid_angle += lobe.pdf_solid_angle * probability;
}

template<uint32_t Lobes>
BsdfValue diffuse_reflection(const Bsdf& bsdf, const V3f& wo, const V3f& wi) {
    const float pdf = wi.z * kInvPi;
    float share = pdf;
    if constexpr ((Lobes & kLobeMicrofacet) != 0)
        if (bsdf.lobes & kLobeMicrofacet) {
            const float eta = relative_eta(bsdf);
            share *= 1 - std::max(dielectric_fresnel(wo.z, eta), dielectric_fresnel(wi.z, eta));
        }
    return {bsdf.diffuse * share, pdf};
}

inline BsdfValue phong_reflection(const Bsdf& bsdf, const V3f& wo, const V3f& wi) {
    const float n = bsdf.exponent;
    const float lobe = cosine_power(wi, {-wo.x, -wo.y, wo.z}, n) * (kInvPi / 2);
    return {bsdf.phong * ((n + 2) * lobe * wi.z), (n + 1) * lobe};
}

// All non-specular lobes.
template<uint32_t Lobes, TransportMode Mode>
BsdfValue value_and_pdf(const Bsdf& bsdf, const V3f& wo, const V3f& wi, const LobeWeights& weights,
                        float inverse_sum) {
    BsdfValue result;
    if (wi.z > kMinCosine) {
        if (weights.diffuse > 0)
            add(result, diffuse_reflection<Lobes>(bsdf, wo, wi), weights.diffuse * inverse_sum);
        if constexpr ((Lobes & kLobeMicrofacet) != 0)
            if (has_rough_reflection<Lobes>(bsdf))
                add(result, microfacet_reflection<Lobes>(bsdf, wo, wi),
                    weights.microfacet * inverse_sum);
        if constexpr ((Lobes & kLobePhong) != 0)
            if (weights.phong > 0)
                add(result, phong_reflection(bsdf, wo, wi), weights.phong * inverse_sum);
    } else if (wi.z < -kMinCosine) {
        if constexpr ((Lobes & kLobeTransmission) != 0)
            if (has_rough_transmission<Lobes>(bsdf))
                add(result,
                    bsdf.thin_walled ? thin_transmission<Lobes>(bsdf, wo, wi)
                                     : solid_transmission<Lobes, Mode>(bsdf, wo, wi),
                    weights.microfacet * inverse_sum);
    }
    return result;
}

// A direction of the rough microfacet lobes, zero where it is lost on the wrong side of the
// surface; u_side tells reflection from transmission.
struct MicrofacetDirection {
    V3f wi;
    V3f specular_weight = {0, 0, 0}; // not zero: transmission without a density
};

template<uint32_t Lobes>
MicrofacetDirection sample_microfacet(const Bsdf& bsdf, const V3f& wo, float u_side, const V2f& u) {
    const V3f h = sample_visible_normal(wo, bsdf.alpha, u);
    const V3f mirrored = reflected(wo, h);
    const MicrofacetDirection lost{V3f(0)};
    if constexpr ((Lobes & kLobeTransmission) != 0) {
        if (transmits_at_half_vector<Lobes>(bsdf)) {
            const BoundaryShares shares = boundary_shares<Lobes>(bsdf, wo.dot(h));
            if (u_side >= shares.reflection_probability) {
                if (bsdf.thin_walled)
                    return mirrored.z > 0
                               ? MicrofacetDirection{V3f(mirrored.x, mirrored.y, -mirrored.z)}
                               : lost;
                const V3f wi = refracted(wo, h, relative_eta(bsdf));
                if (!transmits_smoothly(bsdf)) return wi.z < 0 ? MicrofacetDirection{wi} : lost;
                return {wi.z < 0 ? wi : -wo,
                        shares.transmitted / (1 - shares.reflection_probability)};
            }
        }
    }
    return mirrored.z > 0 ? MicrofacetDirection{mirrored} : lost;
}

inline V3f sample_phong(const Bsdf& bsdf, const V3f& wo, const V2f& u) {
    const V3f wi = frame_from_normal({-wo.x, -wo.y, wo.z})
                       .world_from_local(square_to_cosine_power(u, bsdf.exponent));
    return wi.z > 0 ? wi : V3f(0);
}

// Through the smooth boundary. Weight in flux; radiance changes by the square of the index.
template<TransportMode Mode>
BsdfSample specular_transmission_sample(const Bsdf& bsdf, const V3f& wi, const V3f& weight) {
    const float eta = relative_eta(bsdf);
    const bool bends = !bsdf.thin_walled && eta > 0;
    const bool scales = bends && Mode == TransportMode::radiance;
    return {wi, scales ? weight / (eta * eta) : weight, 0, true, true};
}

inline V3f specular_transmission_direction(const Bsdf& bsdf, const V3f& wo) {
    const float eta = relative_eta(bsdf);
    if (bsdf.thin_walled || eta <= 0 || eta == 1) return -wo;
    return refracted(wo, {0, 0, 1}, eta);
}

// Lambert surfaces alone, the most common of all.
inline BsdfValue lambert_value(const Bsdf& bsdf, const V3f& wo, const V3f& wi) {
    const float pdf = wo.z > 0 ? std::max(0.0f, wi.z) * kInvPi : 0;
    return {bsdf.diffuse * pdf, pdf};
}

inline std::optional<BsdfSample> lambert_sample(const Bsdf& bsdf, const V3f& wo, const V2f& u) {
    const V3f wi = square_to_cosine_hemisphere(u);
    if (!(wi.z > 0 && wo.z > 0)) return std::nullopt;
    return BsdfSample{wi, bsdf.diffuse, wi.z * kInvPi, false, false};
}

} // namespace detail

template<uint32_t Lobes, TransportMode Mode>
BsdfValue value_and_pdf_bsdf(const Bsdf& bsdf, const V3f& wo, const V3f& wi) {
    if constexpr (Lobes == kLobeDiffuse) {
        return detail::lambert_value(bsdf, wo, wi);
    } else {
        if (bsdf.lobes == kLobeDiffuse) return detail::lambert_value(bsdf, wo, wi);
        if (!(wo.z > detail::kMinCosine)) return {};
        const detail::LobeWeights weights = detail::lobe_weights<Lobes>(bsdf, wo.z);
        const float sum = weights.sum();
        if (!(sum > 0)) return {};
        return detail::value_and_pdf<Lobes, Mode>(bsdf, wo, wi, weights, 1 / sum);
    }
}

template<uint32_t Lobes, TransportMode Mode>
V3f eval_bsdf(const Bsdf& bsdf, const V3f& wo, const V3f& wi) {
    return value_and_pdf_bsdf<Lobes, Mode>(bsdf, wo, wi).value;
}

template<uint32_t Lobes>
float pdf_bsdf(const Bsdf& bsdf, const V3f& wo, const V3f& wi) {
    return value_and_pdf_bsdf<Lobes>(bsdf, wo, wi).pdf_solid_angle;
}

template<uint32_t Lobes, TransportMode Mode>
std::optional<BsdfSample> sample_bsdf(const Bsdf& bsdf, const V3f& wo, float u_lobe, V2f u) {
    if constexpr (Lobes == kLobeDiffuse) {
        return detail::lambert_sample(bsdf, wo, u);
    } else {
        if (bsdf.lobes == kLobeDiffuse) return detail::lambert_sample(bsdf, wo, u);
        if (!(wo.z > detail::kMinCosine)) return std::nullopt;
        const detail::LobeWeights weights = detail::lobe_weights<Lobes>(bsdf, wo.z);
        const float sum = weights.sum();
        if (!(sum > 0)) return std::nullopt;

        // Go through the lobes until u_lobe is used up; rounding must not pick a lobe of weight 0.
        float rest = u_lobe * sum;
        V3f wi;
        if (rest < weights.diffuse) {
            wi = square_to_cosine_hemisphere(u);
        } else if ((rest -= weights.diffuse) < weights.microfacet) {
            const detail::MicrofacetDirection direction =
                detail::sample_microfacet<Lobes>(bsdf, wo, rest / weights.microfacet, u);
            wi = direction.wi;
            if (direction.specular_weight != V3f(0))
                return detail::specular_transmission_sample<Mode>(
                    bsdf, wi, direction.specular_weight * (sum / weights.microfacet));
        } else if ((rest -= weights.microfacet) < weights.phong) {
            wi = detail::sample_phong(bsdf, wo, u);
        } else {
            rest -= weights.phong;
            const float reflection = detail::average(weights.reflection);
            const float transmission = detail::average(weights.transmission);
            if (reflection > 0 && (rest < reflection || transmission <= 0))
                return BsdfSample{
                    {-wo.x, -wo.y, wo.z}, weights.reflection * (sum / reflection), 0, true, false};
            if (transmission <= 0) return std::nullopt;
            return detail::specular_transmission_sample<Mode>(
                bsdf, detail::specular_transmission_direction(bsdf, wo),
                weights.transmission * (sum / transmission));
        }

        // Weigh the direction by all non-specular lobes.
        const BsdfValue value = detail::value_and_pdf<Lobes, Mode>(bsdf, wo, wi, weights, 1 / sum);
        if (!(value.pdf_solid_angle > 0)) return std::nullopt;
        return BsdfSample{wi, value.value / value.pdf_solid_angle, value.pdf_solid_angle, false,
                          wi.z < 0};
    }
}

} // namespace ql
