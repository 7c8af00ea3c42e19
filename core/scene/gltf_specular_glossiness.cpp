#include "scene/gltf_specular_glossiness.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>

namespace ql {

namespace {

constexpr double kDielectric = 0.04;

double brightness(const V3d& c) {
    return std::sqrt(0.299 * c.x * c.x + 0.587 * c.y * c.y + 0.114 * c.z * c.z);
}

double solved_metallic(double diffuse, double specular, double transmitted) {
    if (specular <= kDielectric) return 0;
    // A quadratic equation in m: a m^2 + b m + c = 0.
    const double a = kDielectric;
    const double b = diffuse * transmitted / (1 - kDielectric) + specular - 2 * kDielectric;
    const double c = kDielectric - specular;
    const double root = std::sqrt(std::max(b * b - 4 * a * c, 0.0));
    return std::clamp((-b + root) / (2 * a), 0.0, 1.0);
}

// Within [0, 1], as many numbers as the fallback.
std::vector<double> factor(GltfImport& in, const ExtensionObject& source, const char* key,
                           const std::vector<double>& fallback) {
    std::vector<double> values = source.numbers(key, fallback);
    for (double& value : values)
        value = clamped(in, value, {0, 1}, source.where() + " " + key);
    return values;
}

tinygltf::TextureInfo texture_info(const ExtensionObject& source) {
    tinygltf::TextureInfo info;
    info.index = source.index("index");
    info.texCoord = source.has("texCoord") ? source.index("texCoord") : 0;
    const auto extensions = source.object("extensions");
    const auto transform = extensions ? extensions->object("KHR_texture_transform") : std::nullopt;
    if (transform) info.extensions["KHR_texture_transform"] = transform->value();
    return info;
}

} // namespace

tinygltf::PbrMetallicRoughness converted_specular_glossiness(GltfImport& in,
                                                             const ExtensionObject& source) {
    if (source.has("specularGlossinessTexture"))
        throw in.error("{}: its specularGlossinessTexture is not supported", source.where());
    in.warn("{}: converted to metallic-roughness", source.where());
    const std::vector<double> rgba = factor(in, source, "diffuseFactor", {1, 1, 1, 1});
    const std::vector<double> rgb = factor(in, source, "specularFactor", {1, 1, 1});
    const V3d diffuse(rgba[0], rgba[1], rgba[2]);
    const V3d specular(rgb[0], rgb[1], rgb[2]);

    const double transmitted = 1 - std::max({specular.x, specular.y, specular.z});
    const double metallic = solved_metallic(brightness(diffuse), brightness(specular), transmitted);

    // The base colour goes over from what a dielectric to what a metal needs.
    constexpr double kTiny = 1e-6;
    const V3d of_dielectric =
        diffuse * (transmitted / (1 - kDielectric) / std::max(1 - metallic, kTiny));
    const V3d of_metal = (specular - V3d(kDielectric * (1 - metallic))) / std::max(metallic, kTiny);
    const double share = metallic * metallic;
    tinygltf::PbrMetallicRoughness result;
    for (int c = 0; c < 3; ++c)
        result.baseColorFactor[size_t(c)] =
            std::clamp(of_dielectric[c] * (1 - share) + of_metal[c] * share, 0.0, 1.0);
    result.baseColorFactor[3] = rgba[3];
    result.metallicFactor = metallic;
    result.roughnessFactor = 1 - source.number_in("glossinessFactor", 1, {0, 1});
    if (const auto texture = source.object("diffuseTexture"))
        result.baseColorTexture = texture_info(*texture);
    return result;
}

} // namespace ql
