// Adding up photon weights by (voxel, shaft): in parallel, exactly, without locks.
//
// Deposits come in rounds of unsorted chunks. A round is spread over ranges of voxels; each range
// sorts its deposits and merges them into its sorted entries, in place. 36 bytes an entry. Sums are
// integers, so the result does not depend on chunks, rounds or threads.
#pragma once

#include "base/parallel.h"
#include "linespace/cache.h"

namespace ql {

struct Deposit {
    uint32_t voxel;
    uint32_t shaft;
    float weight[3]; // finite, not negative
};

// The largest weight that is taken; greater ones are refused by the tracer. Keeps sums far from
// overflow for 10^9 photons and more.
inline constexpr float kMaxWeight = 1024;

class ShaftAccumulator {
  public:
    ShaftAccumulator(uint64_t voxels, int sum_bits);

    // Adds a round and empties it, keeping its memory.
    void add(std::vector<std::vector<Deposit>>& chunks, const Workers& workers);

    size_t size() const;
    // Moves the entries into the cache's lists, whose header must be set.
    void move_to(LightCache& cache);

  private:
    struct Part {
        std::vector<uint64_t> keys; // voxel << 32 | shaft, sorted
        std::vector<uint32_t> counts;
        std::vector<ShaftSum> sums;
    };
    void merge(Part& part, std::span<Deposit> deposits) const;

    uint64_t m_voxels_per_part;
    double m_scale;
    std::vector<Part> m_parts;
    std::vector<Deposit> m_spread;
};

} // namespace ql
