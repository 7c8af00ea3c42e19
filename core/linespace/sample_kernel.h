// Camera paths that end in the cache.
//
// Source: Nilles 2017, sections 4.2.3 and 5.2.7. At every vertex the lobes are parted: diffuse
// lobes (and glossy ones that ReadConfig says so) read the cache and trust next-event estimation
// with the light they receive directly; the other lobes are traced on as in render/path_kernel.h,
// with the probability of their share in the vertex. A read costs little, so that every vertex with
// lobes that read does it.
// A read whose ray meets something before the voxel's face does not use the shaft, the path goes
// on from there: the light that photons brought from inside the voxel was not stored. Light that
// such a path finds by emission is not counted, it is in the next-event estimate or, over mirrors
// and glass, in the caustic layer. Random numbers of a path, by branch b and scattering d:
//   block 4096 b + 5 d + 1: choice of the light, point on it
//   block 4096 b + 5 d + 2: lobe and direction (2) of a read, Russian roulette
//   block 4096 b + 5 d + 3: blur (2), glossy decision
//   block 4096 b + 5 d + 4: shaft jitter
//   block 4096 b + 5 d + 5: lobe and direction (2) of what is traced on, Russian roulette
#pragma once

#include "linespace/blur.h"
#include "linespace/candidates.h"
#include "linespace/open_sides.h"
#include "linespace/parted_vertex.h"
#include "linespace/read_table.h"

namespace ql {

enum class Fallback {
    never,
    trace // where no light came by a shaft, trace on; count estimators alone
};

struct ReadConfig {
    int max_depth = 5;      // scatterings of the joined path
    int roulette_depth = 3; // as in PathConfig
    int reads = 1;          // of the cache at the first vertex of a path that reads, at least 1
    GlossyLimits glossy;
    bool all_lights = false; // as in PathConfig
    float shaft_jitter = 0;  // width of the box that look-ups are moved in, in patches
    Fallback fallback = Fallback::never;
};

struct ReadContext {
    const EmbreeScene& rays;
    const LightSet& lights;
    const ReadTable& table;
    const ShaftCandidates* candidates; // null: ask Embree whether a ray leaves its voxel
    const OpenSides* sides;            // null: all are open
    ReadConfig config;
    Blur blur;
    bool has_emission = false;
};

// Radiance by layer; cached and caustic are parts of indirect.
struct ReadSample {
    V3f direct = {0, 0, 0};
    V3f indirect = {0, 0, 0};
    V3f cached = {0, 0, 0};
    V3f caustic = {0, 0, 0};
};

struct ReadCounts {
    RayCounts rays;
    uint64_t reads = 0;
    uint64_t near_hits = 0; // reads whose ray did not leave the voxel
    uint64_t dark = 0;      // reads of shafts without light
};

template<uint32_t Lobes>
class ReadKernel {
  public:
    ReadKernel(const ReadContext& context, ReadCounts& counts)
        : m_context(context), m_world(context.rays.world()),
          m_first_choice(context.lights.choice(context.config.all_lights)), m_counts(counts) {}

    ReadSample trace(const Ray& camera_ray, const PixelRandom& random, uint32_t alpha_key) const {
        ReadSample sample;
        Path path;
        path.ray = camera_ray;
        path.alpha_key = alpha_key;
        follow(path, random, sample);
        return sample;
    }

  private:
    enum class Emission { counts, by_mis, is_known };

    struct Path {
        Ray ray;
        std::optional<Hit> hit; // where the ray is known to end
        V3f throughput = {1, 1, 1};
        int scatterings = 0;
        Emission emission = Emission::counts;
        float pdf_solid_angle = 0; // of the ray's direction, for by_mis
        bool has_read = false;
        uint32_t branch = 0;
        uint32_t alpha_key = 0;
        uint32_t key() const { return alpha_key + uint32_t(scatterings) * 0x9e3779b9u; }
        uint32_t block(uint32_t n) const { return 4096 * branch + 5 * uint32_t(scatterings) + n; }
    };

    // Tells the random numbers of what is traced on from those of reads.
    static constexpr uint32_t kTracedBranch = 1 << 11;

    void follow(Path path, const PixelRandom& random, ReadSample& sample) const;
    bool find_hit(Path& path) const;
    V3f lit_by_lights(const PartedVertex& v, const Path& path, const PixelRandom& random) const;
    V3f lit_by(const PartedVertex& v, const LightSample& light, const Path& path) const;
    V3f emitted(const SurfacePoint& point, const Material& material, const Path& path,
                float distance) const;
    bool read(const PartedVertex& v, Path& path, const V3f& wi, const PixelRandom& random,
              ReadSample& sample) const;
    std::optional<ShaftPlace> look_up(const PartedVertex& v, const V3f& wi, const Path& path,
                                      const PixelRandom& random) const;
    void read_on(const PartedVertex& v, const Path& path, const PixelRandom& random,
                 ReadSample& sample) const;
    bool continue_traced(const PartedVertex& v, Path& path, const PixelRandom& random) const;
    bool survives(Path& path, float u) const;

    const ReadContext& m_context;
    const World& m_world;
    LightChoice m_first_choice;
    ReadCounts& m_counts;
};

// Next-event estimation: all of the light for the lobes that read, weighted for the others.
template<uint32_t Lobes>
V3f ReadKernel<Lobes>::lit_by_lights(const PartedVertex& v, const Path& path,
                                     const PixelRandom& random) const {
    const RandomWords words = random.words(path.block(1));
    const LightChoice choice = path.scatterings == 0 ? m_first_choice : LightChoice::one;
    const LightSet& lights = m_context.lights;
    V3f sum(0);
    for (size_t i = 0; i < lights.sample_count(choice); ++i) {
        const auto light = lights.sample(v.at.position, choice, i, unit_double(words[0], words[1]),
                                         {unit_float(words[2]), unit_float(words[3])});
        if (light) sum += lit_by(v, *light, path);
    }
    return sum;
}

template<uint32_t Lobes>
V3f ReadKernel<Lobes>::lit_by(const PartedVertex& v, const LightSample& light,
                              const Path& path) const {
    const V3f wi = v.at.frame.local_from_world(light.direction);
    if (wi.z * v.at.ng.dot(light.direction) <= 0) return V3f(0);
    V3f scattered = v.reads() ? read_value<Lobes>(v, wi).value : V3f(0);
    if (v.p_trace > 0) {
        const BsdfValue traced = value_and_pdf_bsdf<Lobes>(v.traced, v.at.wo_local, wi);
        const float weight =
            light.pdf_solid_angle > 0
                ? detail::mis_weight(light.pdf_solid_angle, traced.pdf_solid_angle * v.p_trace)
                : 1;
        scattered += traced.value * weight;
    }
    if (detail::is_black(scattered)) return V3f(0);
    Ray ray;
    ray.origin = offset_origin(v.at.position, v.at.ng, v.at.offset, light.direction);
    ray.direction = light.distant ? light.direction : light.target - ray.origin;
    ray.t_far = light.distant ? kInfinity : 1.0f;
    ++m_counts.rays.shadow;
    if (m_context.rays.is_occluded(ray, path.key() ^ 0x5bd1e995u)) return V3f(0);
    return detail::times(scattered, light.weight);
}

template<uint32_t Lobes>
V3f ReadKernel<Lobes>::emitted(const SurfacePoint& point, const Material& material,
                               const Path& path, float distance) const {
    if (path.emission == Emission::is_known) return V3f(0);
    const V3f radiance =
        emission_at(m_world.scene->textures, material, surface_input(point, -path.ray.direction));
    if (detail::is_black(radiance)) return radiance;
    float weight = 1;
    if (path.emission == Emission::by_mis)
        weight = detail::mis_weight(path.pdf_solid_angle,
                                    m_context.lights.pdf_solid_angle(
                                        point, path.ray.direction, distance,
                                        path.scatterings == 1 ? m_first_choice : LightChoice::one));
    // The power of two first: with a small weight it would leave the range of float.
    return radiance * m_context.lights.stored_from_real() * weight;
}

template<uint32_t Lobes>
bool ReadKernel<Lobes>::find_hit(Path& path) const {
    if (path.hit) return true;
    ++(path.scatterings == 0 ? m_counts.rays.camera : m_counts.rays.indirect);
    path.hit.emplace();
    return m_context.rays.intersect(path.ray, path.key(), *path.hit);
}

template<uint32_t Lobes>
bool ReadKernel<Lobes>::survives(Path& path, float u) const {
    const int depth = m_context.config.roulette_depth;
    if (depth > 0 && path.scatterings >= depth) {
        const V3f& t = path.throughput;
        const float survival = std::min(0.95f, std::max({t.x, t.y, t.z}));
        if (!(u < survival)) return false;
        path.throughput /= survival;
    }
    return !detail::is_black(path.throughput);
}

// The shaft to read. Blur moves the point; jitter moves the line on the faces of the voxel.
template<uint32_t Lobes>
std::optional<ShaftPlace> ReadKernel<Lobes>::look_up(const PartedVertex& v, const V3f& wi,
                                                     const Path& path,
                                                     const PixelRandom& random) const {
    const ReadTable& table = m_context.table;
    V3d start = start_of(v.at, wi);
    if (m_context.blur.is_on()) {
        const RandomFloats u = random.block(path.block(3));
        start += V3d(
            m_context.blur.shift(v.at.position, v.at.ng, v.at.offset, {u[0], u[1]}, path.key()));
    }
    std::optional<ShaftPlace> place = locate(table.grid(), table.patches(), start, V3d(wi));
    if (!place || !(m_context.config.shaft_jitter > 0)) return place;
    const RandomFloats u = random.block(path.block(4));
    const double width = double(m_context.config.shaft_jitter);
    const double n = table.patches();
    double* const coordinates[4] = {&place->entry_u, &place->entry_v, &place->exit_u,
                                    &place->exit_v};
    // Reflected at the rim of the face.
    for (size_t i = 0; i < 4; ++i) {
        const double moved = std::abs(*coordinates[i] + (double(u[i]) - 0.5) * width);
        *coordinates[i] = moved < n ? moved : 2 * n - moved;
    }
    place->shaft = shaft_of(*place, table.patches());
    return place;
}

// Adds what the cache knows of direction wi. Returns whether the path goes on along it: then its
// ray, and its hit where the voxel holds it, are set.
template<uint32_t Lobes>
bool ReadKernel<Lobes>::read(const PartedVertex& v, Path& path, const V3f& wi,
                             const PixelRandom& random, ReadSample& sample) const {
    const ReadTable& table = m_context.table;
    const auto place = look_up(v, wi, path, random);
    path.ray = {offset_origin(v.at.position, v.at.ng, v.at.offset, wi), 0, wi, kInfinity};
    path.hit.reset();
    path.emission = Emission::is_known;
    path.has_read = true;
    const int left = m_context.config.max_depth - path.scatterings - 1;
    if (!place) return true;
    ++m_counts.reads;
    const uint32_t number = table.number_of(place->shaft, v.at.ng);

    // Caustics need no gate.
    if (table.has_caustics() && left >= 1) {
        const V3f light =
            detail::times(path.throughput * table.caustic_share_up_to(left),
                          table.radiance(place->voxel, number + table.caustics_from()));
        sample.caustic += light;
        sample.indirect += light;
    }
    // Does the ray leave the voxel?
    Ray near = path.ray;
    near.t_far = float(place->t_entry);
    Hit hit;
    ++m_counts.rays.indirect;
    const bool stays = m_context.candidates
                           ? m_context.candidates->intersect(near, place->voxel, number, hit)
                           : m_context.rays.intersect(near, path.key() + 0x9e3779b9u, hit);
    if (stays) {
        ++m_counts.near_hits;
        path.hit = hit;
        return true;
    }
    const V3f radiance = table.radiance(place->voxel, number);
    if (detail::is_black(radiance)) {
        ++m_counts.dark;
        return m_context.config.fallback == Fallback::trace;
    }
    const V3f light = detail::times(path.throughput, radiance) * table.share_up_to(left);
    sample.cached += light;
    sample.indirect += light;
    return false;
}

template<uint32_t Lobes>
bool ReadKernel<Lobes>::continue_traced(const PartedVertex& v, Path& path,
                                        const PixelRandom& random) const {
    const RandomFloats u = random.block(path.block(5));
    const float p = v.p_trace;
    if (!(u[0] < p)) return false;
    const float u_lobe = std::min(u[0] / p, 0x1.fffffep-1f);
    const auto next = sample_bsdf<Lobes>(v.traced, v.at.wo_local, u_lobe, {u[1], u[2]});
    if (!next) return false;
    const V3f wi = v.at.frame.world_from_local(next->wi);
    if ((wi.dot(v.at.ng) > 0) == next->transmitted) return false;
    path.throughput = detail::times(path.throughput, next->weight) / p;
    ++path.scatterings;
    if (!survives(path, u[3])) return false;
    // What is known of emission stays known over mirrors and glass.
    if (!next->specular) {
        path.emission = Emission::by_mis;
        path.pdf_solid_angle = next->pdf_solid_angle * p;
    } else if (path.emission == Emission::by_mis) {
        path.emission = Emission::counts;
    }
    path.ray = {offset_origin(v.at.position, v.at.ng, v.at.offset, wi), 0, wi, kInfinity};
    path.hit.reset();
    return true;
}

template<uint32_t Lobes>
void ReadKernel<Lobes>::follow(Path path, const PixelRandom& random, ReadSample& sample) const {
    const ReadConfig& config = m_context.config;
    while (find_hit(path)) {
        const SurfacePoint point = surface_point(m_world, path.ray, *path.hit);
        const Material& material = m_world.scene->materials[size_t(point.material)];

        // Add emission, then light that comes straight from the lights.
        if (m_context.has_emission) {
            const V3f light =
                detail::times(path.throughput, emitted(point, material, path, path.hit->t));
            (path.scatterings <= 1 ? sample.direct : sample.indirect) += light;
        }
        if (path.scatterings == config.max_depth) return;
        const float u_glossy =
            config.glossy.high > config.glossy.low ? random.block(path.block(3))[2] : 0;
        const bool open =
            !m_context.sides ||
            m_context.sides->is_open(point.surface, point.ng.dot(path.ray.direction) < 0);
        const PartedVertex v =
            parted<Lobes>(path_vertex(*m_world.scene, point, material, -path.ray.direction), open,
                          config.glossy, u_glossy);
        if (!m_context.lights.empty()) {
            const V3f light = detail::times(path.throughput, lit_by_lights(v, path, random));
            (path.scatterings == 0 ? sample.direct : sample.indirect) += light;
        }

        // Beyond the last scattering there is emission alone, which reads know.
        const bool last = path.scatterings + 1 == config.max_depth;
        if (last && !m_context.has_emission) return;
        if (v.reads()) {
            if (!last) read_on(v, path, random, sample);
            path.has_read = true;
            path.branch += kTracedBranch;
        }
        // Follow the lobes that are traced on.
        if (!continue_traced(v, path, random)) return;
    }
}

// Reads the cache, in several directions where the path reads for the first time, and follows those
// in which it does not end.
template<uint32_t Lobes>
void ReadKernel<Lobes>::read_on(const PartedVertex& v, const Path& path, const PixelRandom& random,
                                ReadSample& sample) const {
    const RandomFloats u = random.block(path.block(2));
    const int reads = path.has_read ? 1 : m_context.config.reads;
    const V3f share = path.throughput / float(reads);
    for (int r = 0; r < reads; ++r) {
        // Directions of one vertex are a rotated lattice.
        const V2f at = rotated_lattice({u[1], u[2]}, uint32_t(r), uint32_t(reads));
        const auto next = read_sample<Lobes>(v, at, u[0]);
        if (!next) continue;
        const V3f wi = v.at.frame.world_from_local(next->wi);
        if (!(wi.dot(v.at.ng) > 0)) continue;
        Path branch = path;
        branch.throughput = detail::times(share, next->weight);
        if (reads > 1) branch.branch = uint32_t(r) + 1;
        if (!read(v, branch, wi, random, sample)) continue;
        ++branch.scatterings;
        if (!survives(branch, u[3])) continue;
        follow(branch, random, sample);
    }
}

} // namespace ql
