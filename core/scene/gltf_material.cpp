#include "scene/gltf_material.h"

#include "scene/gltf_specular_glossiness.h"
#include "scene/gltf_texture.h"
#include "scene/gltf_value.h"

#include <tiny_gltf.h>

#include <cmath>
#include <limits>

namespace ql {

namespace {

constexpr double kNoLimit = std::numeric_limits<float>::max();
constexpr double kMaxRadiance = 1e38; // nits

V3f color_factor(GltfImport& in, const std::vector<double>& values, const std::string& what,
                 Range range) {
    V3f color;
    for (int c = 0; c < 3; ++c)
        color[c] = float(clamped(in, values[size_t(c)], range, what));
    return color;
}

// --- What every material has --------------------------------------------------------------------

void read_alpha(GltfImport& in, const tinygltf::Material& source, const std::string& where,
                Material& material) {
    if (source.alphaMode == "MASK")
        material.alpha_mode = AlphaMode::mask;
    else if (source.alphaMode == "BLEND")
        material.alpha_mode = AlphaMode::blend;
    else if (source.alphaMode != "OPAQUE")
        throw in.error("{}: alphaMode {}, expected OPAQUE, MASK or BLEND", where, source.alphaMode);
    material.alpha_cutoff =
        float(clamped(in, source.alphaCutoff, {0, kNoLimit}, where + " alphaCutoff"));
}

void read_base_color(GltfImport& in, const tinygltf::PbrMetallicRoughness& pbr,
                     const std::string& where, Material& material) {
    const std::string what = where + " baseColorFactor";
    if (pbr.baseColorFactor.size() != 4)
        throw in.error("{} has {} components, expected 4", what, pbr.baseColorFactor.size());
    material.base_color = color_factor(in, pbr.baseColorFactor, what, {0, 1});
    material.alpha = float(clamped(in, pbr.baseColorFactor[3], {0, 1}, what));
    material.base_color_texture =
        texture_use(in, pbr.baseColorTexture, Transfer::srgb, where + " baseColorTexture");
}

void read_emission(GltfImport& in, const tinygltf::Material& source, const std::string& where,
                   Material& material) {
    if (source.emissiveFactor.empty()) return;
    const std::string what = where + " emissiveFactor";
    if (source.emissiveFactor.size() != 3)
        throw in.error("{} has {} components, expected 3", what, source.emissiveFactor.size());
    double strength = 1;
    if (const auto found =
            extension(in, source.extensions, "KHR_materials_emissive_strength", where))
        strength = found->number_in("emissiveStrength", 1, {0, kNoLimit});
    // Factors above 1 are against the letter of glTF, but mean what they say.
    const V3f factor = color_factor(in, source.emissiveFactor, what, {0, kNoLimit});
    if (std::max({factor.x, factor.y, factor.z}) > 1)
        in.warn("{} is above 1; taken as it is", what);
    for (int c = 0; c < 3; ++c)
        material.emission[c] = float(
            clamped(in, double(factor[c]) * strength, {0, kMaxRadiance}, where + " emission"));
    if (material.emission != V3f(0))
        material.emission_texture =
            texture_use(in, source.emissiveTexture, Transfer::srgb, where + " emissiveTexture");
}

void read_normal_map(GltfImport& in, const tinygltf::Material& source, const std::string& where,
                     Material& material) {
    material.normal_scale = float(source.normalTexture.scale);
    if (source.normalTexture.scale != 0)
        material.normal_texture =
            texture_use(in, source.normalTexture, Transfer::linear, where + " normalTexture");
}

float read_ior(GltfImport& in, const tinygltf::Material& source, const std::string& where) {
    const auto found = extension(in, source.extensions, "KHR_materials_ior", where);
    return found ? float(found->number_in("ior", 1.5, {1, kNoLimit})) : 1.5f;
}

// --- The models ---------------------------------------------------------------------------------

void read_transmission(GltfImport& in, const tinygltf::Material& source, const std::string& where,
                       Material& material) {
    if (const auto found = extension(in, source.extensions, "KHR_materials_transmission", where)) {
        material.transmission = float(found->number_in("transmissionFactor", 0, {0, 1}));
        if (material.transmission > 0)
            material.transmission_texture =
                texture_use(in, found->object("transmissionTexture"), Transfer::linear);
    }
    if (const auto found = extension(in, source.extensions, "KHR_materials_volume", where)) {
        material.thin_walled = !(found->number("thicknessFactor", 0) > 0);
        if (!material.thin_walled && found->has("attenuationDistance"))
            in.warn("{}: attenuation is ignored", found->where());
    }
}

void read_metallic_roughness(GltfImport& in, const tinygltf::PbrMetallicRoughness& pbr,
                             const std::string& where, Material& material) {
    material.model = MaterialModel::metallic_roughness;
    material.metallic = float(clamped(in, pbr.metallicFactor, {0, 1}, where + " metallicFactor"));
    material.roughness =
        float(clamped(in, pbr.roughnessFactor, {0, 1}, where + " roughnessFactor"));
    if (material.metallic > 0 || material.roughness > 0)
        material.metallic_roughness_texture =
            texture_use(in, pbr.metallicRoughnessTexture, Transfer::linear,
                        where + " metallicRoughnessTexture");
}

void read_phong(GltfImport& in, const ExtensionObject& phong, Material& material) {
    material.model = MaterialModel::phong;
    material.kd = float(phong.number_in("kd", 1, {0, 1}));
    material.ks = float(phong.number_in("ks", 0, {0, 1}));
    material.kr = float(phong.number_in("kr", 0, {0, 1}));
    material.kt = float(phong.number_in("kt", 0, {0, 1}));
    const float sum = material.kd + material.ks + material.kr + material.kt;
    if (sum > 1 + 1e-5f)
        throw in.error("{}: kd + ks + kr + kt is {}, expected at most 1", phong.where(), sum);
    material.exponent = float(phong.number_in("exponent", 1, {0, kNoLimit}));
    if (phong.has("ior")) material.ior = float(phong.number_in("ior", 1.5, {1, kNoLimit}));
    material.base_color = phong.color("diffuseColor");
    material.specular_color = phong.color("specularColor");
    const std::string fresnel = phong.text("fresnel", "exact");
    if (fresnel != "exact" && fresnel != "schlick")
        throw in.error("{}: fresnel \"{}\", expected exact or schlick", phong.where(), fresnel);
    material.fresnel = fresnel == "exact" ? FresnelModel::exact : FresnelModel::schlick;
    material.base_color_texture = texture_use(in, phong.object("diffuseTexture"), Transfer::srgb);
}

// The base colour and metallic-roughness factors, from whichever extension describes them.
tinygltf::PbrMetallicRoughness base_of(GltfImport& in, const tinygltf::Material& source,
                                       const std::string& where) {
    const auto specular =
        extension(in, source.extensions, "KHR_materials_pbrSpecularGlossiness", where);
    return specular ? converted_specular_glossiness(in, *specular) : source.pbrMetallicRoughness;
}

Material material_from(GltfImport& in, const tinygltf::Material& source, const std::string& where) {
    Material material;
    material.name = source.name;
    material.double_sided = source.doubleSided;
    read_alpha(in, source, where, material);
    const auto phong = extension(in, source.extensions, "QL_materials_phong", where);
    // The Phong extension has a diffuse texture of its own: the one of glTF's model is not read.
    tinygltf::PbrMetallicRoughness pbr = base_of(in, source, where);
    if (phong) pbr.baseColorTexture = {};
    read_base_color(in, pbr, where, material);
    if (!phong && source.extensions.contains("KHR_materials_unlit")) {
        material.model = MaterialModel::unlit;
        return material;
    }
    material.ior = read_ior(in, source, where);
    read_emission(in, source, where, material);
    read_normal_map(in, source, where, material);
    if (phong) {
        read_phong(in, *phong, material);
    } else {
        read_metallic_roughness(in, pbr, where, material);
        read_transmission(in, source, where, material);
    }
    return material;
}

} // namespace

int import_material(GltfImport& in, int index, const std::string& where) {
    const auto known = in.materials.find(index);
    if (known != in.materials.end()) return known->second;
    static const tinygltf::Material kDefault;
    const tinygltf::Material& source =
        index < 0 ? kDefault : in.at(in.model.materials, index, where, "material");
    Material material = material_from(in, source, fmt::format("material {}", index));
    const int result = int(in.scene.materials.size());
    in.scene.materials.push_back(std::move(material));
    return in.materials[index] = result;
}

} // namespace ql
