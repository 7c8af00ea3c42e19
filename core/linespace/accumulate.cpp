#include "linespace/accumulate.h"

#include "base/check.h"
#include "base/error.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace ql {

namespace {

constexpr uint64_t kMostParts = 1024;
constexpr int kLeastSlotBits = 6;
// Deposits ahead of the one that is added for which slots, and entries, are fetched.
constexpr size_t kSlotsAhead = 16, kEntriesAhead = 8;

uint64_t key_of(const Deposit& d) {
    return uint64_t{d.voxel} << 32 | d.shaft;
}

// Fibonacci hashing (Knuth, The Art of Computer Programming 3, section 6.4) to a number of bits.
size_t hash_of(uint64_t key, int bits) {
    return size_t(((key ^ key >> 32) * 0x9e3779b97f4a7c15) >> (64 - bits));
}

} // namespace

ShaftAccumulator::ShaftAccumulator(uint64_t voxels, int sum_bits)
    : m_part_shift(int(std::bit_width((voxels - 1) / kMostParts))),
      m_scale(std::ldexp(1.0, sum_bits)), m_parts(((voxels - 1) >> m_part_shift) + 1) {}

size_t ShaftAccumulator::size() const {
    size_t size = 0;
    for (const Part& part : m_parts)
        size += part.size();
    return size;
}

void ShaftAccumulator::add(std::vector<std::vector<Deposit>>& chunks, const Workers& workers) {
    // Count what each chunk has for each part, then give each pair its place.
    const size_t parts = m_parts.size();
    std::vector<std::vector<size_t>> offsets(chunks.size());
    const auto part_of = [&](const Deposit& d) { return size_t(d.voxel >> m_part_shift); };
    workers.for_each(chunks.size(), [&](size_t c) {
        offsets[c].assign(parts, 0);
        for (const Deposit& d : chunks[c])
            ++offsets[c][part_of(d)];
    });
    std::vector<size_t> part_begin(parts + 1, 0);
    size_t total = 0;
    for (size_t p = 0; p < parts; ++p) {
        part_begin[p] = total;
        for (auto& chunk : offsets) {
            const size_t count = chunk[p];
            chunk[p] = total;
            total += count;
        }
    }
    part_begin[parts] = total;

    // Spread, then add.
    if (m_spread.size() < total) m_spread.resize(total);
    workers.for_each(chunks.size(), [&](size_t c) {
        for (const Deposit& d : chunks[c])
            m_spread[offsets[c][part_of(d)]++] = d;
        chunks[c].clear();
    });
    workers.for_each(parts, [&](size_t p) {
        m_parts[p].add(
            std::span(m_spread).subspan(part_begin[p], part_begin[p + 1] - part_begin[p]), m_scale,
            m_pool);
    });
}

auto ShaftAccumulator::BlockPool::take() -> Block* {
    constexpr size_t kBlocksPerSlab = 1 << 12;
    const std::scoped_lock lock(m_mutex);
    if (m_slabs.empty() || m_slabs.back().size() == kBlocksPerSlab) {
        m_slabs.emplace_back();
        m_slabs.back().reserve(kBlocksPerSlab);
    }
    return &m_slabs.back().emplace_back();
}

void ShaftAccumulator::Part::add(std::span<const Deposit> deposits, double scale, BlockPool& pool) {
    const size_t count = deposits.size();
    for (size_t i = 0; i < count; ++i) {
        if (m_slot_bits > 0 && i + kSlotsAhead < count) {
            __builtin_prefetch(&m_slots[hash_of(key_of(deposits[i + kSlotsAhead]), m_slot_bits)]);
            const uint32_t next =
                m_slots[hash_of(key_of(deposits[i + kEntriesAhead]), m_slot_bits)];
            if (next > 0) __builtin_prefetch(&entry(next - 1));
        }
        const Deposit& deposit = deposits[i];
        Entry& to = entry_of(key_of(deposit), pool);
        bool overflow = __builtin_add_overflow(to.count, 1u, &to.count);
        for (size_t c = 0; c < 3; ++c)
            overflow |= __builtin_add_overflow(
                to.sum[c], std::llrint(double(deposit.weight[c]) * scale), &to.sum[c]);
        if (overflow)
            throw usage_error("a shaft takes more light than a sum holds: fewer photons, or more "
                              "voxels or patches");
    }
}

// A new one if there is none yet.
auto ShaftAccumulator::Part::entry_of(uint64_t key, BlockPool& pool) -> Entry& {
    if (2 * m_size >= m_slots.size()) grow_table();
    uint32_t* const slot = slot_of(key);
    if (*slot > 0) return entry(*slot - 1);
    if (m_size >> kBlockBits == m_blocks.size()) m_blocks.push_back(pool.take());
    *slot = uint32_t(++m_size);
    return entry(m_size - 1) = {key, {}, 0};
}

// Where the key is, or where it belongs.
uint32_t* ShaftAccumulator::Part::slot_of(uint64_t key) {
    const size_t mask = m_slots.size() - 1;
    for (size_t at = hash_of(key, m_slot_bits);; at = (at + 1) & mask)
        if (m_slots[at] == 0 || entry(m_slots[at] - 1).key == key) return &m_slots[at];
}

// At most half full, so that searches stay short.
void ShaftAccumulator::Part::grow_table() {
    m_slot_bits = std::max(m_slot_bits + 1, kLeastSlotBits);
    m_slots.assign(size_t{1} << m_slot_bits, 0);
    for (size_t i = 0; i < m_size; ++i)
        *slot_of(entry(i).key) = uint32_t(i + 1);
}

void ShaftAccumulator::Part::move_to(LightCache& cache, size_t first) {
    m_slots = std::vector<uint32_t>();
    std::vector<std::pair<uint64_t, const Entry*>> order;
    order.reserve(m_size);
    for (size_t i = 0; i < m_size; ++i)
        order.emplace_back(entry(i).key, &entry(i));
    std::sort(order.begin(), order.end());
    for (const auto& [key, from] : order) {
        cache.shafts[first] = uint32_t(key);
        cache.counts[first] = from->count;
        cache.sums[first] = from->sum;
        ++first;
        ++cache.first[size_t(key >> 32) + 1];
    }
}

void ShaftAccumulator::move_to(LightCache& cache, const Workers& workers) {
    m_spread = {};
    std::vector<size_t> first_of_part;
    size_t total = 0;
    for (const Part& part : m_parts) {
        first_of_part.push_back(total);
        total += part.size();
    }
    cache.first.assign(cache.header.voxel_count() + 1, 0);
    cache.shafts.resize(total);
    cache.counts.resize(total);
    cache.sums.resize(total);
    workers.for_each(m_parts.size(),
                     [&](size_t p) { m_parts[p].move_to(cache, first_of_part[p]); });
    m_parts.assign(m_parts.size(), {});
    m_pool.clear();
    for (size_t v = 1; v < cache.first.size(); ++v)
        cache.first[v] += cache.first[v - 1];
}

} // namespace ql
