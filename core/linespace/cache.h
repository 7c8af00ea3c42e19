// The Linespace cache: light sums of directed shafts, exact, ordered by voxel and shaft.
//
// Sums are integers: weights in units of 2^-sum_bits of `unit`. Integer sums do not depend on any
// order, so a cache is the same for any number of threads and any split into shards.
//
// The number of an entry is shaft + 30 N^4 (class + C layer): the directed shaft, the class of the
// surface's normal out of C (6 or 1), and the layer. Layer 0 holds light that entered the voxel
// through the shaft's face; layer 1 holds caustics, light that came from its lamp over mirrors and
// glass alone, wherever those are.
#pragma once

#include "base/huge_vector.h"
#include "linespace/grid.h"
#include "linespace/shaft.h"

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace ql {

enum class Estimator {
    energy,       // flux over étendue: radiance
    count_text,   // Nilles 2017, section 5.2.6: "illuminance" over the number of photons
    count_listing // the same as listing 10 has it: cosine and distance of the first segment alone
};

std::string name_of(Estimator estimator);
// Errors: ErrorKind::input.
Estimator estimator_named(const std::string& name);

// A half-open range of photon numbers.
struct PhotonRange {
    uint64_t begin = 0;
    uint64_t end = 0;
    bool operator==(const PhotonRange&) const = default;
};

inline constexpr int kMaxBranches = 256;
// Of light paths and camera paths: each scattering has random numbers of its own, of which a branch
// has blocks for 818 (sample_kernel.h), and paths that read are followed by recursion.
inline constexpr int kMaxJoinedDepth = 800;

using ShaftSum = std::array<int64_t, 3>;

struct CacheHeader {
    Estimator estimator = Estimator::energy;
    int patches = 4;                       // N
    int normal_classes = 6;                // C: 6 or 1
    std::array<int, 3> voxels = {1, 1, 1}; // grid
    V3d lower = {0, 0, 0};                 // corner of the grid, metres
    V3d cell = {1, 1, 1};                  // size of a voxel, metres
    int max_depth = 5;                     // of the joined path; light paths scatter one less
    int branches = 1;                      // of a photon from its first scattering on
    double blur = 0; // radius of the disc that deposits are moved on, metres; see blur.h
    uint64_t seed = 0;
    uint64_t scene_hash = 0;
    int sum_bits = 24;
    // What a weight of 1 stands for. energy: watts of all lights together, to be divided by the
    // number of photons; count: the greatest intensity of a light, W/sr.
    double unit = 0;
    std::vector<PhotonRange> photons; // sorted, apart from each other
    // Weight that arrived after 1, 2, ... scatterings, mean over R, G, B, in units of 2^-16: in
    // layer 0, and of caustics. All zero: caustics of any order belong to the first.
    std::vector<int64_t> weight_by_order, caustic_by_order;
    int64_t unclassified = 0; // weight of photons that no shaft takes, in units of 2^-16

    uint64_t photon_count() const;
    uint32_t directed() const { return directed_shaft_count(patches); }
    // The first number of the caustic layer; twice that is the end of all numbers.
    uint32_t caustics_from() const { return directed() * uint32_t(normal_classes); }
    uint64_t voxel_count() const {
        return uint64_t(voxels[0]) * uint64_t(voxels[1]) * uint64_t(voxels[2]);
    }
    bool operator==(const CacheHeader&) const = default;
};

inline constexpr int kOrderBits = 16; // of weight_by_order and unclassified

struct LightCache {
    CacheHeader header;
    // Entries of voxel v: first[v] up to first[v + 1]; sorted by shaft.
    std::vector<uint64_t> first;
    HugeVector<uint32_t> shafts;
    HugeVector<uint32_t> counts; // photons
    HugeVector<ShaftSum> sums;
    HugeVector<float> measures; // G_s f_s in m^2 sr; energy alone, else empty
    // Groups of shafts with light (groups.h), in the same order, and their measures, which those of
    // dark shafts are part of. Energy alone, else empty.
    std::vector<uint64_t> group_first;
    std::vector<uint32_t> groups;
    std::vector<float> group_measures;

    size_t size() const { return shafts.size(); }
    std::span<const uint32_t> gated_shafts_of(uint64_t voxel) const;
    size_t memory_bytes() const;
};

// The grid of a cache in the render space of its scene.
VoxelGrid grid_of(const CacheHeader& header, const RenderSpace& space);

// The ranges of both: sorted, joined where they meet. Errors: ErrorKind::input where they overlap.
std::vector<PhotonRange> joined(const std::vector<PhotonRange>& a,
                                const std::vector<PhotonRange>& b);

// Whether caches with these headers can be added. Errors: ErrorKind::input where they do not fit.
void require_mergeable(const CacheHeader& a, const CacheHeader& b, const std::string& what);

// The sum of two caches of the same scene, grid and settings; exact. what: names both in messages.
// Errors: ErrorKind::input where they do not fit or a sum leaves 64 bits.
LightCache merged(const LightCache& a, const LightCache& b, const std::string& what);

} // namespace ql
