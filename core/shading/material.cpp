#include "shading/material.h"

namespace ql {

namespace {

uint32_t lobes_of_metallic_roughness(const Material& m) {
    const bool metal_everywhere = m.metallic >= 1 && !m.metallic_roughness_texture.used();
    const bool clear_everywhere = m.transmission >= 1 && !m.transmission_texture.used();
    uint32_t lobes = 0;
    if (!metal_everywhere && !clear_everywhere) lobes |= kLobeDiffuse;
    if (!metal_everywhere && m.transmission > 0) lobes |= kLobeTransmission;
    if (m.metallic > 0 || m.ior != 1) lobes |= kLobeMicrofacet;
    return lobes;
}

uint32_t lobes_of_phong(const Material& m) {
    uint32_t lobes = 0;
    if (m.kd > 0) lobes |= kLobeDiffuse;
    if (m.ks > 0) lobes |= kLobePhong;
    if (m.kr > 0 || m.kt > 0) lobes |= kLobeSpecular;
    return lobes;
}

} // namespace

uint32_t lobes_of(const Material& material) {
    switch (material.model) {
    case MaterialModel::metallic_roughness:
        return lobes_of_metallic_roughness(material);
    case MaterialModel::phong:
        return lobes_of_phong(material);
    case MaterialModel::unlit:
        break;
    }
    return 0;
}

V3f albedo_of(const Bsdf& bsdf) {
    V3f albedo = bsdf.diffuse;
    if (bsdf.lobes & kLobeMicrofacet) {
        const float coat = dielectric_fresnel(1, relative_eta(bsdf));
        albedo = bsdf.diffuse * (1 - coat) + bsdf.metal_f0 * bsdf.metallic +
                 V3f((1 - bsdf.metallic) * coat);
    }
    if (bsdf.lobes & kLobeTransmission)
        albedo += bsdf.transmission * (1 - dielectric_fresnel(1, relative_eta(bsdf)));
    if (bsdf.lobes & kLobePhong) albedo += bsdf.phong;
    if (bsdf.lobes & kLobeSpecular) albedo += bsdf.mirror + bsdf.refraction;
    return {std::clamp(albedo.x, 0.0f, 1.0f), std::clamp(albedo.y, 0.0f, 1.0f),
            std::clamp(albedo.z, 0.0f, 1.0f)};
}

} // namespace ql
