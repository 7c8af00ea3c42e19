#include "bluenoise/sort.h"

#include "sampling/random.h"

#include <algorithm>
#include <bit>
#include <map>
#include <numeric>
#include <vector>

#ifdef __SSE2__
#include <emmintrin.h>
#endif

namespace ql {

namespace {

// Blocks sorted side by side, one in each lane, and the largest block that is sorted so.
constexpr size_t kLanes = 8;
constexpr int kMaxNetworkBlock = 16;
constexpr int kIndexBits = 12; // of a pixel in its block
constexpr int kTieBits = 18;

// A sort key: from the top intensity, tie hash, index in the block. As a double it is positive and
// finite, and doubles have the vector minimum and maximum that 64-bit integers lack.
using Key = double;
constexpr uint64_t kKeyBase = uint64_t(1) << 52;
constexpr uint64_t kLastKey = kKeyBase + (uint64_t(1) << 62);

uint32_t tie_hash(uint32_t seed, uint32_t key) {
    // C. Wellons, "Prospecting for hash functions", 2018: lowbias32.
    uint32_t x = seed ^ key;
    x = (x ^ (x >> 16)) * 0x7feb352du;
    x = (x ^ (x >> 15)) * 0x846ca68bu;
    return x ^ (x >> 16);
}

// Words in the order of the floats.
uint32_t ordered_bits(float value) {
    const uint32_t bits = std::bit_cast<uint32_t>(value + 0.0f); // -0 becomes 0
    return bits & 0x80000000u ? ~bits : bits | 0x80000000u;
}

Key sort_key(float intensity, uint32_t seed, uint32_t tie_key, uint32_t index) {
    const uint64_t tie = tie_hash(seed, tie_key) >> (32 - kTieBits);
    const uint64_t low = tie << kIndexBits | index;
    return std::bit_cast<Key>(kKeyBase +
                              (uint64_t(ordered_bits(intensity)) << (kTieBits + kIndexBits) | low));
}

uint32_t index_of(Key key) {
    return uint32_t(std::bit_cast<uint64_t>(key) & ((1u << kIndexBits) - 1));
}

struct Exchange {
    uint16_t low, high;
};

// Batcher's merge exchange (Knuth, The Art of Computer Programming 3, 5.2.2 M), for any n.
std::vector<Exchange> sorting_network(int n) {
    std::vector<Exchange> network;
    for (int p = 1; p < n; p *= 2)
        for (int k = p; k >= 1; k /= 2)
            for (int j = k % p; j + k < n; j += 2 * k)
                for (int i = j; i < std::min(j + k, n - k); ++i)
                    if (i / (2 * p) == (i + k) / (2 * p))
                        network.push_back({uint16_t(i), uint16_t(i + k)});
    return network;
}

// The lesser of each lane to `low`, the greater to `high`. Written out because compilers do not
// take the vector instructions for it, whose zeros and NaNs differ; keys are neither.
inline void put_in_order(Key* low, Key* high) {
#ifdef __SSE2__
    for (size_t lane = 0; lane < kLanes; lane += 2) {
        const __m128d a = _mm_loadu_pd(low + lane), b = _mm_loadu_pd(high + lane);
        _mm_storeu_pd(low + lane, _mm_min_pd(a, b));
        _mm_storeu_pd(high + lane, _mm_max_pd(a, b));
    }
#else
    for (size_t lane = 0; lane < kLanes; ++lane) {
        const Key a = low[lane], b = high[lane];
        low[lane] = std::min(a, b);
        high[lane] = std::max(a, b);
    }
#endif
}

struct Rect {
    int x0, y0, x1, y1; // cut off at the image
    int column, row;    // of the whole block's upper left corner
};

class Sorter {
  public:
    Sorter(Array2D<uint32_t>& seeds, const Array2D<float>& intensities,
           const Array2D<uint32_t>& ranks, const Array2D<uint32_t>& surfaces,
           const SortConfig& config)
        : m_seeds(seeds), m_intensities(intensities), m_ranks(ranks), m_surfaces(surfaces),
          m_config(config), m_block(config.block_px), m_pixels(size_t(m_block) * size_t(m_block)),
          m_first_x(-wrap(-config.origin.x, m_block)), m_first_y(-wrap(-config.origin.y, m_block)),
          m_columns((intensities.width() - m_first_x + m_block - 1) / m_block),
          m_rows((intensities.height() - m_first_y + m_block - 1) / m_block) {
        if (m_block <= kMaxNetworkBlock) m_network = sorting_network(int(m_pixels));
        for (int y = 0; y < m_block; ++y)
            for (int x = 0; x < m_block; ++x) {
                m_places.emplace_back(x, y);
                m_distances.push_back(std::ptrdiff_t(y) * seeds.width() + x);
            }
        m_phases_x = phases(m_first_x, config.mask_offset.x, m_columns, ranks.width());
        m_phases_y = phases(m_first_y, config.mask_offset.y, m_rows, ranks.height());
    }

    void run(const Workers& workers) {
        // The order of the mask's values in a block, once for each place it can have in the tile
        m_orders.resize(m_phases_x.starts.size() * m_phases_y.starts.size() * m_pixels);
        workers.for_each(m_phases_y.starts.size(), [&](size_t py) {
            for (size_t px = 0; px < m_phases_x.starts.size(); ++px)
                fill_order(px, py);
        });
        workers.for_each(size_t(m_rows), [&](size_t row) { sort_row(int(row)); });
    }

  private:
    // The distinct places in the mask at which blocks of an axis begin, and that of each block.
    struct Phases {
        std::vector<int> starts;
        std::vector<uint32_t> of_block;
    };
    Phases phases(int first, int offset, int blocks, int n) const {
        Phases result;
        std::map<int, uint32_t> known;
        for (int b = 0; b < blocks; ++b) {
            const int start = wrap(first + b * m_block + offset, n);
            const auto [at, is_new] = known.emplace(start, uint32_t(result.starts.size()));
            if (is_new) result.starts.push_back(start);
            result.of_block.push_back(at->second);
        }
        return result;
    }

    uint16_t* order_of_phase(size_t px, size_t py) {
        return &m_orders[(py * m_phases_x.starts.size() + px) * m_pixels];
    }
    const uint16_t* order(int column, int row) {
        return order_of_phase(m_phases_x.of_block[size_t(column)],
                              m_phases_y.of_block[size_t(row)]);
    }

    void fill_order(size_t px, size_t py) {
        std::vector<uint64_t> keys(m_pixels);
        for (uint32_t i = 0; i < m_pixels; ++i) {
            const int x = wrap(m_phases_x.starts[px] + int(i) % m_block, m_ranks.width());
            const int y = wrap(m_phases_y.starts[py] + int(i) / m_block, m_ranks.height());
            keys[i] = uint64_t(m_ranks(x, y)) << kIndexBits | i;
        }
        // A tile smaller than the block shows a value several times; the hash keeps these apart.
        std::sort(keys.begin(), keys.end(), [](uint64_t a, uint64_t b) {
            const uint64_t rank_a = a >> kIndexBits, rank_b = b >> kIndexBits;
            if (rank_a != rank_b) return rank_a < rank_b;
            const auto place = [](uint64_t key) {
                return tie_hash(uint32_t(key & ((1u << kIndexBits) - 1)),
                                uint32_t(key >> kIndexBits));
            };
            return place(a) < place(b);
        });
        uint16_t* indices = order_of_phase(px, py);
        for (size_t i = 0; i < m_pixels; ++i)
            indices[i] = uint16_t(keys[i] & ((1u << kIndexBits) - 1));
    }

    Rect rect(int column, int row) const {
        const int x = m_first_x + column * m_block, y = m_first_y + row * m_block;
        return {std::max(x, 0),
                std::max(y, 0),
                std::min(x + m_block, m_intensities.width()),
                std::min(y + m_block, m_intensities.height()),
                x,
                y};
    }

    bool is_whole(const Rect& r) const {
        return size_t(r.x1 - r.x0) * size_t(r.y1 - r.y0) == m_pixels;
    }

    // Blocks of one surface go through the network, as many at a time as there are lanes.
    void sort_row(int row) {
        std::vector<int> columns;
        Groups groups;
        for (int column = 0; column < m_columns; ++column) {
            if (!m_network.empty() && is_one_surface(rect(column, row)))
                columns.push_back(column);
            else
                sort_by_groups(column, row, groups);
        }
        std::vector<Key> keys(m_pixels * kLanes, std::bit_cast<Key>(kLastKey));
        std::vector<uint32_t> sorted_seeds(m_pixels);
        for (size_t first = 0; first < columns.size(); first += kLanes) {
            const size_t last = std::min(first + kLanes, columns.size());
            for (size_t i = first; i < last; ++i)
                load(rect(columns[i], row), &keys[i - first]);
            for (const Exchange& exchange : m_network)
                put_in_order(&keys[exchange.low * kLanes], &keys[exchange.high * kLanes]);
            for (size_t i = first; i < last; ++i)
                store(columns[i], row, &keys[i - first], sorted_seeds);
        }
    }

    bool is_one_surface(const Rect& r) const {
        if (m_surfaces.empty()) return true;
        const uint32_t first = m_surfaces(r.x0, r.y0);
        for (int y = r.y0; y < r.y1; ++y) {
            const uint32_t* row = m_surfaces.row(y).data();
            if (!std::all_of(row + r.x0, row + r.x1, [&](uint32_t s) { return s == first; }))
                return false;
        }
        return true;
    }

    // Keys of pixels outside the image come last.
    void load(const Rect& r, Key* keys) const {
        if (!is_whole(r))
            for (size_t i = 0; i < m_pixels; ++i)
                keys[i * kLanes] = std::bit_cast<Key>(kLastKey);
        for (int y = r.y0; y < r.y1; ++y)
            for (int x = r.x0; x < r.x1; ++x) {
                const uint32_t index = uint32_t((y - r.row) * m_block + x - r.column);
                keys[index * kLanes] =
                    sort_key(m_intensities(x, y), m_seeds(x, y), m_config.tie_key, index);
            }
    }

    void store(int column, int row, const Key* keys, std::vector<uint32_t>& sorted_seeds) {
        const Rect r = rect(column, row);
        const size_t count = size_t(r.x1 - r.x0) * size_t(r.y1 - r.y0);
        uint32_t* const seeds = m_seeds.values().data();
        const std::ptrdiff_t corner = std::ptrdiff_t(r.row) * m_seeds.width() + r.column;
        for (size_t k = 0; k < count; ++k)
            sorted_seeds[k] = seeds[corner + m_distances[index_of(keys[k * kLanes])]];
        const uint16_t* indices = order(column, row);
        const uint32_t* next = sorted_seeds.data();
        if (is_whole(r)) {
            for (size_t k = 0; k < m_pixels; ++k)
                seeds[corner + m_distances[indices[k]]] = *next++;
            return;
        }
        for (size_t k = 0; k < m_pixels; ++k)
            if (is_inside(r, indices[k])) seeds[corner + m_distances[indices[k]]] = *next++;
    }

    uint32_t& seed_at(const Rect& r, uint32_t index) {
        return m_seeds(r.column + m_places[index].x, r.row + m_places[index].y);
    }
    bool is_inside(const Rect& r, uint32_t index) const {
        const int x = r.column + m_places[index].x, y = r.row + m_places[index].y;
        return x >= r.x0 && x < r.x1 && y >= r.y0 && y < r.y1;
    }

    uint32_t surface_at(const Rect& r, uint32_t index) const {
        if (m_surfaces.empty()) return 0;
        return m_surfaces(r.column + m_places[index].x, r.row + m_places[index].y);
    }

    struct Groups {
        std::vector<std::pair<uint32_t, Key>> pixels;
        std::vector<std::pair<uint32_t, uint32_t>> places; // surface, index
        std::vector<uint32_t> sorted_seeds;
    };

    // Orders the pixels by (surface, intensity) and their places by (surface, mask value).
    void sort_by_groups(int column, int row, Groups& groups) {
        auto& [pixels, places, sorted_seeds] = groups;
        const Rect r = rect(column, row);
        const uint16_t* indices = order(column, row);
        pixels.clear();
        places.clear();
        for (size_t k = 0; k < m_pixels; ++k) {
            const uint32_t index = indices[k];
            if (!is_inside(r, index)) continue;
            const float intensity =
                m_intensities(r.column + m_places[index].x, r.row + m_places[index].y);
            const uint32_t surface = surface_at(r, index);
            pixels.emplace_back(surface,
                                sort_key(intensity, seed_at(r, index), m_config.tie_key, index));
            places.emplace_back(surface, index);
        }
        std::sort(pixels.begin(), pixels.end());
        std::stable_sort(places.begin(), places.end(),
                         [](const auto& a, const auto& b) { return a.first < b.first; });
        sorted_seeds.clear();
        for (const auto& [surface, key] : pixels)
            sorted_seeds.push_back(seed_at(r, index_of(key)));
        for (size_t k = 0; k < places.size(); ++k)
            seed_at(r, places[k].second) = sorted_seeds[k];
    }

    Array2D<uint32_t>& m_seeds;
    const Array2D<float>& m_intensities;
    const Array2D<uint32_t>& m_ranks;
    const Array2D<uint32_t>& m_surfaces;
    const SortConfig& m_config;
    int m_block;
    size_t m_pixels;
    int m_first_x, m_first_y; // of the first block, in (-block, 0]
    int m_columns, m_rows;    // of blocks
    std::vector<Exchange> m_network;
    std::vector<Imath::V2i> m_places;        // of an index in the block
    std::vector<std::ptrdiff_t> m_distances; // the same in the memory of the seeds
    Phases m_phases_x, m_phases_y;
    std::vector<uint16_t> m_orders;
};

} // namespace

Array2D<uint32_t> unique_ranks(const Array2D<uint32_t>& values) {
    std::vector<uint64_t> keys(values.size());
    for (uint32_t i = 0; i < values.size(); ++i)
        keys[i] = uint64_t(values[i]) << 32 | tie_hash(i, 0x5851f42du);
    // tie_hash is a bijection of words, so that no two keys are equal
    std::vector<uint32_t> order(values.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(),
              [&](uint32_t a, uint32_t b) { return keys[a] < keys[b]; });
    Array2D<uint32_t> ranks(values.width(), values.height());
    for (uint32_t k = 0; k < order.size(); ++k)
        ranks[order[k]] = k;
    return ranks;
}

void sort_seeds(Array2D<uint32_t>& seeds, const Array2D<float>& intensities,
                const Array2D<uint32_t>& ranks, const Array2D<uint32_t>& surfaces,
                const SortConfig& config, const Workers& workers) {
    QL_CHECK(config.block_px >= 1 && config.block_px <= kMaxSortBlock);
    QL_CHECK(seeds.width() >= intensities.width() && seeds.height() >= intensities.height());
    QL_CHECK(surfaces.empty() || (surfaces.width() == intensities.width() &&
                                  surfaces.height() == intensities.height()));
    if (config.block_px == 1) return;
    Sorter(seeds, intensities, ranks, surfaces, config).run(workers);
}

} // namespace ql
