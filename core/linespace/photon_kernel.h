// Light paths: from a light over the scene, leaving a deposit at every hit from the second on.
//
// Particle tracing in the form of Veach 1997, section 4.4 and 5.3: photons carry flux; scattering
// with shading normals is the adjoint of that of camera paths. Russian roulette from the first
// scattering on keeps the flux of a photon at its first value. At the first surface that takes
// light a photon is split (Arvo and Kirk, "Particle transport and image synthesis", SIGGRAPH 1990):
// most photons of an open scene never arrive anywhere a second time, so that the way from the light
// is best used several times. Random numbers of photon i depend on (seed, i) alone:
//   block 0: choice of the light (two words), key of alpha decisions
//   block 1: point and direction on the light
//   block 4096 b + 2 + d: lobe, direction (2), Russian roulette     of branch b at scattering d;
//                         b = 0 up to the split, 1, 2, ... after it
//   block 4096 b + 2048 + 2 + d: where the blur moves the deposit after d scatterings
#pragma once

#include "linespace/accumulate.h"
#include "linespace/blur.h"
#include "linespace/open_sides.h"
#include "linespace/vertex.h"
#include "shading/light_emission.h"

namespace ql {

struct PhotonContext {
    const EmbreeScene& rays;
    const LightEmission& emission;
    VoxelGrid grid; // render space
    int patches = 4;
    int normal_classes = 6;
    Estimator estimator = Estimator::energy;
    int max_scatterings = 4; // of light paths
    int branches = 1;        // into which a photon is split
    uint64_t seed = 0;
    double metres = 1;                // per unit of render space
    std::vector<char> takes_light;    // by material
    const OpenSides* sides = nullptr; // null: all are open
    Blur blur;
};

struct PhotonCounts {
    uint64_t rays = 0;
    uint64_t vertices = 0; // surface hits
    uint64_t deposits = 0;
    uint64_t gated = 0; // hits whose light did not enter the voxel from outside, or closed sides
    uint64_t discarded = 0; // photons that ended because their flux was not finite or too large
    int64_t unclassified = 0;
    std::vector<int64_t> weight_by_order, caustic_by_order; // see CacheHeader

    void add(const PhotonCounts& other);
};

// Photons [begin, end).
using PhotonTracer = void (*)(const PhotonContext& context, uint64_t begin, uint64_t end,
                              std::vector<Deposit>& deposits, PhotonCounts& counts);

PhotonTracer photon_tracer_for(const Scene& scene);

namespace detail {

// Separates photons from the other users of CounterRandom.
inline constexpr uint64_t kPhotonKey = 0x70686f746f6e7321;
inline constexpr float kMaxAdjointFactor = 64;

inline float largest_component(const V3f& v) {
    return std::max({v.x, v.y, v.z});
}

// Veach 1997, eq. 5.19, from the direction the photon came from (a) to where it goes (b); 1 where
// the shading normal is the geometric one. Bounded: it grows without limit at grazing angles.
inline float adjoint_factor(const PathVertex& vertex, const V3f& b) {
    const V3f& a = vertex.wo;
    const float above = std::abs(vertex.frame.n.dot(a) * vertex.ng.dot(b));
    const float below = std::abs(vertex.ng.dot(a) * vertex.frame.n.dot(b));
    return below > 0 ? std::min(above / below, kMaxAdjointFactor) : 0;
}

template<uint32_t Lobes>
class PhotonKernel {
  public:
    PhotonKernel(const PhotonContext& context, std::vector<Deposit>& deposits, PhotonCounts& counts)
        : m_context(context), m_world(context.rays.world()), m_deposits(deposits),
          m_counts(counts) {}

    void trace(uint64_t photon) const;

  private:
    // A photon on its way.
    struct Flight {
        V3f weight;
        int scatterings = 0;
        bool only_specular = true; // since the light
        bool is_split = false;
        bool left_open_side = true;
        uint32_t branch = 0;
        uint32_t alpha_key = 0;
    };
    static constexpr uint32_t kBlurBlocks = 2048;
    static uint32_t block_of(const Flight& flight) {
        return 4096 * flight.branch + 2 + uint32_t(flight.scatterings);
    }
    void follow(Flight flight, Ray ray, const CounterRandom& random) const;
    // The ray on which the flight goes on; none if it ends there.
    std::optional<Ray> scattered(const SurfacePoint& point, const PathVertex& vertex,
                                 Flight& flight, const RandomFloats& u) const;
    void split(const SurfacePoint& point, const PathVertex& vertex, const Flight& flight,
               const CounterRandom& random) const;
    // Whether the side of the surface that w points away from is open.
    bool is_open(const SurfacePoint& point, const V3f& w) const {
        return !m_context.sides || m_context.sides->is_open(point.surface, point.ng.dot(w) > 0);
    }
    void deposit(const PathVertex& vertex, double distance, const Flight& flight,
                 const CounterRandom& random) const;
    V3f first_weight(const EmittedPhoton& emitted) const;
    V3f weakened(const V3f& weight, const PathVertex& vertex, double distance,
                 int scatterings) const;

    const PhotonContext& m_context;
    const World& m_world;
    std::vector<Deposit>& m_deposits;
    PhotonCounts& m_counts;
};

template<uint32_t Lobes>
V3f PhotonKernel<Lobes>::first_weight(const EmittedPhoton& emitted) const {
    return m_context.estimator == Estimator::energy ? emitted.flux : emitted.intensity;
}

// Nilles 2017: cosine and distance at every hit by the text, at the first one by listing 10.
template<uint32_t Lobes>
V3f PhotonKernel<Lobes>::weakened(const V3f& weight, const PathVertex& vertex, double distance,
                                  int scatterings) const {
    if (m_context.estimator == Estimator::energy ||
        (m_context.estimator == Estimator::count_listing && scatterings > 0))
        return weight;
    const double metres = distance * m_context.metres;
    return weight * float(std::max(0.0, double(vertex.frame.n.dot(vertex.wo))) /
                          std::max(metres * metres, 1.0));
}

template<uint32_t Lobes>
void PhotonKernel<Lobes>::deposit(const PathVertex& vertex, double distance, const Flight& flight,
                                  const CounterRandom& random) const {
    const V3f& weight = flight.weight;
    const int64_t order_weight = std::llrint(
        (double(weight.x) + double(weight.y) + double(weight.z)) / 3 * (1 << kOrderBits));
    V3d point = start_of(vertex, vertex.wo);
    if (m_context.blur.is_on()) {
        const RandomFloats u = random.block(block_of(flight) + kBlurBlocks);
        point += V3d(m_context.blur.shift(vertex.position, vertex.ng, vertex.offset, {u[0], u[1]},
                                          flight.alpha_key));
    }
    const auto place = locate(m_context.grid, m_context.patches, point, V3d(vertex.wo));
    if (!place) {
        m_counts.unclassified += order_weight;
        return;
    }
    const uint32_t directed = directed_shaft_count(m_context.patches);
    uint32_t shaft =
        place->shaft + directed * uint32_t(normal_class(vertex.ng, m_context.normal_classes));
    if (m_context.estimator == Estimator::energy) {
        // Light that did not enter through the voxel's face belongs to no shaft: the camera path
        // finds it by going on. Caustics have a layer of their own, wherever they come from.
        if (flight.only_specular)
            shaft += directed * uint32_t(m_context.normal_classes);
        else if (distance <= place->t_entry) {
            ++m_counts.gated;
            return;
        }
    }
    m_deposits.push_back({place->voxel, shaft, {weight.x, weight.y, weight.z}});
    ++m_counts.deposits;
    const bool is_caustic = m_context.estimator == Estimator::energy && flight.only_specular;
    (is_caustic ? m_counts.caustic_by_order
                : m_counts.weight_by_order)[size_t(flight.scatterings) - 1] += order_weight;
}

template<uint32_t Lobes>
std::optional<Ray> PhotonKernel<Lobes>::scattered(const SurfacePoint& point,
                                                  const PathVertex& vertex, Flight& flight,
                                                  const RandomFloats& u) const {
    const auto next = sample_bsdf<Lobes, TransportMode::importance>(vertex.bsdf, vertex.wo_local,
                                                                    u[0], {u[1], u[2]});
    if (!next) return std::nullopt;
    const V3f wi = vertex.frame.world_from_local(next->wi);
    if ((wi.dot(vertex.ng) > 0) == next->transmitted) return std::nullopt;
    V3f weight = times(flight.weight, next->weight);
    if (!next->specular && vertex.frame.n != vertex.ng) weight *= adjoint_factor(vertex, wi);
    if (m_context.estimator == Estimator::energy) {
        const float survival =
            std::min(1.0f, largest_component(weight) / largest_component(flight.weight));
        if (!(u[3] < survival)) return std::nullopt;
        weight /= survival;
    }
    if (is_black(weight)) return std::nullopt;
    flight.weight = weight;
    flight.only_specular &= next->specular;
    flight.left_open_side = is_open(point, wi);
    ++flight.scatterings;
    return Ray{offset_origin(vertex.position, vertex.ng, vertex.offset, wi), 0, wi, kInfinity};
}

// Directions of the branches are a rotated lattice.
template<uint32_t Lobes>
void PhotonKernel<Lobes>::split(const SurfacePoint& point, const PathVertex& vertex,
                                const Flight& flight, const CounterRandom& random) const {
    const auto branches = uint32_t(m_context.branches);
    const RandomFloats shift = random.block(2 + uint32_t(flight.scatterings));
    for (uint32_t b = 0; b < branches; ++b) {
        Flight branch = flight;
        branch.weight /= float(branches);
        branch.is_split = true;
        branch.branch = b + 1;
        branch.alpha_key += branch.branch * 0x85ebca6bu;
        RandomFloats u = random.block(block_of(branch));
        const V2f at = rotated_lattice({shift[1], shift[2]}, b, branches);
        u[1] = at.x;
        u[2] = at.y;
        if (const auto ray = scattered(point, vertex, branch, u)) follow(branch, *ray, random);
    }
}

template<uint32_t Lobes>
void PhotonKernel<Lobes>::follow(Flight flight, Ray ray, const CounterRandom& random) const {
    for (;;) {
        // Find the next surface.
        ++m_counts.rays;
        Hit hit;
        const uint32_t alpha_key = flight.alpha_key + uint32_t(flight.scatterings) * 0x9e3779b9u;
        if (!m_context.rays.intersect(ray, alpha_key, hit)) return;
        ++m_counts.vertices;
        const SurfacePoint point = surface_point(m_world, ray, hit);
        const Material& material = m_world.scene->materials[size_t(point.material)];
        const bool takes_light = m_context.takes_light[size_t(point.material)];
        const PathVertex vertex = path_vertex(*m_world.scene, point, material, -ray.direction);

        // Store light that has been scattered at least once.
        flight.weight = weakened(flight.weight, vertex, double(hit.t), flight.scatterings);
        if (!(largest_component(flight.weight) <= kMaxWeight)) {
            ++m_counts.discarded;
            return;
        }
        if (flight.scatterings > 0 && takes_light) {
            if (flight.left_open_side && is_open(point, -ray.direction))
                deposit(vertex, double(hit.t), flight, random);
            else
                ++m_counts.gated;
        }
        if (flight.scatterings == m_context.max_scatterings) return;

        // Choose where the photon goes on.
        if (takes_light && !flight.is_split && m_context.branches > 1)
            return split(point, vertex, flight, random);
        const auto next = scattered(point, vertex, flight, random.block(block_of(flight)));
        if (!next) return;
        ray = *next;
    }
}

template<uint32_t Lobes>
void PhotonKernel<Lobes>::trace(uint64_t photon) const {
    const CounterRandom random(m_context.seed ^ kPhotonKey, photon);
    const RandomWords pick = random.words(0);
    const RandomFloats u_light = random.block(1);
    const EmittedPhoton emitted = m_context.emission.sample(
        unit_double(pick[0], pick[1]), {u_light[0], u_light[1]}, {u_light[2], u_light[3]});
    Flight flight{first_weight(emitted)};
    flight.alpha_key = pick[2];
    follow(flight, {emitted.origin, 0, emitted.direction, kInfinity}, random);
}

template<uint32_t Lobes>
void trace_photons(const PhotonContext& context, uint64_t begin, uint64_t end,
                   std::vector<Deposit>& deposits, PhotonCounts& counts) {
    counts.weight_by_order.resize(size_t(context.max_scatterings));
    counts.caustic_by_order.resize(size_t(context.max_scatterings));
    const PhotonKernel<Lobes> kernel(context, deposits, counts);
    for (uint64_t photon = begin; photon < end; ++photon)
        kernel.trace(photon);
}

} // namespace detail

} // namespace ql
