// Bodies of the inline functions of material.h.
#pragma once

#include "shading/material.h"

namespace ql {

namespace detail {

inline V3f rgb(const V4f& v) {
    return {v.x, v.y, v.z};
}

inline V4f base_color_at(std::span<const Texture> textures, const Material& m,
                         const SurfaceInput& in) {
    V4f color = in.color;
    color.x *= m.base_color.x;
    color.y *= m.base_color.y;
    color.z *= m.base_color.z;
    color.w *= m.alpha;
    if (m.base_color_texture.used())
        color = color * texture_or_white(textures, m.base_color_texture, in.uv);
    return color;
}

inline void set_metallic_roughness(Bsdf& bsdf, std::span<const Texture> textures, const Material& m,
                                   const SurfaceInput& in, const V3f& base) {
    float metallic = m.metallic;
    float roughness = m.roughness;
    float transmission = m.transmission;
    if (m.metallic_roughness_texture.used()) {
        const V4f texel = texture_or_white(textures, m.metallic_roughness_texture, in.uv);
        roughness *= texel.y;
        metallic *= texel.z;
    }
    if (m.transmission_texture.used())
        transmission *= texture_or_white(textures, m.transmission_texture, in.uv).x;
    bsdf.metallic = metallic;
    bsdf.metal_f0 = base;
    bsdf.alpha = roughness * roughness;
    bsdf.eta = m.ior;
    bsdf.thin_walled = m.thin_walled || transmission <= 0;
    const float dielectric = 1 - metallic;
    bsdf.diffuse = base * (dielectric * (1 - transmission));
    bsdf.transmission = base * (dielectric * transmission);

    // Name only the lobes that this point has.
    bsdf.lobes = 0;
    if (dielectric * (1 - transmission) > 0) bsdf.lobes |= kLobeDiffuse;
    if (dielectric * transmission > 0) bsdf.lobes |= kLobeTransmission;
    if (metallic > 0 || m.ior != 1) bsdf.lobes |= kLobeMicrofacet;
}

inline void set_phong(Bsdf& bsdf, const Material& m, const V3f& base) {
    bsdf.lobes = 0;
    bsdf.diffuse = base * m.kd;
    bsdf.phong = m.specular_color * m.ks;
    bsdf.exponent = m.exponent;
    bsdf.mirror = V3f(m.kr);
    bsdf.refraction = V3f(m.kt);
    bsdf.eta = m.ior;
    bsdf.thin_walled = false;
    bsdf.schlick = m.fresnel == FresnelModel::schlick;
    if (m.kd > 0) bsdf.lobes |= kLobeDiffuse;
    if (m.ks > 0) bsdf.lobes |= kLobePhong;
    if (m.kr > 0 || m.kt > 0) bsdf.lobes |= kLobeSpecular;
}

} // namespace detail

inline void prefetch_textures(std::span<const Texture> textures, const Material& material,
                              const SurfaceInput& input) {
    prefetch_texture(textures, material.base_color_texture, input.uv);
    prefetch_texture(textures, material.metallic_roughness_texture, input.uv);
    prefetch_texture(textures, material.normal_texture, input.uv);
}

inline Bsdf bsdf_at(std::span<const Texture> textures, const Material& material,
                    const SurfaceInput& input) {
    Bsdf bsdf;
    bsdf.entering = input.front;
    bsdf.lobes = 0;
    if (material.model == MaterialModel::unlit) return bsdf;
    const V3f base = detail::rgb(detail::base_color_at(textures, material, input));
    if (material.model == MaterialModel::phong)
        detail::set_phong(bsdf, material, base);
    else
        detail::set_metallic_roughness(bsdf, textures, material, input, base);
    return bsdf;
}

inline V3f emission_at(std::span<const Texture> textures, const Material& material,
                       const SurfaceInput& input) {
    if (!input.front && !material.double_sided) return V3f(0);
    if (material.model == MaterialModel::unlit)
        return detail::rgb(detail::base_color_at(textures, material, input));
    V3f emission = material.emission;
    if (material.emission_texture.used() && emission != V3f(0))
        emission *= detail::rgb(texture_or_white(textures, material.emission_texture, input.uv));
    return emission;
}

inline float alpha_at(std::span<const Texture> textures, const Material& material,
                      const SurfaceInput& input) {
    if (material.alpha_mode == AlphaMode::opaque) return 1;
    const float alpha = detail::base_color_at(textures, material, input).w;
    if (material.alpha_mode == AlphaMode::mask) return alpha >= material.alpha_cutoff ? 1.0f : 0.0f;
    return std::clamp(alpha, 0.0f, 1.0f);
}

inline V3f albedo_at(std::span<const Texture> textures, const Material& material,
                     const SurfaceInput& input) {
    return albedo_of(bsdf_at(textures, material, input));
}

inline V3f shading_normal(std::span<const Texture> textures, const Material& material,
                          const SurfaceInput& input, const V3f& normal, const V4f& tangent) {
    if (!material.normal_texture.used()) return normal;

    // Make the tangent orthogonal to the normal.
    V3f t = detail::rgb(tangent);
    t -= normal * normal.dot(t);
    const float t_length = t.length();
    if (!(t_length > 1e-6f)) return normal;
    t /= t_length;
    const V3f b = normal.cross(t) * (tangent.w < 0 ? -1.0f : 1.0f);

    // Decode the texel to a vector in [-1, 1]^3; glTF scales x and y.
    const V4f texel = texture_or_white(textures, material.normal_texture, input.uv);
    const float x = (2 * texel.x - 1) * material.normal_scale;
    const float y = (2 * texel.y - 1) * material.normal_scale;
    const float z = 2 * texel.z - 1;
    const V3f turned = t * x + b * y + normal * z;
    const float length = turned.length();
    return length > 1e-6f && std::isfinite(length) ? turned / length : normal;
}

} // namespace ql
