#include "shading/lights.h"

#include "base/error.h"
#include "sampling/warp.h"
#include "shading/surface_input.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace ql {

namespace {

constexpr double kPiD = std::numbers::pi;
// Squares of distances must be floats.
constexpr double kMaxLightDistance = 1e15;
// A light inside the last 2^-20 of the way may lie on a surface: do not let that surface hide it.
constexpr float kShadowEnd = 1 - 0x1p-20f;
// As many point, spot and directional lights are compared at every point; more are chosen by power.
constexpr size_t kMostCompared = 32;
// Textured emission is averaged over this many points per side when a triangle's power is needed.
constexpr int kPowerSamples = 4;
// Of the most that a textured emitter may have, where those points find less.
constexpr double kLeastShare = 1.0 / 64;

double largest(const V3d& v) {
    return std::max({v.x, v.y, v.z});
}

double mean(const V3f& v) {
    return (double(v.x) + double(v.y) + double(v.z)) / 3;
}

bool emits(const Material& material) {
    return material.emission != V3f(0, 0, 0) || material.model == MaterialModel::unlit;
}

V3d light_intensity(const Light& light, const RenderSpace& space) {
    const double s2 = space.scale * space.scale;
    return light.kind == Light::Kind::directional ? light.intensity : light.intensity * s2;
}

// The exponent of the brightest light or emitter.
int brightness_exponent(const World& world) {
    double brightest = 0;
    for (const Node& node : world.scene->nodes)
        if (node.light >= 0)
            brightest = std::max(
                brightest,
                largest(light_intensity(world.scene->lights[size_t(node.light)], world.space)));
    for (const Surface& surface : world.surfaces) {
        const Material& material = world.scene->materials[size_t(surface.material)];
        brightest = std::max(brightest, largest(V3d(material.emission)));
        if (material.model == MaterialModel::unlit)
            brightest = std::max(brightest, largest(V3d(material.base_color)));
    }
    // Within what float holds on both sides of 1: then 2^-k times a light that is 0 is 0, not NaN.
    return brightest > 0 ? std::clamp(std::ilogb(brightest), -120, 120) : 0;
}

} // namespace

// The share of the axial intensity that goes to a point from which the light lies in `direction`.
float LightSet::Punctual::falloff(const V3f& direction) const {
    if (kind != Light::Kind::spot) return 1;
    return cone.falloff(one_minus_cos_between(-direction, axis));
}

// On a surface that faces the light, with nothing in between; mean over R, G, B.
float LightSet::Punctual::irradiance_at(const V3f& point) const {
    if (kind == Light::Kind::directional) return mean_intensity;
    const V3f way = position - point;
    const float distance2 = way.dot(way);
    if (!(distance2 > 0)) return 0;
    return mean_intensity * falloff(way / std::sqrt(distance2)) / distance2;
}

bool has_emission(const Scene& scene) {
    return std::any_of(scene.materials.begin(), scene.materials.end(), emits);
}

LightSet::LightSet(const World& world) : m_world(&world), m_exponent(brightness_exponent(world)) {
    m_stored_from_real = float(std::ldexp(1.0, -m_exponent));
    add_punctual(world);
    add_emitters(world);
    std::vector<double> powers;
    powers.reserve(m_punctual.size() + emitter_count());
    for (const Punctual& light : m_punctual)
        powers.push_back(punctual_power(light));
    std::map<int, LitTexels> lit_texels;
    for (size_t i = 0; i < emitter_count(); ++i)
        powers.push_back(emitter_power(i, lit_texels));
    m_pick = AliasTable(powers);
    m_pick_emitter = AliasTable(std::span(powers).subspan(m_punctual.size()));
    for (size_t i = 0; i < m_punctual.size(); ++i)
        m_punctual_probability += m_pick.probability(i);
}

void LightSet::add_punctual(const World& world) {
    const Scene& scene = *world.scene;
    for (size_t i = 0; i < scene.nodes.size(); ++i) {
        if (scene.nodes[i].light < 0) continue;
        const Light& light = scene.lights[size_t(scene.nodes[i].light)];
        const Affine world_from_node = affine_from(world.world_from_node[i]);
        Punctual punctual;
        punctual.kind = light.kind;
        const V3d position = world.space.from_world(world_from_node.translation);
        if (!(position.length() <= kMaxLightDistance))
            throw input_error("light '{}' is {:g} times as far away as the scene is wide, expected "
                              "at most {:g}",
                              light.name, position.length(), kMaxLightDistance);
        punctual.position = V3f(position);
        punctual.axis = V3f(world_from_node.vector({0, 0, -1}).normalized());
        punctual.intensity =
            V3f(light_intensity(light, world.space) * std::ldexp(1.0, -m_exponent));
        punctual.mean_intensity = float(mean(punctual.intensity));
        punctual.cone =
            spot_cone(light.inner_angle, light.outer_angle, light.exponent.value_or(-1));
        m_punctual.push_back(punctual);
    }
}

void LightSet::add_emitters(const World& world) {
    m_first_emitter.assign(world.surfaces.size(), -1);
    const auto emits_light = [&](const Surface& surface) {
        return emits(world.scene->materials[size_t(surface.material)]);
    };
    for (uint32_t s = 0; s < world.surfaces.size(); ++s) {
        const Surface& surface = world.surfaces[s];
        if (surface.kind != Surface::Kind::triangles || !emits_light(surface)) continue;
        m_first_emitter[s] = int(m_triangles.size());
        add_triangles(world, s);
    }
    for (uint32_t s = 0; s < world.surfaces.size(); ++s) {
        const Surface& surface = world.surfaces[s];
        if (surface.kind == Surface::Kind::triangles || !emits_light(surface)) continue;
        m_first_emitter[s] = int(emitter_count());
        m_shapes.emplace_back(world, s);
    }
}

void LightSet::add_triangles(const World& world, uint32_t surface_index) {
    const Surface& surface = world.surfaces[surface_index];
    const Material& material = world.scene->materials[size_t(surface.material)];
    const Mesh& mesh = world.scene->meshes[size_t(surface.mesh)];
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        const auto corners = triangle_corners(world, surface_index, t);
        Triangle triangle;
        triangle.corner = corners[0];
        triangle.edge1 = corners[1] - corners[0];
        triangle.edge2 = corners[2] - corners[0];
        const V3f cross = triangle.edge1.cross(triangle.edge2);
        const float length = cross.length();
        triangle.area = length / 2;
        triangle.normal = length > 0 ? cross * (surface.winding / length) : V3f(0, 0, 1);
        triangle.offset = triangle_offset(surface, corners);
        triangle.surface = surface_index;
        triangle.primitive = t;
        triangle.double_sided = material.double_sided;
        triangle.textured = material.emission_texture.used() ||
                            material.model == MaterialModel::unlit ||
                            material.alpha_mode != AlphaMode::opaque;
        m_triangles.push_back(triangle);
    }
}

double LightSet::punctual_power(const Punctual& light) const {
    const double i = mean(light.intensity);
    switch (light.kind) {
    case Light::Kind::point:
        return 4 * kPiD * i;
    case Light::Kind::spot:
        return 2 * kPiD * i * light.cone.integral();
    case Light::Kind::directional: {
        const V3d size = m_world->bounds.isEmpty() ? V3d(0) : m_world->bounds.size();
        return i * kPiD * size.length2() / 4; // the disc around the scene's bounding sphere
    }
    }
    return 0;
}

bool LightSet::is_double_sided(const ShapeLight& shape) const {
    const Surface& surface = m_world->surfaces[shape.surface()];
    return m_world->scene->materials[size_t(surface.material)].double_sided;
}

// Mean over a grid of points, where the radiance differs from place to place.
double LightSet::emitter_power(size_t emitter, std::map<int, LitTexels>& lit_texels) const {
    const bool is_triangle = emitter < m_triangles.size();
    const ShapeLight* const shape = is_triangle ? nullptr : &m_shapes[emitter - m_triangles.size()];
    double radiance = 0;
    for (int i = 0; i < kPowerSamples; ++i)
        for (int j = 0; j < kPowerSamples; ++j) {
            const V2f u((float(i) + 0.5f) / kPowerSamples, (float(j) + 0.5f) / kPowerSamples);
            if (is_triangle) {
                const V2f b = square_to_uniform_triangle(u);
                radiance += mean(triangle_radiance(m_triangles[emitter], b.x, b.y));
            } else if (shape->area() > 0) {
                radiance += mean(shape_radiance(*shape, shape->sample(u).uv));
            }
        }
    radiance /= kPowerSamples * kPowerSamples;
    // Light between those points must have a chance, too.
    const bool textured = is_triangle ? m_triangles[emitter].textured : true;
    const double least = textured ? kLeastShare * brightest_radiance(emitter) : 0;
    if (radiance < least && may_shine(emitter, lit_texels)) radiance = least;
    const double area = is_triangle ? double(m_triangles[emitter].area) : shape->area();
    return radiance * kPiD * area * (material_of(emitter).double_sided ? 2 : 1);
}

// What a textured emitter has at most, where its texture is white; mean over R, G, B.
double LightSet::brightest_radiance(size_t emitter) const {
    const Material& material = material_of(emitter);
    const bool unlit = material.model == MaterialModel::unlit;
    return mean(unlit ? material.base_color : material.emission) * double(m_stored_from_real);
}

// Whether the texture of an emitter has light anywhere on it; on the safe side. Textures that were
// looked through are kept in `lit_texels`.
bool LightSet::may_shine(size_t emitter, std::map<int, LitTexels>& lit_texels) const {
    const Material& material = material_of(emitter);
    const TextureUse& use = material.model == MaterialModel::unlit ? material.base_color_texture
                                                                   : material.emission_texture;
    if (!use.used() || emitter >= m_triangles.size()) return true;
    const Scene& scene = *m_world->scene;
    const Triangle& triangle = m_triangles[emitter];
    const Mesh& mesh = scene.meshes[size_t(m_world->surfaces[triangle.surface].mesh)];
    const std::vector<V2f>& uvs = mesh.uvs[size_t(use.uv_set)];
    if (uvs.empty()) return true;
    const auto& corners = mesh.triangles[triangle.primitive];
    const auto texels =
        lit_texels.try_emplace(use.texture, scene.textures[size_t(use.texture)]).first;
    return texels->second.any_in(use, {uvs[corners[0]], uvs[corners[1]], uvs[corners[2]]});
}

const Material& LightSet::material_of(size_t emitter) const {
    const uint32_t surface = emitter < m_triangles.size()
                                 ? m_triangles[emitter].surface
                                 : m_shapes[emitter - m_triangles.size()].surface();
    return m_world->scene->materials[size_t(m_world->surfaces[surface].material)];
}

V3f LightSet::shape_radiance(const ShapeLight& shape, const V2f& uv) const {
    const Scene& scene = *m_world->scene;
    const Material& material = scene.materials[size_t(m_world->surfaces[shape.surface()].material)];
    const SurfaceInput input = surface_input_at(*m_world, shape.surface(), 0, uv.x, uv.y);
    return emission_at(scene.textures, material, input) *
           (alpha_at(scene.textures, material, input) * m_stored_from_real);
}

V3f LightSet::triangle_radiance(const Triangle& triangle, float b1, float b2) const {
    const Scene& scene = *m_world->scene;
    const Surface& surface = m_world->surfaces[triangle.surface];
    const Material& material = scene.materials[size_t(surface.material)];
    if (!triangle.textured) return material.emission * m_stored_from_real;
    const SurfaceInput input =
        surface_input_at(*m_world, triangle.surface, triangle.primitive, b1, b2);
    // No ray decides here whether the surface is there: its mean counts.
    return emission_at(scene.textures, material, input) *
           (alpha_at(scene.textures, material, input) * m_stored_from_real);
}

LightChoice LightSet::choice(bool each) const {
    const bool possible = sample_count(LightChoice::each) > 1 && m_punctual.size() <= kMostCompared;
    return each && possible ? LightChoice::each : LightChoice::one;
}

size_t LightSet::sample_count(LightChoice choice) const {
    if (choice == LightChoice::one) return 1;
    return m_punctual.size() + (m_pick_emitter.empty() ? 0 : 1);
}

std::optional<LightSample> LightSet::sample(const V3f& from, LightChoice choice, size_t i,
                                            double u_pick, V2f u) const {
    if (choice == LightChoice::one) return sample_one(from, u_pick, u);
    if (i < m_punctual.size()) return sample_punctual(m_punctual[i], from, 1);
    const auto pick = m_pick_emitter.sample(u_pick);
    return sample_emitter(pick.index, from, u, pick.probability);
}

std::optional<LightSample> LightSet::sample_one(const V3f& from, double u_pick, V2f u) const {
    const auto pick = m_pick.sample(u_pick);
    if (pick.index >= m_punctual.size())
        return sample_emitter(pick.index - m_punctual.size(), from, u, pick.probability);
    if (m_punctual.size() > 1 && m_punctual.size() <= kMostCompared)
        return sample_brightest(from, pick.u);
    return sample_punctual(m_punctual[pick.index], from, pick.probability);
}

// Chooses in proportion to the irradiance of a surface that faces the light.
std::optional<LightSample> LightSet::sample_brightest(const V3f& from, float u) const {
    constexpr float kLargest = 1e30f; // very near lights: sums stay finite
    std::array<float, kMostCompared> irradiance;
    float total = 0;
    for (size_t i = 0; i < m_punctual.size(); ++i) {
        irradiance[i] = std::min(m_punctual[i].irradiance_at(from), kLargest);
        total += irradiance[i];
    }
    if (!(total > 0)) return std::nullopt;
    float left = u * total;
    size_t pick = m_punctual.size();
    for (size_t i = 0; i < m_punctual.size(); ++i) {
        if (!(irradiance[i] > 0)) continue;
        pick = i;
        if (left < irradiance[i]) break;
        left -= irradiance[i];
    }
    return sample_punctual(m_punctual[pick], from,
                           m_punctual_probability * (irradiance[pick] / total));
}

std::optional<LightSample> LightSet::sample_punctual(const Punctual& light, const V3f& from,
                                                     float probability) const {
    LightSample sample;
    sample.pdf_solid_angle = 0;
    if (light.kind == Light::Kind::directional) {
        sample.distant = true;
        sample.direction = -light.axis;
        sample.weight = light.intensity / probability;
        return sample;
    }
    const V3f way = light.position - from;
    const float distance2 = way.dot(way);
    if (!(distance2 > 0)) return std::nullopt;
    sample.direction = way / std::sqrt(distance2);
    const float falloff = light.falloff(sample.direction);
    if (falloff <= 0) return std::nullopt;
    sample.distant = false;
    sample.target = from + way * kShadowEnd;
    sample.weight = light.intensity * (falloff / (distance2 * probability));
    return sample;
}

std::optional<LightSample> LightSet::sample_emitter(size_t emitter, const V3f& from, V2f u,
                                                    float probability) const {
    const bool is_triangle = emitter < m_triangles.size();
    V3f at, normal;
    V2f place; // barycentric or texture coordinates
    float area, offset;
    bool double_sided;
    if (is_triangle) {
        const Triangle& triangle = m_triangles[emitter];
        place = square_to_uniform_triangle(u);
        at = triangle.corner + triangle.edge1 * place.x + triangle.edge2 * place.y;
        normal = triangle.normal;
        area = triangle.area;
        offset = triangle.offset;
        double_sided = triangle.double_sided;
    } else {
        const ShapeLight& shape = m_shapes[emitter - m_triangles.size()];
        const ShapePoint point = shape.sample(u);
        place = point.uv;
        at = point.position;
        normal = point.normal;
        area = shape.area_at(normal);
        offset = m_world->surfaces[shape.surface()].offset;
        double_sided = is_double_sided(shape);
    }
    const V3f way = at - from;
    const float distance2 = way.dot(way);
    if (!(distance2 > 0)) return std::nullopt;
    LightSample sample;
    sample.direction = way / std::sqrt(distance2);
    const float cosine = -sample.direction.dot(normal);
    if (cosine == 0 || (cosine < 0 && !double_sided)) return std::nullopt;
    sample.distant = false;
    // Where a ray meets the light is as uncertain as the coordinates of both of its ends.
    const float end_offset = offset + kOffsetFactor * detail::largest_coordinate(from);
    sample.target = offset_origin(at, normal, end_offset, -sample.direction);
    sample.pdf_solid_angle = probability * distance2 / (std::abs(cosine) * area);
    if (!std::isfinite(sample.pdf_solid_angle)) return std::nullopt;
    const V3f radiance = is_triangle
                             ? triangle_radiance(m_triangles[emitter], place.x, place.y)
                             : shape_radiance(m_shapes[emitter - m_triangles.size()], place);
    sample.weight = radiance / sample.pdf_solid_angle;
    return sample;
}

float LightSet::pdf_solid_angle(const SurfacePoint& at, const V3f& direction, float distance,
                                LightChoice choice) const {
    const int first = m_first_emitter[at.surface];
    if (first < 0) return 0;
    const size_t emitter = size_t(first) + at.primitive;
    const bool is_triangle = emitter < m_triangles.size();
    const V3f& normal = is_triangle ? m_triangles[emitter].normal : at.ng;
    const float area = is_triangle ? m_triangles[emitter].area
                                   : m_shapes[emitter - m_triangles.size()].area_at(normal);
    const float cosine = std::abs(direction.dot(normal));
    if (!(cosine > 0) || area <= 0) return 0;
    const float probability = choice == LightChoice::one
                                  ? m_pick.probability(m_punctual.size() + emitter)
                                  : m_pick_emitter.probability(emitter);
    return probability * distance * distance / (cosine * area);
}

} // namespace ql
