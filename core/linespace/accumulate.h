// Adding up photon weights by (voxel, shaft): in parallel, exactly, without locks.
//
// Deposits come in rounds of unsorted chunks. A round is spread over ranges of voxels; each range
// finds its entries by hashing and adds to them, and sorts them once at the end. 48 to 56 bytes an
// entry while photons are traced. Sums are integers, so the result does not
// depend on chunks, rounds or threads.
#pragma once

#include "base/huge_vector.h"
#include "base/parallel.h"
#include "linespace/cache.h"

#include <mutex>

namespace ql {

struct Deposit {
    uint32_t voxel;
    uint32_t shaft;
    float weight[3]; // finite, not negative
};

// The largest weight that is taken; greater ones are refused by the tracer.
inline constexpr float kMaxWeight = 1024;

class ShaftAccumulator {
  public:
    ShaftAccumulator(uint64_t voxels, int sum_bits);

    // Adds a round and empties it, keeping its memory. Errors: ErrorKind::usage where a sum leaves
    // 64 bits or a count 32.
    void add(std::vector<std::vector<Deposit>>& chunks, const Workers& workers);

    size_t size() const;
    // Moves the entries into the cache's lists, whose header must be set.
    void move_to(LightCache& cache, const Workers& workers);

  private:
    struct Entry {
        uint64_t key; // voxel << 32 | shaft
        ShaftSum sum;
        uint32_t count;
    };
    static constexpr size_t kBlockBits = 7, kBlockSize = size_t{1} << kBlockBits;
    using Block = std::array<Entry, kBlockSize>;

    // Hands out blocks of entries to all parts.
    class BlockPool {
      public:
        Block* take();
        void clear() { m_slabs.clear(); }

      private:
        std::mutex m_mutex; // once in 128 new entries
        std::vector<HugeVector<Block>> m_slabs;
    };

    // The entries of a range of voxels in the order in which they came, in blocks: they never move.
    class Part {
      public:
        size_t size() const { return m_size; }
        void add(std::span<const Deposit> deposits, double scale, BlockPool& pool);
        // Moves the entries, sorted, to these places of the lists.
        void move_to(LightCache& cache, size_t first);

      private:
        Entry& entry(size_t i) { return (*m_blocks[i >> kBlockBits])[i & (kBlockSize - 1)]; }
        Entry& entry_of(uint64_t key, BlockPool& pool);
        uint32_t* slot_of(uint64_t key);
        void grow_table();

        std::vector<Block*> m_blocks;
        size_t m_size = 0;
        std::vector<uint32_t> m_slots; // hash table: 1 + index of the entry, 0 where free
        int m_slot_bits = 0;
    };

    int m_part_shift; // from a voxel to its part
    double m_scale;
    std::vector<Part> m_parts;
    BlockPool m_pool;
    HugeVector<Deposit> m_spread;
};

} // namespace ql
