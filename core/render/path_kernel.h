// Unidirectional path tracing with next-event estimation: the inner loop, compiled for the lobes
// that a scene requires.
//
// Estimator: Kajiya 1986 in the form of Veach 1997, chapter 9: at every vertex one light is chosen
// (at the first each, if that is asked for), one direction by the BSDF, both weighted by the power
// heuristic. Radiance in units of LightSet (real values times 2^-exponent). A path's random numbers
// are those of its PixelRandom:
//   block 0: position in the pixel (x, y), key of alpha decisions
//   block 1 + 2 d: choice of the light (two words), point on it     at scattering d = 0, 1, ...
//   block 2 + 2 d: lobe, direction (2), Russian roulette
#pragma once

#include "geometry/embree_scene.h"
#include "sampling/random.h"
#include "sampling/warp.h"
#include "shading/bsdf.h"
#include "shading/lights.h"
#include "shading/vertex.h"

#include <cmath>
#include <optional>

namespace ql {

enum class LightSampling {
    mis,    // both strategies, power heuristic
    lights, // next-event estimation alone; emitters are seen directly and through specular lobes
    bsdf    // directions by the BSDF alone: no point, spot or directional light is ever found
};

struct PathConfig {
    int max_depth = 5;      // scatterings at most, at least 1; 1 is direct light alone
    int roulette_depth = 3; // scatterings before Russian roulette sets in; 0 never
    LightSampling light_sampling = LightSampling::mis;
    bool all_lights = false; // LightChoice::each at the first vertex
    V3f sky = {0, 0, 0};     // radiance of rays that leave the scene, W/(m^2 sr)
};

struct PathContext {
    const EmbreeScene& scene;
    const LightSet& lights;
    PathConfig config;
    bool has_emission = false; // some material emits
    // Whether a ray after the last scattering can add anything: emission or a sky.
    bool last_ray_finds_light = true;
};

// The first surface of a path, for AOVs.
struct FirstHit {
    bool found = false;
    V3f position; // render space
    V3f normal;   // shading normal towards the viewer
    V3f albedo;
    uint32_t surface = 0;
};

struct PathSample {
    V3f direct = {0, 0, 0};   // at most one scattering between light and camera
    V3f indirect = {0, 0, 0}; // more than one
};

struct RayCounts {
    uint64_t camera = 0;
    uint64_t indirect = 0;
    uint64_t shadow = 0;

    void add(const RayCounts& other) {
        camera += other.camera;
        indirect += other.indirect;
        shadow += other.shadow;
    }
};

// Counts the rays; other observers record them.
struct RayCounter {
    RayCounts counts;
    void on_nearest(const Ray&, int depth) { ++(depth == 0 ? counts.camera : counts.indirect); }
    void on_shadow(const Ray&) { ++counts.shadow; }
};

namespace detail {

inline V3f times(const V3f& a, const V3f& b) {
    return {a.x * b.x, a.y * b.y, a.z * b.z};
}

inline bool is_black(const V3f& v) {
    return v.x == 0 && v.y == 0 && v.z == 0;
}

// Power heuristic with exponent 2: weight of a strategy of density `own` against `other`.
inline float mis_weight(float own, float other) {
    const float ratio = other / own;
    return 1 / (1 + ratio * ratio);
}

} // namespace detail

template<uint32_t Lobes, class Observer>
class PathKernel {
  public:
    PathKernel(const PathContext& context, Observer& observer)
        : m_context(context), m_world(context.scene.world()),
          m_first_choice(context.lights.choice(context.config.all_lights)), m_observer(observer) {}

    // Random: PixelRandom, or anything with its words() and block().
    template<class Random>
    PathSample trace(const Ray& camera_ray, const Random& random, uint32_t alpha_key,
                     FirstHit* first_hit) const;

  private:
    V3f emitted(const SurfacePoint& point, const Material& material, const Ray& ray, float distance,
                float bsdf_pdf, LightChoice choice) const;
    V3f lit_by_lights(const PathVertex& vertex, LightChoice choice, const RandomWords& words,
                      uint32_t alpha_key) const;
    V3f lit_by(const PathVertex& vertex, const LightSample& light, uint32_t alpha_key) const;
    bool is_lit(const PathVertex& vertex, const LightSample& light, uint32_t alpha_key) const;

    const PathContext& m_context;
    const World& m_world;
    LightChoice m_first_choice;
    Observer& m_observer;
};

// Radiance that leaves the point towards the ray's origin by emission, weighted against having been
// found by light sampling. bsdf_pdf is 0 for camera rays and after specular lobes.
template<uint32_t Lobes, class Observer>
V3f PathKernel<Lobes, Observer>::emitted(const SurfacePoint& point, const Material& material,
                                         const Ray& ray, float distance, float bsdf_pdf,
                                         LightChoice choice) const {
    const V3f radiance =
        emission_at(m_world.scene->textures, material, surface_input(point, -ray.direction));
    if (detail::is_black(radiance)) return radiance;
    float weight = 1;
    if (bsdf_pdf > 0 && m_context.config.light_sampling != LightSampling::bsdf) {
        const float light_pdf =
            m_context.lights.pdf_solid_angle(point, ray.direction, distance, choice);
        if (m_context.config.light_sampling == LightSampling::mis)
            weight = detail::mis_weight(bsdf_pdf, light_pdf);
        else if (light_pdf > 0)
            weight = 0;
    }
    // The power of two first: with a small weight it would leave the range of float.
    return radiance * m_context.lights.stored_from_real() * weight;
}

template<uint32_t Lobes, class Observer>
bool PathKernel<Lobes, Observer>::is_lit(const PathVertex& vertex, const LightSample& light,
                                         uint32_t alpha_key) const {
    Ray ray;
    ray.origin = offset_origin(vertex.position, vertex.ng, vertex.offset, light.direction);
    ray.direction = light.distant ? light.direction : light.target - ray.origin;
    ray.t_far = light.distant ? kInfinity : 1.0f;
    m_observer.on_shadow(ray);
    return !m_context.scene.is_occluded(ray, alpha_key);
}

// Next-event estimation. Only one sample is of an area, so that all may share their numbers.
template<uint32_t Lobes, class Observer>
V3f PathKernel<Lobes, Observer>::lit_by_lights(const PathVertex& vertex, LightChoice choice,
                                               const RandomWords& words, uint32_t alpha_key) const {
    const LightSet& lights = m_context.lights;
    V3f sum(0);
    for (size_t i = 0; i < lights.sample_count(choice); ++i) {
        const auto light =
            lights.sample(vertex.position, choice, i, unit_double(words[0], words[1]),
                          {unit_float(words[2]), unit_float(words[3])});
        if (light) sum += lit_by(vertex, *light, alpha_key);
    }
    return sum;
}

// By one light, weighted against having been found by the BSDF.
template<uint32_t Lobes, class Observer>
V3f PathKernel<Lobes, Observer>::lit_by(const PathVertex& vertex, const LightSample& light,
                                        uint32_t alpha_key) const {
    const V3f wi_local = vertex.frame.local_from_world(light.direction);
    // What the shading frame takes for reflection must be reflection at the real surface too.
    if (wi_local.z * vertex.ng.dot(light.direction) <= 0) return V3f(0);
    const BsdfValue scattered = value_and_pdf_bsdf<Lobes>(vertex.bsdf, vertex.wo_local, wi_local);
    if (detail::is_black(scattered.value)) return V3f(0);
    float weight = 1;
    if (light.pdf_solid_angle > 0 && m_context.config.light_sampling == LightSampling::mis)
        weight = detail::mis_weight(light.pdf_solid_angle, scattered.pdf_solid_angle);
    if (!is_lit(vertex, light, alpha_key)) return V3f(0);
    return detail::times(scattered.value, light.weight) * weight;
}

template<uint32_t Lobes, class Observer>
template<class Random>
PathSample PathKernel<Lobes, Observer>::trace(const Ray& camera_ray, const Random& random,
                                              uint32_t alpha_key, FirstHit* first_hit) const {
    const PathConfig& config = m_context.config;
    PathSample sample;
    V3f throughput(1, 1, 1);
    Ray ray = camera_ray;
    float bsdf_pdf = 0; // of the ray's direction; 0: the camera or a specular lobe chose it

    for (int depth = 0;; ++depth) {
        // Find the next surface, or the sky.
        const uint32_t ray_key = alpha_key + uint32_t(depth) * 0x9e3779b9u;
        m_observer.on_nearest(ray, depth);
        Hit hit;
        if (!m_context.scene.intersect(ray, ray_key, hit)) {
            const V3f sky = config.sky * m_context.lights.stored_from_real();
            (depth <= 1 ? sample.direct : sample.indirect) += detail::times(throughput, sky);
            break;
        }
        const SurfacePoint point = surface_point(m_world, ray, hit);
        const Material& material = m_world.scene->materials[size_t(point.material)];

        // Add what the surface emits.
        if (m_context.has_emission) {
            const LightChoice choice = depth == 1 ? m_first_choice : LightChoice::one;
            const V3f radiance = emitted(point, material, ray, hit.t, bsdf_pdf, choice);
            (depth <= 1 ? sample.direct : sample.indirect) += detail::times(throughput, radiance);
        }
        if (depth == config.max_depth) break;
        const PathVertex vertex = path_vertex(*m_world.scene, point, material, -ray.direction);
        if (depth == 0 && first_hit)
            *first_hit = {true, point.position, vertex.frame.n, albedo_of(vertex.bsdf),
                          point.surface};

        // Add light that comes straight from the lights.
        if (!m_context.lights.empty() && config.light_sampling != LightSampling::bsdf) {
            const LightChoice choice = depth == 0 ? m_first_choice : LightChoice::one;
            const V3f radiance = lit_by_lights(
                vertex, choice, random.words(uint32_t(1 + 2 * depth)), ray_key ^ 0x5bd1e995u);
            (depth == 0 ? sample.direct : sample.indirect) += detail::times(throughput, radiance);
        }

        // Choose where the path goes on; a last ray can only find emission or the sky.
        if (depth + 1 == config.max_depth && !m_context.last_ray_finds_light) break;
        const RandomFloats u = random.block(uint32_t(2 + 2 * depth));
        const auto next = sample_bsdf<Lobes>(vertex.bsdf, vertex.wo_local, u[0], {u[1], u[2]});
        if (!next) break;
        const V3f wi = vertex.frame.world_from_local(next->wi);
        if ((wi.dot(vertex.ng) > 0) == next->transmitted) break;
        throughput = detail::times(throughput, next->weight);
        if (config.roulette_depth > 0 && depth + 1 >= config.roulette_depth) {
            const float survival =
                std::min(0.95f, std::max({throughput.x, throughput.y, throughput.z}));
            if (!(u[3] < survival)) break;
            throughput /= survival;
        }
        if (detail::is_black(throughput)) break;
        bsdf_pdf = next->specular ? 0 : next->pdf_solid_angle;
        ray = {offset_origin(point.position, vertex.ng, point.offset, wi), 0, wi, kInfinity};
    }
    return sample;
}

} // namespace ql
