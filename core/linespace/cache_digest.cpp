#include "linespace/cache_digest.h"

#include <bit>

namespace ql {

namespace {

// A running 64-bit digest: multiply and rotate, finished as in MurmurHash3 (Appleby).
class Digest {
  public:
    void add(uint64_t word) {
        m_state =
            std::rotl(m_state ^ (word * 0x87c37b91114253d5), 31) * 0x4cf5ad432745937f + 0x52dce729;
    }
    void add(double value) { add(std::bit_cast<uint64_t>(value)); }
    uint64_t value() const {
        uint64_t h = m_state;
        h = (h ^ (h >> 33)) * 0xff51afd7ed558ccd;
        h = (h ^ (h >> 33)) * 0xc4ceb9fe1a85ec53;
        return h ^ (h >> 33);
    }

  private:
    uint64_t m_state = 0x9e3779b97f4a7c15;
};

} // namespace

uint64_t digest_of(const LightCache& cache) {
    const CacheHeader& h = cache.header;
    Digest digest;
    for (const int value : {int(h.estimator), h.patches, h.voxels[0], h.voxels[1], h.voxels[2],
                            h.max_depth, h.branches, h.sum_bits, h.normal_classes})
        digest.add(uint64_t(value));
    for (int axis = 0; axis < 3; ++axis) {
        digest.add(h.lower[axis]);
        digest.add(h.cell[axis]);
    }
    digest.add(h.unit);
    for (const uint64_t value : {h.seed, h.scene_hash, uint64_t(h.unclassified)})
        digest.add(value);
    for (const PhotonRange& range : h.photons) {
        digest.add(range.begin);
        digest.add(range.end);
    }
    for (const int64_t weight : h.weight_by_order)
        digest.add(uint64_t(weight));
    if (h.blur != 0) digest.add(h.blur);
    for (size_t i = 0; i < h.caustic_by_order.size(); ++i)
        if (h.caustic_by_order[i] != 0) {
            digest.add(uint64_t(i));
            digest.add(uint64_t(h.caustic_by_order[i]));
        }
    for (const uint64_t first : cache.first)
        digest.add(first);
    for (size_t i = 0; i < cache.size(); ++i) {
        digest.add(uint64_t{cache.shafts[i]} << 32 | cache.counts[i]);
        for (const int64_t sum : cache.sums[i])
            digest.add(uint64_t(sum));
        if (!cache.measures.empty())
            digest.add(uint64_t{std::bit_cast<uint32_t>(cache.measures[i])});
    }
    for (const uint64_t first : cache.group_first)
        digest.add(first);
    for (size_t i = 0; i < cache.groups.size(); ++i)
        digest.add(uint64_t{cache.groups[i]} << 32 |
                   std::bit_cast<uint32_t>(cache.group_measures[i]));
    return digest.value();
}

} // namespace ql
