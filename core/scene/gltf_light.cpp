#include "scene/gltf_light.h"

#include "scene/gltf_value.h"

#include <tiny_gltf.h>

#include <limits>
#include <numbers>

namespace ql {

namespace {

constexpr double kNoLimit = std::numeric_limits<double>::max();
// Candela or lux. More leaves the range of float in the smallest scenes.
constexpr double kMaxIntensity = 1e40;

Light::Kind kind_of(const GltfImport& in, const tinygltf::Light& source, const std::string& name) {
    if (source.type == "point") return Light::Kind::point;
    if (source.type == "spot") return Light::Kind::spot;
    if (source.type == "directional") return Light::Kind::directional;
    throw in.error("{}: type \"{}\", expected point, spot or directional", name, source.type);
}

void read_cone(GltfImport& in, const tinygltf::Light& source, const std::string& name,
               Light& light) {
    constexpr double kRightAngle = std::numbers::pi / 2;
    light.outer_angle =
        clamped(in, source.spot.outerConeAngle, {0, kRightAngle}, name + " outerConeAngle");
    light.inner_angle =
        clamped(in, source.spot.innerConeAngle, {0, light.outer_angle}, name + " innerConeAngle");
    if (light.outer_angle == 0) throw in.error("{}: outerConeAngle 0", name);
    if (const auto found = extension(in, source.extensions, "QL_lights_spot_exponent", name))
        light.exponent = found->number_in("exponent", 0, {0, kNoLimit});
}

} // namespace

Light light_from(GltfImport& in, int index, const std::string& where) {
    const tinygltf::Light& source = in.at(in.model.lights, index, where, "light");
    const std::string name = fmt::format("light {}", index);
    Light light;
    light.name = source.name;
    light.kind = kind_of(in, source, name);
    if (!source.color.empty() && source.color.size() != 3)
        throw in.error("{}: colour of {} components, expected 3", name, source.color.size());
    const double intensity = clamped(in, source.intensity, {0, kNoLimit}, name + " intensity");
    for (int c = 0; c < 3; ++c) {
        const double color = source.color.empty() ? 1 : source.color[size_t(c)];
        const double product = intensity * clamped(in, color, {0, kNoLimit}, name + " color");
        light.intensity[c] =
            clamped(in, product, {0, kMaxIntensity}, name + " intensity times color");
    }
    if (source.range > 0) in.warn("{}: its range is ignored", name);
    if (light.kind == Light::Kind::spot) read_cone(in, source, name, light);
    return light;
}

} // namespace ql
