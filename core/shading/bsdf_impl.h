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
#include "shading/bsdf_lobes.h"

#include <algorithm>
#include <cmath>

namespace ql {

namespace detail {

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
