// Scattering at a surface point: which lobes there are, sampling, evaluation and density.
//
// Directions are unit vectors in the local shading frame, z along the shading normal on the side of
// wo, and point away from the surface: wo towards the viewer, wi towards the light. Values are
// f(wo, wi) |cos theta_i| in 1/sr; densities are with respect to solid angle. Perfectly specular
// lobes have no value and no density; only sampling finds them.
#pragma once

#include <Imath/ImathVec.h>

#include <cstdint>
#include <optional>

namespace ql {

using Imath::V2f;
using Imath::V3f;

// Lobes a surface may have. A kernel is compiled for the set that its scene needs.
enum Lobe : uint32_t {
    kLobeDiffuse = 1 << 0,      // Lambert
    kLobeMicrofacet = 1 << 1,   // GGX reflection: metal and dielectric coat of metallic-roughness
    kLobeTransmission = 1 << 2, // GGX or smooth transmission of metallic-roughness, thin or solid
    kLobePhong = 1 << 3,        // normalised cosine power lobe about the mirror direction
    kLobeSpecular = 1 << 4,     // perfect mirror and perfect refraction of the Phong model
    kAllLobes = (1 << 5) - 1,
};

// Everything a surface point needs to scatter light, textures already looked up.
struct Bsdf {
    uint32_t lobes = kLobeDiffuse;
    V3f diffuse = {0, 0, 0}; // albedo of the Lambert lobe (before the Fresnel share of a coat)
    // Microfacet: F0 and tint of the metallic part, weight of the dielectric part.
    V3f metal_f0 = {0, 0, 0}; // base colour of the metallic part
    float metallic = 0;       // share of the metallic part
    float alpha = 1;          // GGX width; at or below kSmoothAlpha the lobe is a perfect mirror
    // Index of refraction of the inside over that of the outside. 0: everything is reflected
    // (metallic-roughness), or kr and kt are as given and light passes straight (Phong).
    float eta = 1.5f;
    bool entering = true; // wo is on the outer side; of interest to solid refraction only
    bool thin_walled = true;
    V3f transmission = {0, 0, 0}; // tint times share of the transmitted light
    // Phong.
    V3f phong = {0, 0, 0}; // ks times specular colour
    float exponent = 1;
    V3f mirror = {0, 0, 0};     // kr; with refraction, kr + kt is split by Fresnel
    V3f refraction = {0, 0, 0}; // kt
    bool schlick = false;
};

inline constexpr float kSmoothAlpha = 1e-4f;
// Above it the cosine power lobe is sampled in its limit: the mirror direction, weight cos(theta).
inline constexpr float kMirrorExponent = 1e6f;

// What is carried along the path. Refraction into a medium of n times the index changes radiance by
// n^2, but not flux: paths from the camera carry radiance (a weight of 1/n^2), photons carry flux.
// Veach 1997, section 5.2.
enum class TransportMode { radiance, importance };

struct BsdfSample {
    V3f wi;
    V3f weight;            // f |cos| / pdf, or the weight of the specular lobe
    float pdf_solid_angle; // of all non-specular lobes together; 0 for a specular one
    bool specular;
    bool transmitted; // wi is on the other side of the surface
};

// u_lobe picks the lobe, u the direction; all in [0, 1). No sample: the path ends here.
// Lobes names the only lobes that can occur, so that the others cost nothing.
template<uint32_t Lobes, TransportMode Mode = TransportMode::radiance>
std::optional<BsdfSample> sample_bsdf(const Bsdf& bsdf, const V3f& wo, float u_lobe, V2f u);

// Both at once, for multiple importance sampling.
struct BsdfValue {
    V3f value = {0, 0, 0}; // f |cos|
    float pdf_solid_angle = 0;
};
template<uint32_t Lobes, TransportMode Mode = TransportMode::radiance>
BsdfValue value_and_pdf_bsdf(const Bsdf& bsdf, const V3f& wo, const V3f& wi);

template<uint32_t Lobes, TransportMode Mode = TransportMode::radiance>
V3f eval_bsdf(const Bsdf& bsdf, const V3f& wo, const V3f& wi);
template<uint32_t Lobes>
float pdf_bsdf(const Bsdf& bsdf, const V3f& wo, const V3f& wi);

} // namespace ql

#include "shading/bsdf_impl.h"
