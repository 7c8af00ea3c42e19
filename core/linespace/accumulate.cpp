#include "linespace/accumulate.h"

#include "base/check.h"

#include <algorithm>
#include <cmath>

namespace ql {

namespace {

constexpr uint64_t kParts = 512;

uint64_t key_of(const Deposit& d) {
    return uint64_t{d.voxel} << 32 | d.shaft;
}

// Deposits of one shaft, added up.
struct Run {
    uint64_t key;
    uint32_t count;
    ShaftSum sum;
};

// Grows by an eighth: entries are many, and slack is memory.
template<class T>
void grow(std::vector<T>& values, size_t size) {
    if (values.capacity() < size) values.reserve(size + size / 8);
    values.resize(size);
}

} // namespace

ShaftAccumulator::ShaftAccumulator(uint64_t voxels, int sum_bits)
    : m_voxels_per_part((voxels + kParts - 1) / kParts), m_scale(std::ldexp(1.0, sum_bits)),
      m_parts((voxels + m_voxels_per_part - 1) / m_voxels_per_part) {}

size_t ShaftAccumulator::size() const {
    size_t size = 0;
    for (const Part& part : m_parts)
        size += part.keys.size();
    return size;
}

void ShaftAccumulator::add(std::vector<std::vector<Deposit>>& chunks, const Workers& workers) {
    // Count what each chunk has for each part, then give each pair its place.
    const size_t parts = m_parts.size();
    std::vector<std::vector<size_t>> offsets(chunks.size());
    const auto part_of = [&](const Deposit& d) { return size_t(d.voxel / m_voxels_per_part); };
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

    // Spread, sort, merge.
    if (m_spread.size() < total) m_spread.resize(total);
    workers.for_each(chunks.size(), [&](size_t c) {
        for (const Deposit& d : chunks[c])
            m_spread[offsets[c][part_of(d)]++] = d;
        chunks[c].clear();
    });
    workers.for_each(parts, [&](size_t p) {
        merge(m_parts[p],
              std::span(m_spread).subspan(part_begin[p], part_begin[p + 1] - part_begin[p]));
    });
}

void ShaftAccumulator::merge(Part& part, std::span<Deposit> deposits) const {
    if (deposits.empty()) return;
    std::sort(deposits.begin(), deposits.end(),
              [](const Deposit& a, const Deposit& b) { return key_of(a) < key_of(b); });
    std::vector<Run> runs;
    for (const Deposit& d : deposits) {
        if (runs.empty() || runs.back().key != key_of(d)) runs.push_back({key_of(d), 0, {}});
        ++runs.back().count;
        for (size_t c = 0; c < 3; ++c)
            runs.back().sum[c] += std::llrint(double(d.weight[c]) * m_scale);
    }

    // Count the keys that are new.
    size_t fresh = 0;
    {
        auto at = part.keys.begin();
        for (const Run& run : runs) {
            at = std::lower_bound(at, part.keys.end(), run.key);
            fresh += at == part.keys.end() || *at != run.key;
        }
    }

    // Merge from the back, in place.
    size_t from = part.keys.size(), to = from + fresh;
    grow(part.keys, to);
    grow(part.counts, to);
    grow(part.sums, to);
    for (size_t r = runs.size(); r-- > 0;) {
        const Run& run = runs[r];
        while (from > 0 && part.keys[from - 1] > run.key) {
            --from;
            --to;
            part.keys[to] = part.keys[from];
            part.counts[to] = part.counts[from];
            part.sums[to] = part.sums[from];
        }
        --to;
        const bool known = from > 0 && part.keys[from - 1] == run.key;
        if (known) --from;
        part.keys[to] = run.key;
        part.counts[to] = (known ? part.counts[from] : 0) + run.count;
        for (size_t c = 0; c < 3; ++c)
            part.sums[to][c] = (known ? part.sums[from][c] : 0) + run.sum[c];
    }
    QL_CHECK_EQ(from, to);
}

void ShaftAccumulator::move_to(LightCache& cache) {
    m_spread = {};
    const size_t total = size();
    cache.first.assign(cache.header.voxel_count() + 1, 0);
    cache.shafts.reserve(total);
    cache.counts.reserve(total);
    cache.sums.reserve(total);
    for (Part& part : m_parts) {
        for (const uint64_t key : part.keys) {
            cache.shafts.push_back(uint32_t(key));
            ++cache.first[size_t(key >> 32) + 1];
        }
        cache.counts.insert(cache.counts.end(), part.counts.begin(), part.counts.end());
        cache.sums.insert(cache.sums.end(), part.sums.begin(), part.sums.end());
        part = {};
    }
    for (size_t v = 1; v < cache.first.size(); ++v)
        cache.first[v] += cache.first[v - 1];
}

} // namespace ql
